"""Options that several commands take."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from tandem.files.formats.table import FORMATS

F = TypeVar("F", bound=Callable[..., Any])

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
        default=0.0,
        show_default=True,
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
            " seed)."
        ),
    ),
)


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
