"""`python -m tandem` is `tandem`."""

from tandem.cli.root import main

main()
