"""What went wrong, as JSON: one shape for every refusal of the studio."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from tandem.errors import (
    CellError,
    Fault,
    InfeasibleError,
    TandemError,
    UnsoundScheduleError,
)
from tandem.schedule.said import in_language

Json = dict[str, Any]


def failure(error: TandemError, document: Any = None, language: str = "en") -> Json:
    """`error` in words and `exit`, the code that the command line ends with for the same; besides
    `errors`, `infeasible` or `faults`, where there are such.

    Args:
      document: the cell that was given, for the values at the places of faults.
      language: of sentences that are said in several.
    """
    told: Json = {"error": str(error), "exit": error.exit_code}
    if isinstance(error, CellError):
        faults = list(error.faults)
        return {
            **told,
            "error": "; ".join(str(fault) for fault in faults[:3]),
            "errors": errors_of(faults, document),
        }
    if isinstance(error, InfeasibleError):
        return {**told, **_said(error.to_dict(), language)}
    if isinstance(error, UnsoundScheduleError):
        return {**told, "faults": list(error.faults)}
    return told


def _said(document: Any, language: str) -> Any:
    """The same with every sentence in the language, as far as it is said in it."""
    if isinstance(document, Mapping):
        return {key: _said(value, language) for key, value in document.items()}
    if isinstance(document, list | tuple):
        return [_said(value, language) for value in document]
    return in_language(document, language) if isinstance(document, str) else document


def errors_of(faults: Iterable[Fault], document: Any = None) -> list[Json]:
    """Each fault with the keys that lead to it, in words, and with the value that stands there."""
    return [
        {
            "place": [str(step) for step in fault.path],
            "message": fault.message,
            "value": _value_at(document, fault.path),
            **({"where": fault.place} if fault.place else {}),
        }
        for fault in faults
    ]


def _value_at(document: Any, path: tuple[str | int, ...]) -> Any:
    """What stands at a path; None where nothing does."""
    if not path:
        return None
    for step in path:
        if isinstance(document, Mapping):
            known = {str(key): item for key, item in document.items()}
            if str(step) not in known:
                return None
            document = known[str(step)]
        elif isinstance(document, list) and isinstance(step, int) and step < len(document):
            document = document[step]
        else:
            return None
    return document
