"""`tandem separate`: how far people and robots must be apart, and what follows for a cell."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.options import AS_JSON, CELL, LANGUAGE
from tandem.errors import CellError, Fault, UsageError

if TYPE_CHECKING:
    from tandem.assessment.space import LayoutFacts
    from tandem.cell.model import Cell


@click.command("separate", epilog="Formula, source and limits: docs/ergonomics.md")
@CELL
@click.option(
    "--facts",
    "facts_file",
    metavar="FILE",
    required=True,
    type=click.Path(path_type=Path, dir_okay=False, allow_dash=True),
    help="What is known of the robots: speeds, times, ways; YAML or JSON.",
)
@click.option(
    "--slow",
    type=click.Choice(["zone", "times"]),
    default="zone",
    show_default=True,
    help="Where slowing down is enough: a zone all the same, or longer times of the robot.",
)
@click.option(
    "--most-factor",
    type=click.FloatRange(1.0),
    default=3.0,
    show_default=True,
    help="A robot that would have to be slower still is kept apart.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the cell with the zones, and longer times, that follow.",
)
@AS_JSON
@LANGUAGE
def separate_command(
    cell_file: str,
    facts_file: Path,
    slow: str,
    most_factor: float,
    output: Path | None,
    as_json: bool,
    lang: str,
) -> None:
    """Say which places of a cell people and robots may use at once: advice, no safety function.

    \b
    Examples:
      tandem separate cell.yaml --facts space.yaml
      tandem separate cell.yaml --facts space.yaml --slow times -o apart.yaml

    The protective separation distance of speed and separation monitoring (ISO/TS 15066) is held
    against the distances between the cell's places. What is too near gets a zone with `apart:
    [human, robot]`; where slowing down is enough, the factor is said. FILE holds v_r, T_r, T_s,
    S_s, C, Z_d, Z_r and reach (m, s, m/s) for all robots, or a table of them under `robots`.
    """
    from tandem.assessment import sentences as say
    from tandem.assessment.space import applied, document, judged, sentences
    from tandem.files.load import dump, load

    if output is not None and output.exists():
        raise UsageError(f"-o {output}: the file exists already. Choose another name.")
    cell, t = load(cell_file), say.words(lang)
    space = judged(cell, _facts(facts_file, cell), most_factor=most_factor)
    found = applied(space, slow="times" if slow == "times" else "zone")
    if output is not None:
        dump(found.cell, output)
    if as_json:
        click.echo(json.dumps(document(t, space, found, _made()), ensure_ascii=False))
    else:
        click.echo("\n".join(sentences(t, space, found)))
    if output is not None:
        click.echo(t("wrote", path=output), err=True)


def _facts(path: Path, cell: Cell) -> dict[str, LayoutFacts]:
    """Robot -> its facts, of every robot of the cell. Raises CellError with every fault."""
    from pydantic import ValidationError

    from tandem.assessment.space import LayoutFacts
    from tandem.cell.names import Known
    from tandem.ergonomics.facts import FactsError, refusals
    from tandem.files.facts.document import tree
    from tandem.files.load import text_of

    source = "standard input" if str(path) == "-" else str(path)
    document = tree(text_of(path, source), source)
    plain, faults = document.plain(), list(document.faults)
    robots = [name for name, operator in cell.operators.items() if operator.kind == "robot"]
    if not robots:
        raise UsageError("the cell has no robot: there is nothing to keep apart.")
    if not isinstance(plain, dict):
        raise FactsError([Fault("facts are a mapping, such as {v_r: 1.0, ...}.", place=source)])
    told: Any = plain.get("robots", plain)
    by_robot = told if "robots" in plain and isinstance(told, dict) else dict.fromkeys(robots, told)
    at: tuple[str, ...] = ("robots",) if "robots" in plain else ()
    for name in by_robot:
        if name not in robots:
            hint = Known(robots).hint(str(name))
            place = document.place((*at, name)).text
            faults.append(Fault(f"{name!r} is no robot of the cell. {hint}", place=place))
    found = {}
    for robot in robots:
        own = (*at, robot) if at else ()
        try:
            found[robot] = LayoutFacts.model_validate(by_robot.get(robot, {}))
        except ValidationError as error:
            for fault in refusals(error, LayoutFacts, "separation", own):
                faults.append(fault.at(document.place(fault.path).text))
    if faults:
        raise CellError(dict.fromkeys(faults))
    return found


def _made() -> dict[str, str]:
    from tandem import __version__

    return {"version": __version__, "command": shlex.join(["tandem", *sys.argv[1:]])}
