"""`tandem VERB FILE`: what people type. A verb reads, calls and shows; Python can do the same with
the same words.
"""

from tandem.cli.root import main, tandem

__all__ = ["main", "tandem"]
