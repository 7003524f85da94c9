"""`python -m tandem.cli` is `tandem`."""

from tandem.cli.root import main

main()
