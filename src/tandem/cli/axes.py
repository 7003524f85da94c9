"""`tandem plan --measure` and `--axes`: fronts over other measures than the sum of stress."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.names import Known
from tandem.cli.options import F, is_given
from tandem.cli.outputs import kept_when_interrupted, tell_written
from tandem.errors import UsageError

if TYPE_CHECKING:
    from rich.table import Table

    from tandem.cell.model import Cell
    from tandem.plan.axes.search import AxesFront, Point

EXCLUDED = {
    "method": "--method",
    "minimize": "--minimize",
    "weights": "--weights",
    "max_stress": "--max-stress",
    "max_makespan": "--max-makespan",
    "cycle": "--cycle",
    "takt": "--takt",
    "mix": "--mix",
    "batch": "--batch",
    "max_in_process": "--max-in-process",
    "work": "--work",
    "cv": "--cv",
    "robust": "--robust",
    "risk": "--risk",
    "plan_file": "--from",
    "explain_bound": "--explain-bound",
    "point": "--point",
    "report": "--report",
}
"""Options that fronts over other measures do not know."""

OF_MEASURES = {
    "limit": "--limit",
    "within": "--within",
    "shift": "--shift",
    "cycles_per_shift": "--cycles-per-shift",
}
"""Options that nothing but fronts over other measures knows."""


def axes_options(command: F) -> F:
    """`--measure`, `--axes` and what goes with them."""
    options = (
        click.option(
            "--measure",
            metavar="NAME",
            multiple=True,
            help=(
                "The front of the makespan and this measure in place of stress: dose:SCALE,"
                " peak:SCALE, time-above:SCALE:LEVEL, time-weighted:SCALE,"
                " fatigue:SCALE:RISE:RECOVERY, worst:MEASURE. Repeat it for several fronts."
            ),
        ),
        click.option(
            "--axes",
            metavar="makespan,NAME,...",
            help="One front over the makespan and several measures at once.",
        ),
        click.option(
            "--shift",
            type=click.FloatRange(min=0, min_open=True),
            default=28_800.0,
            show_default=True,
            help="Seconds of a shift: a dose counts shift / makespan cycles.",
        ),
        click.option(
            "--cycles-per-shift",
            type=click.FloatRange(min=0, min_open=True),
            help="Products of a shift that a dose counts, instead of as many as fit.",
        ),
        click.option(
            "--limit",
            metavar="NAME[@PERSON]=MOST",
            multiple=True,
            help=(
                "With --measure or --axes: the most of a measure that a person may have, never"
                " exceeded, such as peak:reba=7; each person when none is named."
            ),
        ),
        click.option(
            "--within",
            metavar="AXIS=MOST",
            multiple=True,
            help=(
                "With --measure or --axes: show only points with at most so much on this axis, such"
                " as makespan=120. Files and the document have all points."
            ),
        ),
    )
    for option in reversed(options):
        command = option(command)
    return command


@dataclass(frozen=True)
class Asked:
    """What the options say; false when they ask for nothing."""

    measures: tuple[str, ...]
    axes: str | None
    shift_s: float
    cycles: float | None = None
    limits: tuple[str, ...] = ()
    within: tuple[tuple[str, float], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.measures) or self.axes is not None

    @property
    def fronts(self) -> list[list[str]]:
        """The axes of each front."""
        if self.axes is not None:
            return [self.axes.split(",")]
        return [["makespan", name] for name in self.measures]


def asked_of(
    measures: tuple[str, ...],
    axes: str | None,
    shift_s: float,
    cycles: float | None,
    limits: tuple[str, ...],
    within: tuple[str, ...],
    outputs: Iterable[Path],
) -> Asked:
    """What the options ask for. Raises UsageError with all that does not go together."""
    asked = Asked(measures, axes, shift_s, cycles, limits)
    if asked:
        _refuse_others(outputs)
        return replace(asked, within=_bounds(within, asked.fronts))
    if alone := [option for name, option in OF_MEASURES.items() if is_given(name)]:
        goes = "goes" if len(alone) == 1 else "go"
        raise UsageError(
            f"{', '.join(alone)} {goes} with --measure or --axes, such as --axes makespan,stress."
        )
    return asked


def _bounds(within: tuple[str, ...], fronts: list[list[str]]) -> tuple[tuple[str, float], ...]:
    """`AXIS=MOST` as the axis and the number. Raises UsageError for an axis that is not asked for,
    and for what is no number.
    """
    axes = list(dict.fromkeys(name.strip() for names in fronts for name in names))
    found, wrong = list[tuple[str, float]](), list[str]()
    for text in within:
        name, _, most = text.rpartition("=")
        try:
            found.append((name.strip(), float(most)))
        except ValueError:
            most = "nan"
        if math.isnan(float(most)):
            wrong.append(f"--within {text}: write an axis and a number, such as {axes[0]}=120.")
        elif name.strip() not in axes:
            wrong.append(f"--within {text}: no axis is called so. {Known(axes).hint(name.strip())}")
    if wrong:
        raise UsageError("\n".join(wrong))
    return tuple(found)


def _refuse_others(outputs: Iterable[Path]) -> None:
    from tandem.draw.saving import PICTURES
    from tandem.report.files import ready_to_write

    outputs = tuple(outputs)
    wrong = [option for name, option in EXCLUDED.items() if is_given(name)]
    told = [f"{', '.join(wrong)}: not with --measure or --axes; take it out."] if wrong else []
    if is_given("measure") and is_given("axes"):
        told.append("--measure and --axes exclude each other: give one of them.")
    kinds = (".json", *PICTURES)
    told += [
        f"{path}: fronts over measures are written as {', '.join(kinds)}."
        for path in outputs
        if path.suffix.lower() not in kinds
    ]
    if told:
        raise UsageError("\n".join(told))
    ready_to_write(outputs)


def tell_axes(
    cell: Cell,
    asked: Asked,
    outputs: Sequence[Path],
    *,
    cell_file: str,
    source: str | None,
    as_json: bool,
    lang: str,
    **effort: Any,
) -> int:
    """Plans and tells what was asked for; the exit code."""
    from tandem.plan.axes.search import axes_named, plan_axes

    for names in asked.fronts:
        axes_named(names, cell)  # all that is wrong before a long search begins
    fronts: list[AxesFront] = []
    for names in asked.fronts:
        front = plan_axes(
            cell,
            names,
            shift_s=asked.shift_s,
            cycles=asked.cycles,
            limits=asked.limits,
            **effort,
        )
        fronts.append(replace(front, source=source))
        if front.interrupted:
            break
    document = fronts[0].to_dict() if len(asked.fronts) == 1 else _several(fronts)
    outputs = [*outputs, *kept_when_interrupted(fronts[-1], outputs, cell_file)]
    for path in outputs:
        _write(fronts, document, path, lang)
    if as_json:
        click.echo(json.dumps(document, ensure_ascii=False))
    else:
        _show(fronts, asked.within, lang)
    tell_written(outputs, lang)
    return 130 if fronts[-1].interrupted else 0


def _several(fronts: Sequence[AxesFront]) -> dict[str, Any]:
    return {"schema_version": 1, "fronts": [front.to_dict() for front in fronts]}


def _write(fronts: Sequence[AxesFront], document: Any, path: Path, lang: str) -> None:
    from tandem.draw.axes import draw_axes
    from tandem.draw.saving import save
    from tandem.files.atomic import store

    if path.suffix.lower() == ".json":
        store(path, (json.dumps(document, indent=2, ensure_ascii=False) + "\n").encode())
    else:
        save(draw_axes(fronts, language=lang), path)


def _show(fronts: Sequence[AxesFront], within: Sequence[tuple[str, float]], lang: str) -> None:
    import sys

    from rich.console import Console

    console = Console(file=sys.stdout, highlight=False)
    for front in fronts:
        shown = [point for point in front.points if _is_within(point, front, within)]
        console.print(_table(front, shown, lang))
        for line in _remarks(front, shown, lang):
            console.print(line, soft_wrap=True)


def _is_within(point: Point, front: AxesFront, within: Sequence[tuple[str, float]]) -> bool:
    worth = dict(zip(front.axes, point.values, strict=True))
    return all(worth[name] <= most for name, most in within if name in worth)


def _table(front: AxesFront, shown: Sequence[Point], lang: str) -> Table:
    from rich.table import Table

    from tandem.report.language import words

    t = words(lang)
    key = "axes.complete" if front.complete else "axes.open"
    title = t(key, points=t.count("axes.points", len(front.points)), seconds=f"{front.wall_s:.1f}")
    table = Table(title=title, title_justify="left", title_style="bold")
    for axis in front.axes:
        table.add_column("makespan [s]" if axis == "makespan" else axis, justify="right")
    table.add_column(t("axes.humans"))
    for point in shown:
        human = [
            row.task for row in point.schedule if any(o in front.cell.humans for o in row.operators)
        ]
        values = [f"{value:.6g}" for value in point.values]
        mark = "" if point.proven else " ?"
        table.add_row(*values[:-1], values[-1] + mark, ", ".join(human))
    return table


def _remarks(front: AxesFront, shown: Sequence[Point], lang: str) -> Iterable[str]:
    """What the numbers mean, where that could be taken for something else."""
    from tandem.report.language import words

    t = words(lang)
    if len(shown) < len(front.points):
        least = map(min, zip(*(point.values for point in front.points), strict=True))
        each = ", ".join(
            f"{axis} {t.number(value)}" for axis, value in zip(front.axes, least, strict=True)
        )
        yield t("axes.within", shown=len(shown), points=len(front.points), least=each)
    if any(axis.removeprefix("worst:").startswith("dose:") for axis in front.axes):
        if front.cycles is None:
            yield t("axes.dose", hours=t.number(front.shift_s / 3600))
        else:
            yield t("axes.dose.cycles", cycles=t.number(front.cycles))
    if front.limits:
        yield t("axes.limits", limits=", ".join(front.limits))
    if any("fatigue:" in axis for axis in front.axes):
        yield t("axes.fatigue")
    if front.rounded:
        yield t("axes.rounded", names=", ".join(front.rounded))
    if any(not point.proven for point in shown):
        yield t("axes.unproven")
