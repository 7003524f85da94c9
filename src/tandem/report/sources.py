"""What a report rests on: the assumptions behind its plans, and how they were made."""

from __future__ import annotations

import tandem
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront
from tandem.plan.result import Front, Status
from tandem.report.language import Words


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
    used = {task.tool: None for task in cell.tasks.values() if task.tool}
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
    repeats = "cycle." if isinstance(front, CycleFront) else ""
    found += [t(f"{repeats}assume.breaks", breaks=", ".join(breaks))] if breaks else []
    found += [t(f"{repeats}assume.setup", setups=", ".join(setups))] if setups else []
    found += [t("assume.limits", limits=", ".join(limits))] if limits else []
    found += (
        [t("assume.same", pairs=", ".join(f"{a} + {b}" for a, b in cell.same_operator))]
        if cell.same_operator
        else []
    )
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


def made(
    front: Front | CycleFront, t: Words, command: str = "", date: str = ""
) -> list[tuple[str, str]]:
    """(what, value) of program, solver, seed and the like; what is not known is left out."""
    entries = [
        ("program", f"tandem {tandem.__version__}"),
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
