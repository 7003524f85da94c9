"""`tandem compare`: what changed between two cells, or between two plans."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.options import AS_JSON, LANGUAGE, check_time, point_options
from tandem.cli.stored import is_plan, stored_plan
from tandem.cli.what_if import difference_lines
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.schedule.model import Schedule


@click.command("compare")
@click.argument("before_file", metavar="BEFORE", type=click.Path(dir_okay=False))
@click.argument("after_file", metavar="AFTER", type=click.Path(dir_okay=False))
@point_options
@click.option(
    "--plan/--no-plan",
    "planned",
    default=True,
    show_default=True,
    help="For cells: plan both, and say what becomes of each point of the front.",
)
@click.option(
    "--time-limit",
    type=float,
    default=20.0,
    show_default=True,
    help="Seconds for planning each cell.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@LANGUAGE
@AS_JSON
def compare_command(
    before_file: str,
    after_file: str,
    point: int | None,
    makespan: float | None,
    stress: float | None,
    planned: bool,
    time_limit: float,
    seed: int,
    lang: str,
    as_json: bool,
) -> None:
    """Say what changed between two cells, or between two plans that `tandem plan` has stored.

    \b
    Examples:
      tandem compare cell.yaml faster-robot.yaml
      tandem compare monday.json tuesday.json --point 1
      tandem compare monday.json tuesday.json --makespan 30 --lang de

    Of two plans the very schedules in them are compared; --point, --makespan and --stress choose
    from each of them.
    """
    check_time(time_limit, None)
    plans = [is_plan(name) for name in (before_file, after_file)]
    if plans[0] != plans[1]:
        raise UsageError(
            f"{before_file} and {after_file} are a cell and a result: give two cells or two"
            " results."
        )
    if not plans[0]:
        _compare_cells(before_file, after_file, planned, time_limit, seed, lang, as_json)
        return
    names = dict.fromkeys((before_file, after_file))
    which = (point, makespan, stress)
    sides = {name: _side(Path(name), which, lang) for name in names}
    _compare_plans(sides[before_file], sides[after_file], lang, as_json)


def _compare_cells(
    before_file: str,
    after_file: str,
    planned: bool,
    time_limit: float,
    seed: int,
    lang: str,
    as_json: bool,
) -> None:
    from tandem.explain.compare import compare_cells
    from tandem.explain.fronts import changes
    from tandem.explain.language import words
    from tandem.files.load import load
    from tandem.plan.methods import plan

    before, after = load(before_file), load(after_file)
    found = compare_cells(before, after)
    fronts = (
        [plan(cell, time_limit=time_limit, seed=seed, confirm=False) for cell in (before, after)]
        if planned and found
        else []
    )
    if as_json:
        _print(
            {
                "schema_version": 1,
                "kind": "cells",
                "digests": [before.digest, after.digest],
                "changes": [change.to_dict(lang) for change in found],
                "front_changes": [
                    change.to_dict() for change in (changes(*fronts) if fronts else ())
                ],
                "complete": all(front.complete for front in fronts),
            }
        )
        return
    said = [change.sentence(lang) for change in found]
    click.echo("\n".join(said or [words(lang)("cells.same")]))
    if fronts:
        click.echo("\n".join(["", *difference_lines(fronts[0], fronts[1], lang)]))


@dataclass(frozen=True)
class _Side:
    """One schedule of a result document.

    Attributes:
      point: its number, counted from 1.
      values: makespan in seconds, and stress.
      plan: how it is named, with what a reader must not overlook.
      cell_digest: of the cell that it was made for; None when the document does not say.
    """

    point: int
    values: tuple[float, float]
    schedule: Schedule
    plan: str
    canonical: bool
    stale: bool
    cell_digest: str | None

    def to_dict(self) -> dict[str, Any]:
        from tandem.cell.model import plain

        return {
            "makespan": plain(self.values[0]),
            "stress": plain(self.values[1]),
            "point": self.point,
            "digest": self.schedule.digest,
            "canonical": self.canonical,
            "stale": self.stale,
        }


def _side(path: Path, which: tuple[int | None, float | None, float | None], lang: str) -> _Side:
    """The point of a stored plan that is meant. Raises UsageError when it has none such, and what
    `read_plan` raises.
    """
    from tandem.draw.imprint import imprint
    from tandem.explain.language import words
    from tandem.plan.choice import point_of
    from tandem.report.results import read_result

    if "cell_document" not in (document := read_result(path)):
        return _bare_side(path, document, which, lang)
    plan = stored_plan(path, language=lang)
    try:
        place = point_of(plan.front, *which)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from None
    result = plan.front[place]
    return _Side(
        place + 1,
        plan.front.points[place],
        result.schedule,
        imprint(result, words(lang), stale=plan.is_stale),
        result.canonical,
        plan.is_stale,
        plan.made_for,
    )


def _bare_side(
    path: Path,
    document: Mapping[str, Any],
    which: tuple[int | None, float | None, float | None],
    lang: str,
) -> _Side:
    """The same of a document without its cell, which nothing can be judged by."""
    from tandem.explain.language import words
    from tandem.plan.choice import chosen
    from tandem.report.project import stale_at_home
    from tandem.report.results import points_of, schedules_of
    from tandem.report.stored import stale_note

    values = points_of(document, str(path))
    try:
        place = chosen(values, *which)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from None
    if stale := stale_at_home(path):
        click.echo(stale_note(path, lang), err=True)
    schedule = schedules_of(document)[place]
    named = words(lang)("imprint.plan", digest=schedule.digest)
    return _Side(
        place + 1, values[place], schedule, named, False, stale, document.get("cell_digest")
    )


def _compare_plans(before: _Side, after: _Side, lang: str, as_json: bool) -> None:
    from tandem.explain.compare import compare_schedules
    from tandem.explain.language import words

    t = words(lang)
    moves = compare_schedules(before.schedule, after.schedule)
    moved = [move for move in moves if move.changed]
    if as_json:
        _print(
            {
                "schema_version": 1,
                "kind": "results",
                "same_cell": before.cell_digest == after.cell_digest,
                "before": before.to_dict(),
                "after": after.to_dict(),
                "tasks": [move.to_dict() for move in moves],
            }
        )
        return
    lines = [] if before.cell_digest == after.cell_digest else [t("move.cells")]
    lines.append(
        t("move.same", plan=before.plan)
        if before.plan == after.plan
        else t("move.digests", before=before.plan, after=after.plan)
    )
    values = {
        "before": t.seconds(before.values[0]),
        "after": t.seconds(after.values[0]),
        "stress_before": t.number(before.values[1]),
        "stress_after": t.number(after.values[1]),
    }
    lines.append(t("move.values", **values))
    lines += [move.sentence(lang) for move in moved] or [t("move.none")]
    if moved and len(moved) < len(moves):
        lines.append(t("move.rest", n=len(moves) - len(moved), of=len(moves)))
    click.echo("\n".join(lines))


def _print(document: dict[str, Any]) -> None:
    click.echo(json.dumps(document, ensure_ascii=False))
