"""`tandem score`: from facts about tasks to scores, with every step."""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.language import Words
from tandem.cli.options import AS_JSON, LANGUAGE
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.assessment.pages import Assessment
    from tandem.cell.model import Cell
    from tandem.ergonomics.tasks import Scored
    from tandem.schedule.model import Schedule


@click.command("score", epilog="What each method is for, its facts and sources: docs/ergonomics.md")
@click.argument(
    "facts_file",
    metavar="[FILE]",
    required=False,
    type=click.Path(path_type=Path, dir_okay=False, allow_dash=True),
)
@click.option("--method", metavar="NAME", help="Of rows that name none; alone with --facts.")
@click.option(
    "--function",
    "step",
    metavar="STEP",
    help="One published step of --method, such as rula_table_c.",
)
@click.option(
    "--facts",
    "facts",
    metavar="FILE|-",
    help="Facts of one calculation of --method, JSON or YAML, by their published names.",
)
@click.option(
    "--angles",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Joint angles per frame, CSV: --method of the median, 95th percentile and peak posture.",
)
@click.option(
    "--plan",
    "plan",
    type=click.Path(dir_okay=False, path_type=Path),
    help="A stored plan of the cell FILE: what it does to each person in a shift.",
)
@click.option(
    "--point", type=int, help="A point of that plan's front; the recommended one when absent."
)
@click.option(
    "--hours",
    type=click.FloatRange(0, 24, min_open=True),
    default=8.0,
    show_default=True,
    help="Work in a shift that repeats --plan, without its breaks.",
)
@click.option(
    "--fill",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the cell FILE with the score beside the facts of each task.",
)
@click.option("--cycles", type=click.FloatRange(0, min_open=True), help="Products a shift.")
@click.option(
    "--cautious",
    is_flag=True,
    help="Take the cautious value of each missing fact, and mark it as not stated.",
)
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a page that can be signed: .html, .pdf, .xlsx, .md or .json; may be repeated.",
)
@click.option(
    "--template",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a workbook of 20 example tasks to overwrite, and score nothing.",
)
@click.option(
    "--unverified",
    is_flag=True,
    help="Allow steps of ocra and kim_lhc, whose tables were recalled and not read.",
)
@click.option("--list", "listed", is_flag=True, help="List the methods and their facts.")
@AS_JSON
@LANGUAGE
def score_command(
    facts_file: Path | None,
    method: str | None,
    step: str | None,
    facts: str | None,
    angles: Path | None,
    plan: Path | None,
    point: int | None,
    hours: float,
    fill: Path | None,
    cycles: float | None,
    cautious: bool,
    outputs: tuple[Path, ...],
    template: Path | None,
    unverified: bool,
    listed: bool,
    as_json: bool,
    lang: str,
) -> None:
    """Score tasks by published ergonomic methods, from facts that engineers have.

    FILE holds facts: YAML or JSON (`tasks: {screw: {method: reba, trunk: 45, ...}}`), or a
    spreadsheet with a row for each task and side; or it is a cell file whose tasks have the key
    `ergonomics`. It prints score, level, reasons, which small change would move the level, and
    where each fact came from.

    \b
    Examples:
      tandem score --template facts.xlsx --lang de
      tandem score facts.xlsx --lang de -o assessment.html
      tandem score facts.yaml --cycles 420 --json
      tandem score cell.yaml --plan plan.json -o assessment.html
      tandem score --method rula --function rula_table_c --facts step.json --json
      tandem score --method reba --angles frames.csv --facts rest.yaml
    """
    _check_use(facts_file, method, step, facts, angles, template, listed)
    whole = {"method": method or "", "cycles": cycles, "cautious": cautious}
    is_cell = _is_cell(facts_file)
    if not is_cell and (plan is not None or fill is not None):
        raise UsageError(
            "--plan and --fill need a cell file: `tandem score CELL --plan PLAN.json`."
        )
    if listed:
        _list(as_json)
    elif template is not None:
        _template(template, lang)
    elif angles is not None:
        _angles(angles, facts, whole, outputs, as_json, lang)
    elif facts is not None:
        _refuse_unverified(method or "", unverified)
        _one(method or "", step, facts, as_json, lang)
    elif facts_file is not None and is_cell:
        _cell(facts_file, whole, (plan, point, hours), fill, outputs, as_json, lang)
    elif facts_file is not None:
        _file(facts_file, whole, outputs, as_json, lang)


def _check_use(
    facts_file: Path | None,
    method: str | None,
    step: str | None,
    facts: str | None,
    angles: Path | None,
    template: Path | None,
    listed: bool,
) -> None:
    alone = None if angles is not None else facts
    ways = (facts_file, alone, angles, template, listed or None)
    chosen = [given for given in ways if given is not None]
    if len(chosen) != 1:
        raise UsageError(
            "give one of: FILE (facts of tasks), --method NAME with --facts FILE (one calculation),"
            " --angles FILE, --template FILE, --list."
        )
    if (facts is not None or angles is not None) and method is None:
        raise UsageError("--facts and --angles need --method NAME; `--list` names them.")
    if step is not None and facts is None:
        raise UsageError("--function needs --facts FILE with the facts of that step.")


def _refuse_unverified(method: str, allowed: bool) -> None:
    from tandem.ergonomics.methods import UNVERIFIED

    if method in UNVERIFIED and not allowed:
        raise UsageError(
            f"--method {method}: tables or limits of it were recalled and not read in the source."
            " Give --unverified to compute it all the same; the answer says so."
        )


# --- one calculation ------------------------------------------------------------------------------


def _one(name: str, step: str | None, facts: str, as_json: bool, lang: str) -> None:
    """One calculation of one method, or one published step of it."""
    from tandem.assessment import sentences as say
    from tandem.assessment.document import of_outcome
    from tandem.ergonomics.methods import functions_of, published
    from tandem.ergonomics.outcome import Outcome

    functions = functions_of(name)
    given = _facts_of(facts)
    step = step or _fitting(name, given)
    if step in functions:
        given = _by_published_names(given, functions[step].model)
    found, t = published(name, step, given), say.words(lang)
    told = (
        of_outcome(t, found)
        if isinstance(found, Outcome)
        else {**found, "steps": [{"step": key, "value": value} for key, value in found.items()]}
    )
    recalled = {"unverified": True} if functions[step].unverified else {}
    if recalled:
        click.echo(f"tandem: {t('unverified')}", err=True)
    if as_json:
        click.echo(
            json.dumps({"method": name, "function": step, **told, **recalled}, ensure_ascii=False)
        )
    elif isinstance(found, Outcome):
        click.echo(say.explanation(t, found))
        click.echo("\n".join(f"  {say.step(t, one)}" for one in found.steps))
    else:
        click.echo("\n".join(f"{key}: {value}" for key, value in found.items()))


def _facts_of(source: str) -> dict[str, Any]:
    from tandem.ergonomics.facts import FactsError
    from tandem.errors import Fault
    from tandem.files.facts.document import tree

    try:
        text = sys.stdin.read() if source == "-" else Path(source).read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        said = getattr(error, "strerror", None) or "it is not UTF-8"
        raise FactsError([Fault(f"cannot be read: {said.lower()}.", place=source)]) from error
    name = "standard input" if source == "-" else source
    document = tree(text, name)
    if document.faults:
        raise FactsError(document.faults)
    found = document.plain()
    if not isinstance(found, dict):
        raise FactsError([Fault("facts are a mapping, such as {c: 5, d: 5}.", place=name)])
    return found


def _fitting(name: str, facts: Mapping[str, Any]) -> str:
    """The first published step whose facts these are by their names; the first one when none is."""
    from tandem.ergonomics.methods import METHODS, functions_of

    functions = functions_of(name)
    for step, one in functions.items():
        fields = {} if one.model is None else one.model.model_fields
        needed = {key for key, field in fields.items() if field.is_required()}
        if fields and needed <= set(facts) <= set(fields) and _fit_inside(fields, facts):
            return step
    main = METHODS[name].run if name in METHODS else None
    return next((step for step, one in functions.items() if one.run is main), next(iter(functions)))


def _fit_inside(fields: Mapping[str, Any], facts: Mapping[str, Any]) -> bool:
    """The names within `tasks` fit too, where there are any."""
    tasks = facts.get("tasks")
    if not isinstance(tasks, list) or not tasks or not isinstance(tasks[0], dict):
        return True
    inner = getattr(fields["tasks"].annotation, "__args__", (None,))[0]
    return inner is None or set(tasks[0]) <= set(inner.model_fields)


def _by_published_names(given: dict[str, Any], model: Any) -> dict[str, Any]:
    """The facts with other spellings of the vocabulary replaced by the published names."""
    from tandem.cell.stated import meanings

    if model is None:
        return given
    found = {}
    for name, value in given.items():
        fits = [one for one in meanings(name) if one in model.model_fields]
        known = name in model.model_fields or not fits or fits[0] in given
        found[name if known else fits[0]] = value
    return found


# --- tasks of a file ------------------------------------------------------------------------------


def _file(
    path: Path, whole: Mapping[str, Any], outputs: Iterable[Path], as_json: bool, lang: str
) -> None:
    from tandem.assessment import pages
    from tandem.assessment import sentences as say
    from tandem.cell.stated import Conditions
    from tandem.ergonomics.methods import method_named
    from tandem.ergonomics.tasks import scored, totals
    from tandem.files.facts.load import load_facts

    if whole["method"]:
        method_named(whole["method"])
    for output in outputs:
        pages.check(output)
    file = load_facts(path, Conditions(**whole))
    t = say.words(lang)
    for remark in file.remarks:
        click.echo(t("remark", what=remark), err=True)
    rows = [scored(task) for task in file.tasks]
    _put(t, pages.Assessment(file.name, rows, totals(rows), _made()), outputs, as_json)


def _is_cell(path: Path | None) -> bool:
    from tandem.files.facts.load import holds_cell

    return path is not None and holds_cell(path)


def _cell(
    path: Path,
    whole: Mapping[str, Any],
    by: tuple[Path | None, int | None, float],
    fill: Path | None,
    outputs: Iterable[Path],
    as_json: bool,
    lang: str,
) -> None:
    """The tasks of a cell that have facts, and what a plan of it does to each person."""
    from tandem.assessment import pages
    from tandem.assessment import sentences as say
    from tandem.assessment.shift import from_outside, rows_of, shift
    from tandem.ergonomics.tasks import scored
    from tandem.files.load import load

    if whole["method"] or whole["cautious"]:
        raise UsageError(
            "--method and --cautious are for files of facts alone. In a cell write `method` into"
            " the assessment, and `{value: 91, source: default}` for what is not known."
        )
    for output in outputs:
        pages.check(output)
    _refuse_to_replace(fill)
    cell, t = load(path), say.words(lang)
    if not any(task.ergonomics for task in cell.tasks.values()):
        click.echo(t("cell.none"), err=True)
    found = None
    cycles = cell.cycles_per_shift if whole["cycles"] is None else whole["cycles"]
    if by[0] is not None:
        schedule, each = _planned(by[0], cell, by[1], lang)
        found = shift(cell, schedule, each_s=each, hours=by[2], cycles=cycles)
    cycles = cycles if found is None else found.cycles
    rows = [scored(row) for row in rows_of(cell, _stated(cell, cycles))]
    name = cell.name or path.stem
    _put(
        t,
        pages.Assessment(name, rows, [], _made(), from_outside(cell), found),
        outputs,
        as_json,
    )
    if found is None and len(rows) > 1:
        click.echo(t("cell.no_totals"), err=True)
    if fill is not None:
        _fill(cell, fill, t)


def _planned(path: Path, cell: Cell, point: int | None, lang: str) -> tuple[Schedule, float]:
    """The schedule of a stored plan, and the seconds from one product to the next."""
    from tandem.cli.stored import holds_cycles, stored_plan
    from tandem.plan.choice import point_of

    if holds_cycles(path):
        raise UsageError(
            f"--plan {path}: this is a plan of a station that repeats, whose products overlap. Give"
            " a plan of one product, and --cycles N for the products of a shift."
        )
    stored = stored_plan(path, cell, lang)
    result = stored.front[point_of(stored.front, point)]
    return result.schedule, result.makespan


def _stated(cell: Cell, cycles: float | None) -> float:
    """How many products a shift has; it must be known where doses are worked out."""
    from tandem.cell.assessed import assessed

    if cycles is not None:
        return cycles
    doses = [
        one.task
        for one in assessed(cell)
        if one.given is not None and "reps" in type(one.given.facts).model_fields
    ]
    if doses:
        raise UsageError(
            f"task {doses[0]!r} has facts for a dose, which is that of a shift. Give --cycles N"
            " (products a shift), or --plan PLAN.json."
        )
    return 1.0


def _refuse_to_replace(path: Path | None) -> None:
    if path is not None and path.exists():
        raise UsageError(f"--fill {path}: the file exists already. Choose another name.")


def _fill(cell: Cell, path: Path, t: Words) -> None:
    """Writes the cell with scores beside facts; of doses that of one execution."""
    from tandem.cell.assessed import assessed
    from tandem.cell.model import Cell
    from tandem.files.load import dump

    data, number = cell.to_dict(), 0
    for one in assessed(cell):
        if one.given is not None:
            data["tasks"][one.task]["ergonomics"][one.place]["score"] = one.value
            number += 1
    dump(Cell.model_validate(data), path)
    click.echo(t("filled", n=number), err=True)
    click.echo(t("wrote", path=path), err=True)


def _angles(
    path: Path,
    facts: str | None,
    whole: Mapping[str, Any],
    outputs: Iterable[Path],
    as_json: bool,
    lang: str,
) -> None:
    """The postures of a recording. They are no tasks of a shift, so that nothing is summed up."""
    from tandem.assessment import pages
    from tandem.assessment import sentences as say
    from tandem.cell.stated import Conditions
    from tandem.ergonomics.tasks import scored
    from tandem.files.facts.angles import load_angles

    for output in outputs:
        pages.check(output)
    rest = {} if facts is None else _facts_of(facts)
    tasks = load_angles(path, whole["method"], rest, Conditions(**whole))
    rows = [scored(task) for task in tasks]
    _put(say.words(lang), pages.Assessment(path.stem, rows, [], _made()), outputs, as_json)


def _made() -> dict[str, str]:
    from tandem import __version__

    return {"version": __version__, "command": shlex.join(["tandem", *sys.argv[1:]])}


def _put(t: Words, found: Assessment, outputs: Iterable[Path], as_json: bool) -> None:
    from tandem.assessment import pages

    for output in outputs:
        pages.write(t, found, output)
    if as_json:
        click.echo(pages.json_text(t, found), nl=False)
    else:
        _show(t, found)
    for output in outputs:
        click.echo(t("wrote", path=output), err=True)


def _show(t: Words, found: Assessment) -> None:
    from tandem.assessment import sentences as say

    for row in found.rows:
        _show_task(t, row)
    if found.outside:
        click.echo(f"{t('head.outside')}:")
        for one in found.outside:
            who = ", ".join(one.operators)
            score = say.number(t, one.value)
            click.echo(f"  {one.task} ({who}): {say.method(t, one.method)} {score}")
        click.echo("")
    if found.shift is not None:
        click.echo(f"{t('head.people')}:\n  {say.shift(t, found.shift)}")
        for title, said in say.people(t, found.shift):
            click.echo("\n".join([f"  {title}", *(f"    {line}" for line in said)]))
        click.echo("")
    if found.totals:
        click.echo(f"{t('head.shift')}:")
        for total in found.totals:
            click.echo(f"  {say.total(t, total)}")
        click.echo("")
    click.echo(t.count("counted", len(found.rows)) + " " + t("advice"))


def _show_task(t: Words, row: Scored) -> None:
    from tandem.assessment import sentences as say

    side = t(f"side.{row.given.side}")
    click.echo(f"{row.given.task}{f' ({side})' if side else ''}")
    lines = (
        say.explanation(t, row.outcome),
        say.stability(t, row),
        say.unstated(t, row),
        say.provenance(t, row),
    )
    for line in lines:
        if line:
            click.echo(f"  {line}")
    click.echo("")


# --- to begin with --------------------------------------------------------------------------------


def _template(path: Path, lang: str) -> None:
    from tandem.assessment import sentences as say
    from tandem.files.facts.template import write

    if path.suffix.lower() != ".xlsx":
        raise UsageError(f"--template {path}: a template is an .xlsx workbook.")
    if path.exists():
        raise UsageError(f"{path} exists already. Choose another name.")
    write(path, "de" if lang == "de" else "en")
    click.echo(say.words(lang)("template.next", path=path), err=True)


def _list(as_json: bool) -> None:
    from tandem.ergonomics.facts import about, span
    from tandem.ergonomics.methods import METHODS

    if as_json:
        click.echo(
            json.dumps(
                {
                    name: {
                        "scale": method.scale,
                        "region": method.region,
                        "sided": method.sided,
                        "functions": list(method.functions),
                        "facts": {
                            key: {
                                "what": field.description,
                                "range": span(field),
                                "unit": about(field)["unit"],
                                "must_be_stated": about(field)["asked"],
                            }
                            for key, field in method.model.model_fields.items()
                        },
                    }
                    for name, method in METHODS.items()
                },
                ensure_ascii=False,
            )
        )
        return
    for name, method in METHODS.items():
        must = [key for key, field in method.model.model_fields.items() if about(field)["asked"]]
        click.echo(f"{name} ({method.scale}): {', '.join(must)}")
