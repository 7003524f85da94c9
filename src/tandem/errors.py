"""The one family of exceptions that Tandem raises on purpose."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with what the user gave.

    Attributes:
      message: what is wrong, with the value, and how to mend it; a sentence or two.
      path: keys from the top of the document to the faulty value, such as `("tasks", "4", "after",
        0)`.
      place: where a person finds it, `file:line:column` or `sheet!C4`; empty when there is no file.
    """

    message: str
    path: tuple[str | int, ...] = ()
    place: str = ""

    def at(self, place: str) -> Fault:
        """The same fault, placed."""
        return replace(self, place=place)

    def __str__(self) -> str:
        where = self.place or ".".join(str(key) for key in self.path)
        return f"{where}: {self.message}" if where else self.message


class NotReadWarning(UserWarning):
    """Something stands in a file that was read and has no place in a cell: what it says is lost.
    Names the file and the line.
    """


class NotWrittenWarning(UserWarning):
    """A cell holds something that the form it is written in does not, and on which no schedule
    depends, such as stress or names.
    """


class TandemError(Exception):
    """Anything that Tandem refuses; `exit_code` is what the command line ends with."""

    exit_code = 1


class UsageError(TandemError):
    """The call itself is wrong: an unknown method, an option out of range."""

    exit_code = 2


class CellError(TandemError):
    """The input does not describe a sound cell. Carries every fault found, not only the first."""

    exit_code = 3

    def __init__(self, faults: Iterable[Fault]):
        self.faults: tuple[Fault, ...] = tuple(faults)
        super().__init__("\n".join(f"- {fault}" for fault in self.faults))

    def __reduce__(self) -> tuple[type[CellError], tuple[tuple[Fault, ...]]]:
        return type(self), (self.faults,)


class InfeasibleError(TandemError):
    """No schedule can satisfy the cell and its limits, and that is proven.

    Attributes:
      reasons: sentences that say what stands in the way.
      conflict: the same as plain data, the `infeasible` of a document; None where nothing could be
        left out to mend it.
    """

    exit_code = 4

    def __init__(
        self,
        message: str,
        reasons: Sequence[str] = (),
        conflict: Mapping[str, Any] | None = None,
    ):
        self.what, self.reasons, self.conflict = message, tuple(reasons), conflict
        super().__init__("\n".join([message, *(f"- {reason}" for reason in self.reasons)]))

    def __reduce__(self) -> tuple[type[InfeasibleError], tuple[Any, ...]]:
        return type(self), (self.what, self.reasons, self.conflict)

    def to_dict(self) -> dict[str, Any]:
        """The document that stands in place of a result's: what is said, and what cannot be kept
        together.
        """
        together: dict[str, Any] = {"together": [], "minimal": None, "least": [], "without": []}
        return {
            "schema_version": 1,
            "infeasible": {
                "message": self.what,
                "reasons": list(self.reasons),
                **(together if self.conflict is None else self.conflict),
            },
        }


class NothingFoundError(TandemError):
    """No schedule was found within the limit; whether one exists is open."""

    exit_code = 5


class UnsoundScheduleError(TandemError):
    """A schedule breaks its cell. Carries every fault."""

    exit_code = 6

    def __init__(self, faults: Iterable[str]):
        self.faults: tuple[str, ...] = tuple(faults)
        super().__init__("\n".join(f"- {fault}" for fault in self.faults))
