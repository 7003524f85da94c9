"""What a report rests on: the assumptions behind its plans, and how they were made."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import version

from tandem.cell.model import Cell
from tandem.cell.walking import SPEED
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront
from tandem.plan.result import Front, Status
from tandem.report.language import Words
from tandem.report.limits import assumed as limits_assumed
from tandem.report.waits import wait_words


def assumptions(front: Front | CycleFront, t: Words) -> list[str]:
    """What was modelled and how far it is proven, in sentences. Only what this cell has; of a
    station that repeats it is said that breaks and set-up play no part.
    """
    cell = front.cell
    shown = looks(cell)
    found = [
        t("assume.units"),
        t("assume.table" if cell.stress_of_set is not None else "assume.sum"),
        t("assume.tasks"),
        t("assume.fixed"),
    ]
    used = dict.fromkeys(tool for task in cell.tasks.values() for _, tool in task.tools_named())
    zones = {task.zone: None for task in cell.tasks.values() if task.zone}
    breaks = [
        f"{shown[o].label} {t.number(a)}–{t.number(b)} s"
        for o, operator in cell.operators.items()
        for a, b in operator.breaks
    ]
    setups = [
        f"{shown[o].label} {t.number(operator.setup)} s"
        for o, operator in cell.operators.items()
        if operator.setup
    ]
    limits = [
        f"{shown[o].label} {t.number(operator.stress_limit)}"
        for o, operator in cell.operators.items()
        if operator.stress_limit is not None
    ]
    if any(task.together for task in cell.tasks.values()):
        found.append(t("assume.joint"))
    if used:
        found.append(
            t(
                "assume.tools",
                tools=", ".join(
                    t(
                        "assume.tool",
                        tool=name,
                        n=cell.tools[name].capacity if name in cell.tools else 1,
                    )
                    for name in used
                ),
            )
        )
    found += [
        t("assume.holds", name=shown[o].label, first=first, last=last)
        for o, operator in cell.operators.items()
        for first, last in operator.holds
    ]
    for name in zones:
        if apart := cell.zones[name].apart if name in cell.zones else ():
            found.append(t("assume.apart", zone=name, kinds=", ".join(map(t, apart))))
    if zones:
        found.append(
            t(
                "assume.zones",
                zones=", ".join(
                    f"{name} {cell.zones[name].capacity if name in cell.zones else 1}"
                    for name in zones
                ),
            )
        )
    if cell.walking:
        found.append(t("assume.walk", walks=", ".join(_walks(cell, t))))
    about_breaks = "assume.breaks.walk" if cell.walking else "assume.breaks"
    about_setup = "assume.setup"
    if isinstance(front, CycleFront):
        about_breaks, about_setup = "cycle.assume.breaks", "cycle.assume.setup"
    found += [t(about_breaks, breaks=", ".join(breaks))] if breaks else []
    found += [t(about_setup, setups=", ".join(setups))] if setups else []
    found += [t("assume.limits", limits=", ".join(limits))] if limits else []
    found += limits_assumed(cell, t)
    found += (
        [t("assume.same", pairs=", ".join(f"{a} + {b}" for a, b in cell.same_operator))]
        if cell.same_operator
        else []
    )
    waits = [f"{name} {said}" for name in cell.tasks for said in wait_words(cell, name, t)]
    found += [t("assume.wait", waits="; ".join(waits))] if waits else []
    found += (
        [t("assume.release")]
        if any(task.release or task.deadline is not None for task in cell.tasks.values())
        else []
    )
    proven = sum(result.status == Status.OPTIMAL for result in front)
    found += [
        t("assume.checked"),
        t("proof.complete") if front.complete else t("proof.partial", proven=proven, n=len(front)),
    ]
    return found


def _walks(cell: Cell, t: Words) -> Iterator[str]:
    """How long walking takes whom: by a speed, or pair by pair; both directions at once where they
    take the same.
    """
    for who, times in cell.walking.items():
        name = looks(cell)[who].label
        if SPEED in cell.walk[who]:
            yield t("assume.walk.speed", who=name, speed=t.number(cell.walk[who][SPEED]))
            continue
        for (origin, place), time in times.items():
            back = times.get((place, origin), 0.0)
            if time != back or cell.place_names.index(origin) < cell.place_names.index(place):
                seconds = t.seconds(time)
                yield t("assume.walk.pair", who=name, origin=origin, place=place, seconds=seconds)


def made(
    front: Front | CycleFront, t: Words, command: str = "", date: str = ""
) -> list[tuple[str, str]]:
    """(what, value) of program, solver, seed and the like; what is not known is left out."""
    entries = [
        ("program", f"tandem {version('tandem')}"),
        ("solver", front.solver),
        ("method", front.method),
        ("seed", str(front.seed)),
        ("time", f"{t.number(round(front.wall_s, 3))} s"),
        ("cell", front.cell.name or t("unnamed")),
        ("digest", front.cell.digest),
        ("command", command),
        ("date", date),
    ]
    return [(t(f"made.{key}"), value) for key, value in entries if value]
