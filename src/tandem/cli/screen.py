"""A shift on a terminal: what happened, and now, next and why, in words. Grey is normal; only what
is wrong has a colour.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from tandem.dispatch.situation.events import NAMES
from tandem.dispatch.situation.model import Product
from tandem.dispatch.situation.pace import estimates

if TYPE_CHECKING:
    from tandem.dispatch.shift.live import Shift
    from tandem.dispatch.situation.events import Event
    from tandem.dispatch.situation.model import Running, Situation
from tandem.dispatch.situation.pace import Pace


class Screen:
    """Shows each document as it comes."""

    def __init__(self) -> None:
        from rich.console import Console

        self.console = Console(highlight=False, markup=False, emoji=False)
        self.paces: list[str] = []
        self.number = 0
        self.ahead: dict[str, float] | None = None

    def __call__(self, shift: Shift, document: dict[str, Any]) -> None:
        """Shows the document, read against where the shift stands."""
        match document["type"]:
            case "shift":
                self._begun(document)
            case "answer":
                self._answered(shift, document)
            case "decision":
                self._decided(shift, document)
            case "summary":
                state = "over" if document["over"] else "not over"
                self._say(
                    f"{state} at {document['at']:g} s, stress {document['stress']:g};"
                    f" {document['events']} events, {_latency(document)}."
                )

    def _begun(self, document: dict[str, Any]) -> None:
        plan = f", the plan {document['plan']} in hand" if document["plan"] else ""
        self._say(
            f"{document['cell'] or 'shift'}, decided by {document['policy']}{plan}. Advice, not a"
            " safety function."
        )
        if document["resumed"]:
            self._say(f"going on at {document['at']:g} s, after entry {document['number']}.")

    def _answered(self, shift: Shift, document: dict[str, Any]) -> None:
        """An event that was refused, one that is known already, or one that has happened."""
        if not document["accepted"]:
            for reason in document["reasons"]:
                self._say(f"refused    {reason}", "red")
        elif "duplicate_of" in document:
            self._say(
                f"known      this event was taken already, as number {document['duplicate_of']}."
            )
        else:
            self._say("" if shift.event is None else happened(shift.event), "bold")
            for remark in document["remarks"]:
                self._say(f"odd        {remark}", "yellow")

    def _decided(self, shift: Shift, document: dict[str, Any]) -> None:
        """What is to be done now, why nothing can be, and the paces that have changed."""
        self._product(document)
        believed = estimates(shift.situation, shift.settings.options.prior)
        for line in orders(shift.situation, document, believed):
            self._say(line)
        for reason in document.get("stuck", []):
            self._say(f"stuck      {reason}", "red")
        seen = {human: pace for human, pace in believed.items() if pace.seen}
        paces = [f"  {'pace':<8} {human} needs {pace.words}" for human, pace in seen.items()]
        for line in paces:
            if line not in self.paces:
                self._say(line)
        self.paces = paces

    def _product(self, document: dict[str, Any]) -> None:
        """Which product begins, and when it is expected to be done."""
        product, ahead = document["product"], document["forecast"]
        if product is not None and product["number"] != self.number:
            self.number = product["number"]
            named = Product(product["number"], product["order"], product["variant"])
            if named != Product(1):
                self._say(f"{named.words}, begun at {product['began']:g} s", "bold")
        if ahead is not None and ahead != self.ahead:
            self._say(
                f"  {'done by':<8} {ahead['p50']:.4g} s as likely as not, {ahead['p90']:.4g} s in 9"
                f" of 10 cases; by the stated times {ahead['plan']:.4g} s"
            )
        self.ahead = ahead

    def _say(self, text: str, style: str | None = None) -> None:
        self.console.print(text, style=style, soft_wrap=True)


def happened(event: Event) -> str:
    """An event in words."""
    who = " and ".join(event.operators)
    until = "" if event.until is None else f" until {event.until:g} s"
    words = [
        event.kind,
        *([f"{event.task!r}"] if event.task is not None else []),
        *(
            f"{name!r}" if key == event.kind else f"{key} {name!r}"
            for key in NAMES
            if (name := getattr(event, key)) is not None
        ),
        *([f"({who})"] if who else []),
    ]
    return f"{event.at:>8g} s  {' '.join(words)}{until}"


def orders(
    situation: Situation, decision: dict[str, Any], believed: Mapping[str, Pace]
) -> list[str]:
    """A decision in words: what goes on now, what robots and humans are asked to do next, and why.
    `believed`: the humans' paces.
    """
    apart = set(decision["take_apart"])

    def named(task: str) -> str:
        return f"take {task!r} apart" if task in apart else repr(task)

    def going(task: str, at: Running) -> str:
        end = (
            at.start
            + at.rested
            + at.stated
            * max(believed[who].mean if who in believed else 1.0 for who in at.operators)
        )
        state = (
            "resting"
            if at.rests_since is not None
            else f"until about {situation.on_clock(end):.4g} s"
            if situation.now < end
            else f"expected by {situation.on_clock(end):.4g} s"
        )
        return (
            f"{' and '.join(at.operators)} {f'taking {task!r} apart' if at.undoing else repr(task)}"
            f" {state}"
        )

    now = [going(task, at) for task, at in situation.running.items()]
    told = [f"{' and '.join(row['operators'])} {named(row['task'])}" for row in decision["starts"]]
    asked = [f"{human}, please {named(task)}" for human, task in decision["announced"].items()]
    withdrawn = [
        f"{' and '.join(row['operators'])} not {row['task']!r} after all"
        for row in decision["revoked"]
    ]
    rows = [("now", now), ("next", [*told, *asked]), ("withdrawn", withdrawn)]
    return [
        *(f"  {label:<8} {' · '.join(words)}" for label, words in rows if words),
        f"  {'why':<8} {decision['why']}",
    ]


def _latency(document: dict[str, Any]) -> str:
    latency = document["latency_ms"]
    return (
        f"{document['decisions']} decisions in {latency['p50']:.1f} ms (median),"
        f" {latency['p99']:.1f} ms (99 %), {document['late']} late"
    )
