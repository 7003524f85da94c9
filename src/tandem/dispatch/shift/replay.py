"""A journal taken anew, line by line: does it lead to the same answers, decisions and
situations?
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from tandem.cell.model import Cell
from tandem.dispatch.journal import Entry, Journal, JournalError
from tandem.dispatch.shift.deadline import Instead, InTime
from tandem.dispatch.shift.documents import Document, digest
from tandem.dispatch.shift.live import Shift, kept_variants, named_again, opened_with


@dataclass(frozen=True)
class Replayed:
    """What replaying a journal showed: how many entries, events taken and decisions there are, and
    each difference in a sentence.
    """

    entries: int
    events: int
    decisions: int
    differences: tuple[str, ...]


def replay(
    cell: Cell, journal: Journal, *, decider: InTime | None = None, policy: str = ""
) -> Replayed:
    """Takes every line of the journal anew and compares answers, decisions and situations with what
    is written there, latencies aside.

    Deciders limit their work, not their time, so they decide now as they did then, on whatever
    machine. A decision that the rule gave, because the decider was late or failed, is asked of the
    rule again: that it stood in is in the journal.

    Args:
      decider: instead of the one that the journal names.
      policy: the one that it names, where that is code of your own: no file makes code run.

    Raises JournalError, UsageError and CellError as `Shift.open` does.
    """
    if journal.is_new:
        raise JournalError(f"{journal.path}: nothing was written to this journal yet.")
    settings, start = opened_with(journal, cell)
    variants = kept_variants(journal, None)
    if decider is None:
        named_again(journal, settings, policy)
    made = decider or settings.decider(cell, variants)
    differences: list[str] = []
    events = decisions = entries = 0
    with Journal() as fresh:
        shift = Shift(fresh, cell, settings, start, made, variants)
        for entry in journal.entries():
            then = entry.decision or {"instead": ""}
            instead: Instead = then["instead"]
            shift.ask = partial(made.again, instead=instead, fault=then.get("fault", ""))
            if entry.number == 0:
                shift.begin()
                again = [shift.decision]
            else:
                again = shift.take(entry.line)
            differences += _differences(entry, again, digest(shift.situation))
            entries, events, decisions = (
                entries + 1,
                events + (entry.event is not None),
                decisions + (entry.decision is not None),
            )
    return Replayed(entries, events, decisions, tuple(differences))


def _differences(entry: Entry, again: list[Document], situation: str) -> Iterator[str]:
    then = {made["type"]: made for made in (entry.answer, entry.decision) if made is not None}
    now = {made["type"]: made for made in again}
    for kind in ("answer", "decision"):
        old, new = (_lasting(made.get(kind)) for made in (then, now))
        for key in [*dict.fromkeys([*old, *new])]:
            if old.get(key) != new.get(key):
                yield (
                    f"entry {entry.number}: the {kind}'s {key!r} was {json.dumps(old.get(key))},"
                    f" and is now {json.dumps(new.get(key))}."
                )
    if situation != entry.situation:
        yield f"entry {entry.number}: the situation afterwards is another one."


def _lasting(made: Mapping[str, Any] | None) -> Document:
    """Without what is measured."""
    return {key: value for key, value in (made or {}).items() if key != "latency_ms"}
