"""Options that several commands take."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from tandem.cell.language import LANGUAGES
from tandem.errors import UsageError
from tandem.files.formats.table import FORMATS

F = TypeVar("F", bound=Callable[..., Any])

CELL = click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
AS_JSON = click.option(
    "--json", "as_json", is_flag=True, help="Print one document on stdout and nothing else there."
)

FRONT_LIMIT = click.option(
    "--front-limit",
    type=float,
    default=30.0,
    show_default=True,
    help="Seconds for the exact front that everything is held against.",
)
FORMAT = click.option(
    "--format",
    "form",
    metavar="NAME",
    help=f"What CELL is written in; told from its content when absent: {', '.join(FORMATS)}.",
)


KNEE = "knee"
"""Instead of weights: those of the recommended point."""


class Weights(click.ParamType):  # type: ignore[type-arg]  # older releases of click take no parameter
    """Two numbers joined by a comma; with `knee`, that word too."""

    name = "TIME,STRESS"

    def __init__(self, *, knee: bool = False) -> None:
        self.knee = knee

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float] | str:
        if isinstance(value, tuple):
            return value
        if self.knee and value == KNEE:
            return KNEE
        try:
            time, stress = (float(part) for part in str(value).split(","))
        except ValueError:
            word = f", nor {KNEE}" * self.knee
            self.fail(
                f"{value!r} is not two numbers joined by a comma, such as 1,0.5{word}.", param, ctx
            )
        return time, stress


class Prior(click.ParamType):  # type: ignore[type-arg]  # older releases of click take no parameter
    """Pace factors, each with a weight: 0.6:1,1:3,2:1."""

    name = "FACTOR:WEIGHT,..."

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> dict[float, float]:
        if isinstance(value, dict):
            return value
        try:
            pairs = [part.split(":") for part in str(value).split(",")]
            return {float(factor): float(weight) for factor, weight in pairs}
        except ValueError:
            self.fail(
                f"{value!r} is no list of factors and weights, such as 0.6:1,1:3,2:1.", param, ctx
            )


LANGUAGE = click.option(
    "--lang",
    type=click.Choice(LANGUAGES),
    default=LANGUAGES[0],
    show_default=True,
    help="Language of what is shown and written.",
)
OUTPUTS = click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help=(
        "Write .json, .csv, .svg, .png, .pdf, .html, .xlsx, .xml (MS Project) or .md; may be"
        " repeated."
    ),
)

_OF_DECIDERS = (
    click.option(
        "--weights",
        type=Weights(knee=True),
        help=(
            "Keep TIME * makespan + STRESS * stress small, or `knee`: as the recommended point of"
            " the front does, or the point of --plan."
        ),
    ),
    click.option(
        "--max-stress",
        type=float,
        help="Stay within this stress of all humans, as far as possible.",
    ),
    click.option(
        "--budget",
        type=click.FloatRange(1.0),
        default=50.0,
        show_default=True,
        help="Milliseconds for each decision.",
    ),
    click.option(
        "--prior",
        type=Prior(),
        help=(
            "What is believed of a human's pace before anything was seen: factors with weights,"
            " 0.6:1,1:3,2:1."
        ),
    ),
    click.option(
        "--frozen",
        type=click.FloatRange(0.0),
        default=0.0,
        show_default=True,
        help="Seconds: what was announced so shortly before is not changed.",
    ),
    click.option(
        "--change-penalty",
        type=click.FloatRange(0.0),
        show_default="2 % of the plan's makespan with --plan, else 0",
        help="Seconds to gain before an announced task is changed, or the plan is left.",
    ),
    click.option(
        "--taking-apart",
        type=click.FloatRange(0.0, 100.0, min_open=True),
        default=1.0,
        show_default=True,
        help="Share of a task's time that taking it apart takes.",
    ),
    click.option(
        "--plan",
        type=click.Path(exists=True, dir_okay=False, path_type=Path),
        help=(
            "A plan of CELL as `tandem plan CELL --json` prints it: `fixed` carries it out, `auto`"
            " and `replan-robust` follow it while it is good."
        ),
    ),
    click.option(
        "--learned",
        help=(
            "A trained policy, for `learned` and `auto`: a file, or the folder of a run (its best"
            " seed). Without one, `learned` takes the network for all cells."
        ),
    ),
)


WORK = click.option(
    "--work",
    type=float,
    help=(
        "A limit on the work of the search instead of its time, in CP-SAT's deterministic seconds"
        " (on one core each takes a few seconds). No clock is asked, so the run repeats exactly"
        " for a seed, proven or not."
    ),
)


def is_given(option: str) -> bool:
    """Whether the option was typed, and is not there by its default alone."""
    source = click.get_current_context().get_parameter_source(option)
    return source == click.core.ParameterSource.COMMANDLINE


def check_work(work: float | None) -> None:
    """Raises UsageError where work and time are both limited."""
    if work is not None and is_given("time_limit"):
        raise UsageError("--work and --time-limit exclude each other: give one of them.")


def check_time(time_limit: float, workers: int | None) -> None:
    """Raises UsageError for a time limit or a number of workers that makes no sense."""
    if not time_limit > 0:
        raise UsageError(f"--time-limit {time_limit}: must be more than 0 seconds.")
    if workers is not None and workers < 1:
        raise UsageError(f"--workers {workers}: must be 1 or more.")


_OF_A_POINT = (
    click.option(
        "--point",
        type=int,
        help="A point of the front, counted from 1; the recommended compromise when absent.",
    ),
    click.option(
        "--makespan", type=float, help="Instead: the point of least stress within so many seconds."
    ),
    click.option(
        "--stress", type=float, help="Instead: the quickest point of at most this stress."
    ),
)


def point_options(command: F) -> F:
    """The options by which one point of a front is chosen; `report.stored.point_of` reads them."""
    for option in reversed(_OF_A_POINT):
        command = option(command)
    return command


def decider_options(command: F) -> F:
    """The options of whoever decides: what for, by which plan, in which time, believing what."""
    for option in reversed((*_OF_DECIDERS, *_OF_A_POINT)):
        command = option(command)
    return command
