"""What somebody else made of the cell (learned policies, rules, chance), beside its exact front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tandem.cell.model import Cell
from tandem.report.language import Words
from tandem.report.markup import Markup, join, tag
from tandem.report.svg_gantt import gantt
from tandem.report.tables import table
from tandem.schedule.model import Schedule


@dataclass(frozen=True)
class Player:
    """How somebody played the cell.

    Attributes:
      name: such as "greedy" or "random".
      makespan, stress: seconds and the cell's measure, means over episodes; None when none was
        finished.
      gap: how far above the exact optimum of the same question, as a share; None when that is not
        known.
      schedule: of the one episode when there is just one.
    """

    name: str
    makespan: float | None
    stress: float | None
    gap: float | None = None
    schedule: Schedule | None = None


def players_section(cell: Cell, players: Sequence[Player], t: Words) -> Markup:
    """A table of the players, and a Gantt chart for the first one who has a schedule. Empty without
    players.
    """
    if not players:
        return Markup("")
    heads = [
        (t("players.name"), ""),
        (t("front.makespan"), "number"),
        (t("front.stress"), "number"),
        (t("players.gap"), "number"),
    ]
    rows = [
        tag(
            "tr",
            tag("th", t(f"player.{p.name}") if p.name in NAMED else p.name, scope="row"),
            *(tag("td", v, class_="number") for v in _values(p, t)),
        )
        for p in players
    ]
    shown = next((p for p in players if p.schedule is not None and p.makespan is not None), None)
    chart = Markup("")
    if shown is not None and shown.schedule is not None:
        values = {
            "makespan": t.seconds(shown.makespan or 0.0),
            "stress": t.number(shown.stress or 0.0),
        }
        chart = join(
            [
                tag("h3", t("players.schedule", **values)),
                gantt(cell, shown.schedule, t, label=t("players.schedule", **values)),
            ]
        )
    title, lead = tag("h2", t("players.title"), id="players"), tag("p", t("players.lead"))
    return tag("section", title, lead, table(heads, rows, t("players.title")), chart)


NAMED = ("greedy", "sampled", "random")
"""Players whose names are said in the reader's language."""


def _values(player: Player, t: Words) -> tuple[str, str, str]:
    def shown(value: float | None) -> str:
        return "–" if value is None else t.number(round(value, 2))

    return (
        shown(player.makespan),
        shown(player.stress),
        "–" if player.gap is None else t.share(player.gap),
    )
