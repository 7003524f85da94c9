"""`tandem plan`, `tandem check`, `tandem methods`: the trade-off of a cell, and what is wrong with
a cell or a schedule.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.axes import Asked, asked_of, axes_options, tell_axes
from tandem.cli.cycle import Outputs, Repeated, answer, cycle_options
from tandem.cli.options import (
    FORMAT,
    LANGUAGE,
    OUTPUTS,
    WORK,
    Weights,
    check_work,
    is_given,
)
from tandem.cli.outputs import (
    kept_when_interrupted,
    proofs_of,
    says_infeasible,
    show,
    source_of,
    tell_written,
    write_outputs,
)
from tandem.cli.project import sound, tell_folder
from tandem.cli.risk import AskedRisk, told_risk
from tandem.cli.seeds import say_which_seed
from tandem.cli.stored import is_plan
from tandem.cli.what_if import difference, tell_difference, variant_options
from tandem.errors import CellError, Fault, UnsoundScheduleError, UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.question import Question
    from tandem.plan.result import Front
    from tandem.schedule.model import Schedule


@click.command("plan")
@click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
@FORMAT
@click.option(
    "--method",
    default="exact",
    show_default=True,
    help="How to plan; `tandem methods` lists them, one of your own is package.module:method.",
)
@click.option(
    "--minimize",
    type=click.Choice(["makespan", "stress", "worst-stress", "cycle_time"]),
    help=(
        "Only the one schedule that is best in this and, among those, in the other; worst-stress is"
        " that of the human who has most, and then the makespan. cycle_time goes with --cycle."
    ),
)
@click.option(
    "--weights",
    type=Weights(),
    help="Only the one schedule with the least TIME * makespan (s) + STRESS * stress.",
)
@click.option("--max-stress", type=float, help="Only schedules of at most this stress.")
@click.option(
    "--max-makespan", type=float, help="Only schedules whose makespan is at most so many seconds."
)
@axes_options
@cycle_options
@click.option(
    "--time-limit",
    type=float,
    default=60.0,
    show_default=True,
    help=(
        "Seconds; what is found by then is given with its bounds. The risk counts in: it gets what"
        " the search leaves, and with --cv, --robust or --risk a third is set aside for it."
    ),
)
@WORK
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@click.option(
    "--workers",
    type=int,
    help=(
        "Threads; one per core when absent. What is proven does not depend on it, nor do the"
        " schedules behind it; with --work there is one."
    ),
)
@click.option(
    "--samples",
    type=click.IntRange(min=1),
    help="Of a method that draws schedules, such as learned: how many; 64 when absent.",
)
@click.option(
    "--learned",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="With --method learned: weights that were tuned to a cell, or the folder of their run.",
)
@click.option(
    "--cv",
    type=click.FloatRange(0.0, 10.0),
    default=0.0,
    show_default=True,
    help=(
        "How far times scatter where the cell does not say (coefficient of variation): each point"
        " shows P50 and P95 of its makespan when carried out."
    ),
)
@click.option("--robust", is_flag=True, help="Recommend by the P95 of the makespan as carried out.")
@click.option(
    "--risk/--no-risk",
    "risk",
    default=None,
    help=(
        "Also when the rest is re-planned at every event, as with --cv and --robust; or leave the"
        " risk out although the cell states a spread."
    ),
)
@click.option(
    "--from",
    "--hint",
    "plan_file",
    metavar="PLAN.json",
    type=click.Path(dir_okay=False, path_type=Path),
    help=(
        "A stored plan whose schedules to begin with: what `tandem plan --json` or `-o PLAN.json`"
        " wrote. Those that this cell and the limits refuse are left aside, and it is said why."
    ),
)
@click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print the result document on stdout and nothing else there.",
)
@click.option(
    "--explain-bound",
    is_flag=True,
    help="Say who proved each bound: sums, relaxations, CP-SAT, and what was confirmed without it.",
)
@OUTPUTS
@click.option(
    "--point",
    type=int,
    help=(
        "Whose schedule is shown, and stands in pictures, sheets and the MS Project file, counted"
        " from 1; the recommended compromise when absent."
    ),
)
@variant_options
@click.option(
    "--report",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the report: one HTML file that opens offline.",
)
@LANGUAGE
@click.option("-q", "--quiet", is_flag=True, help="No progress on stderr.")
@says_infeasible
def plan_command(
    cell_file: str,
    form: str | None,
    method: str,
    minimize: str | None,
    weights: tuple[float, float] | None,
    max_stress: float | None,
    max_makespan: float | None,
    measure: tuple[str, ...],
    axes: str | None,
    shift: float,
    cycles_per_shift: float | None,
    limit: tuple[str, ...],
    within: tuple[str, ...],
    cycle: bool,
    takt: float | None,
    max_in_process: int | None,
    mix: dict[str, int] | str | None,
    one_allocation: bool,
    batch: int | None,
    product: str | None,
    time_limit: float,
    work: float | None,
    seed: int,
    workers: int | None,
    samples: int | None,
    learned: Path | None,
    cv: float,
    robust: bool,
    risk: bool | None,
    plan_file: Path | None,
    as_json: bool,
    explain_bound: bool,
    outputs: tuple[Path, ...],
    point: int | None,
    report: Path | None,
    sets: tuple[str, ...],
    without: tuple[str, ...],
    force: tuple[str, ...],
    lang: str,
    quiet: bool,
) -> int:
    """Find every compromise between completion time and stress, with proof.

    \b
    Examples:
      tandem plan cell.yaml
      tandem plan cell.yaml --minimize makespan --json > result.json
      tandem plan cell.yaml --explain-bound
      tandem plan cell.yaml --cv 0.2 --robust
      tandem plan cell.yaml --cycle
      tandem plan cell.yaml --takt 30 --max-in-process 2 --report takt.html
      tandem plan cell.yaml --measure peak:reba --measure dose:duet -o measures.png
      tandem plan cell.yaml --axes makespan,dose:shoulder_tool,worst:stress
      tandem plan cell.yaml --cycle --mix short=2,long=1
      tandem plan cell.yaml -o plan.json -o sheets.xlsx --point 2 --lang de
      tandem plan cell.yaml --seed 7 --work 5 --json
      tandem plan cell.yaml --from plan.json --time-limit 600 -o plan.json
      tandem plan cell.yaml --set tasks.6.time.robot=8 --without robot2 --force 5=human

    With --set, --without or --force the variant is planned, and what becomes of each point of
    CELL's own front is said. `tandem report plan.json` makes any file later, of any point, without
    planning anew.

    With --cycle or --takt the station makes one product after the other, and operators may work on
    several at once: the cycle time is then what a line is planned by, and the makespan only how
    long one product stays.

    Ctrl-C ends the search: what was found so far is printed with its bounds and saved (in
    CELL.interrupted.json when no .json file was asked for), and the exit code is 130.
    """
    from tandem.plan.methods import plan

    check_work(work)
    files = [*outputs, *([report] if report else [])]
    repeated = Repeated(cycle, takt, max_in_process, batch, mix, one_allocation)
    if minimize and weights:
        raise UsageError("--minimize and --weights exclude each other: give one of them.")
    asked = asked_of(measure, axes, shift, cycles_per_shift, limit, within, outputs)
    _check_drawing(samples, learned, bool(repeated or asked))
    _check_kind(repeated, asked, minimize, files)
    cell, base = _cell_to_plan(cell_file, form, product, sets, without, force)
    source = source_of(cell_file, is_variant=base is not None or product is not None)
    stem = "stdin" if cell_file == "-" else Path(cell_file).stem
    where = Outputs(tuple(files), source, stem, as_json, point, lang, quiet)
    effort: dict[str, Any] = {
        "time_limit": time_limit,
        "work": work,
        "seed": seed,
        "workers": workers,
    }
    # three kinds of answers: of one product after the other, over other measures, or of makespan
    # and stress, which the rest is about
    if repeated:
        return answer(
            cell, repeated, minimize, where, method=method, max_stress=max_stress, **effort
        )
    if asked:
        return tell_axes(
            cell,
            asked,
            outputs,
            cell_file=cell_file,
            source=source,
            as_json=as_json,
            lang=lang,
            time_limit=time_limit,
            seed=seed,
            workers=workers,
        )
    risky = AskedRisk(cv, robust, risk)
    risky.check(cell)
    question = _question(minimize, weights, max_makespan, max_stress)
    begin = _schedules_that_fit(plan_file, cell, question) if plan_file else None
    solve = partial(
        plan, question=question, method=method, samples=samples, policy=_policy_file(learned)
    )
    # the base of a variant is searched as long as the variant, so that the two can be compared
    search = {**effort, "time_limit": risky.searching(time_limit)}
    # by work no clock is asked, and all assemblies are carried out
    until = monotonic() + time_limit if work is None else None
    front = _searched(partial(solve, cell, hint=begin, **search), quiet, lang)
    if not front.interrupted:
        front = told_risk(front, risky, until, quiet)
    front = replace(front, source=source)
    kept = kept_when_interrupted(front, files, cell_file)
    where = replace(where, files=(*files, *kept))
    what_if = None if base is None else _WhatIf(base, partial(solve, base, **search))
    return _hand_over(front, where, what_if, explain_bound)


def _check_kind(
    repeated: Repeated, asked: Asked, minimize: str | None, files: Sequence[Path]
) -> None:
    """Refuses, before anything is read, options that do not go with the kind of answer, and of
    one product files that could not be written after the search.
    """
    from tandem.report.files import ready_to_write

    if repeated:
        repeated.check(minimize, is_given)
    elif minimize == "cycle_time":
        raise UsageError("--minimize cycle_time goes with --cycle.")
    elif not asked:
        ready_to_write(files)


def _cell_to_plan(
    cell_file: str,
    form: str | None,
    product: str | None,
    sets: tuple[str, ...],
    without: tuple[str, ...],
    force: tuple[str, ...],
) -> tuple[Cell, Cell | None]:
    """The cell, and where a variant of it is asked for the variant and the cell as it is."""
    from tandem.explain.variant import variant
    from tandem.files.load import load
    from tandem.plan.cycle.mix import product_of

    cell = product_of(load(cell_file, form), product)
    if sets or without or force:
        return variant(cell, sets, without, force), cell
    return cell, None


def _question(
    minimize: str | None,
    weights: tuple[float, float] | None,
    max_makespan: float | None,
    max_stress: float | None,
) -> Question:
    """What is asked of makespan and stress: all compromises, or one of them."""
    from tandem.plan.question import Question

    kind = minimize or ("weighted" if weights else "front")
    return Question(kind, weights or (1.0, 1.0), max_makespan, max_stress)  # type: ignore[arg-type]


def _searched(search: Callable[..., Front], quiet: bool, lang: str) -> Front:
    """What a search finds, which tells on stderr how far it has come."""
    from tandem.report.progress import SolveProgress

    with SolveProgress(quiet=quiet, language=lang) as progress:
        return search(on_solution=progress)


@dataclass(frozen=True)
class _WhatIf:
    """The cell as it is, when a variant was planned, and what plans it in the same way."""

    base: Cell
    plan_base: Callable[[], Front]


def _hand_over(front: Front, where: Outputs, what_if: _WhatIf | None, explain_bound: bool) -> int:
    """Writes what was found, then shows it, so that no pipe that closes costs a file; the exit
    code.
    """
    from tandem.report.language import words

    files, lang, point = where.files, where.lang, where.point
    if point is not None:
        point = _existing(front, point, files, lang) + 1
    write_outputs(front, files, lang, point=point)
    # an interrupted search is not followed by another one
    if what_if is None or front.interrupted:
        show(front, where.as_json, lang, point=point, explain_bound=explain_bound)
    else:
        _show_variant(what_if, front, where.as_json, lang, point, explain_bound)
    tell_written(files, lang)
    if front.interrupted:
        click.echo(words(lang)("terminal.stopped"), err=True)
    return 130 if front.interrupted else 0


def _policy_file(learned: Path | None) -> Path | None:
    """The file of a trained policy; of a run's folder that of its best seed, which is said."""
    if learned is None or not learned.is_dir():
        return learned
    from tandem.learn.training.runs import RunFolder

    say_which_seed(str(learned))
    run = RunFolder(learned)
    return run.policy(run.best_seed())


def _check_drawing(samples: int | None, learned: Path | None, otherwise: bool) -> None:
    """Refuses options of a method that draws where no method is asked."""
    for option, given in (("--samples", samples), ("--learned", learned)):
        if given is not None and otherwise:
            raise UsageError(
                f"{option} goes with plans of one product by makespan and stress, such as"
                " --method learned; leave it out here."
            )


def _existing(front: Front, point: int, files: Sequence[Path], lang: str) -> int:
    """Index of the point that was asked for; when there is none, what shows no single point is
    written before that is said, so that the search was not in vain.
    """
    from tandem.plan.choice import point_of

    try:
        return point_of(front, point)
    except UsageError:
        whole = [path for path in files if path.suffix.lower() == ".json"]
        write_outputs(front, whole, lang)
        tell_written(whole, lang)
        raise


def _show_variant(
    what_if: _WhatIf,
    front: Front,
    as_json: bool,
    lang: str,
    point: int | None,
    explain_bound: bool,
) -> None:
    """The front of a variant, and how it differs from that of the cell as it is: under `difference`
    in the document, or in words.
    """
    if as_json:
        bounds = {"bounds": proofs_of(front).to_dict(lang)} if explain_bound else {}
        changed = difference(what_if.base, front, what_if.plan_base, lang)
        more = {"difference": changed, **bounds}
        click.echo(json.dumps({**front.to_dict(), **more}, ensure_ascii=False))
        return
    show(front, as_json, lang, point=point, explain_bound=explain_bound)
    tell_difference(what_if.base, front, what_if.plan_base, lang)


@click.command("check")
@click.argument("cell_file", metavar="CELL|PLAN|FOLDER", type=click.Path(allow_dash=True))
@click.argument(
    "result_file",
    metavar="[RESULT]",
    required=False,
    type=click.Path(dir_okay=False, path_type=Path),
)
@FORMAT
@click.option("--json", "as_json", is_flag=True, help="Print what was found as one document.")
def check_command(
    cell_file: str, result_file: Path | None, form: str | None, as_json: bool
) -> None:
    """Say whether CELL is sound and, with RESULT, whether its schedules keep to it; whether a
    stored PLAN keeps to the cell that it holds; of a project's FOLDER, which results are stale.

    \b
    Examples:
      tandem check cell.yaml
      tandem check cell.yaml plan.json
      tandem check plan.json
      tandem check line-3

    A result is stale when it was made for another state of the cell. Exit code 3 when the cell is
    not sound, 6 when a schedule breaks it.
    """
    from tandem.files.load import load
    from tandem.report.results import patterns_of, points_of, read_result, stale
    from tandem.report.stored import cell_in, faults_in, stale_note, stale_now

    if cell_file != "-" and Path(cell_file).is_dir():
        if result_file is not None:
            raise UsageError(
                f"{cell_file} is a folder: give a cell file with a result, or the folder alone."
            )
        return tell_folder(Path(cell_file), as_json)
    if result_file is None and is_plan(cell_file):
        result_file = Path(cell_file)
        document = read_result(result_file, cycles=True)
        cell, values = cell_in(document, result_file), points_of(document, cell_file)
        is_stale: bool | None = stale_now(document, result_file)[1]
    else:
        cell, values = load(cell_file, form), []
        document = read_result(result_file, cycles=True) if result_file else {"front": []}
        is_stale = stale(document, cell)
    found = faults_in(document, cell, values)
    if as_json:
        answer: dict[str, Any] = {
            "schema_version": 1,
            "cell": cell.name,
            "cell_digest": cell.digest,
        }
        if result_file:
            answer["stale"] = is_stale
            answer["plans"] = [pattern.digest for pattern in patterns_of(document)]
        wrong = [{"point": place, "fault": fault} for place, fault in found]
        click.echo(json.dumps({**answer, "faults": wrong}, ensure_ascii=False))
    if result_file and is_stale:
        click.echo(stale_note(result_file), err=True)
    if found:
        raise UnsoundScheduleError([f"schedule {place}: {fault}" for place, fault in found])
    if not as_json:
        click.echo(sound(cell, cell_file))
        count = len(document["front"])
        if count:
            whose = "the cell" if str(result_file) != cell_file else "the cell that it holds"
            click.echo(f"{result_file}: {count} schedule{'s' * (count != 1)}, none breaks {whose}.")
    return None


@click.command("methods")
@click.option("--json", "as_json", is_flag=True, help="Print them as one document.")
def methods_command(as_json: bool) -> None:
    """List the methods of planning."""
    from tandem.plan.methods import METHODS, describe

    if as_json:
        click.echo(
            json.dumps(
                {
                    "schema_version": 1,
                    "methods": [
                        {"name": name, "kind": "planning", "what": describe(name)}
                        for name in METHODS
                    ],
                }
            )
        )
        return
    width = max(map(len, METHODS))
    for name in METHODS:
        click.echo(f"{name:<{width}}  {describe(name)}")


def _schedules_that_fit(path: Path, cell: Cell, question: Question) -> list[Schedule]:
    """The schedules of a stored plan that keep the cell and the limits; how many do, and what is
    wrong with the others, is said in one line.
    """
    from tandem.report.results import read_result, schedules_of, stale
    from tandem.schedule.checker import faults

    document = read_result(path)
    schedules = schedules_of(document)
    if not schedules:
        raise CellError([Fault("holds no schedule.", (), str(path))])
    limits = {"max_makespan": question.max_makespan, "max_stress": question.max_stress}
    wrong = {
        place: found[0]
        for place, schedule in enumerate(schedules)
        if (found := faults(cell, schedule, **limits))
    }
    fit = [schedule for place, schedule in enumerate(schedules) if place not in wrong]
    made_for = ", stale: made for another state of the cell" if stale(document, cell) else ""
    told = f"--from {path}{made_for}: {len(fit)} of {len(schedules)} schedules fit"
    if wrong:
        place, fault = next(iter(wrong.items()))
        told += f"; {len(wrong)} left aside, point {place + 1}: {fault}"
    click.echo(told.rstrip(".") + ".", err=True)
    return fit
