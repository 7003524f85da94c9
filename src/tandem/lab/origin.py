"""Where the numbers of a reproduction come from, as every table says it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def origin(document: Mapping[str, Any], seeds: str = "") -> list[str]:
    """Command, seeds and versions in a line; a second one for a quick run. `seeds`: in words, when
    the command does not name them.
    """
    made = document["versions"]
    named = f"{seeds}, " if seeds else ""
    line = (
        f"Made with: `{document['command']}`, {named}tandem {made['tandem']}, JAX {made['jax']},"
        f" Python {made['python']}, {made['machine']}."
    )
    return (
        [line, "This was a quick run: it shows that the code runs, not what the recipes reach."]
        if document["quick"]
        else [line]
    )
