"""What `tandem plan` does with --cycle, --takt, --max-in-process and --batch: the station that
makes one product after the other.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from tandem.cell.names import clean
from tandem.cli.outputs import kept_when_interrupted, show, tell_written, write_outputs
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.cycle.mix import Alone
    from tandem.plan.cycle.result import CycleFront
    from tandem.plan.result import Front

F = TypeVar("F", bound=Callable[..., Any])

NOT_OF_A_CYCLE = {
    "weights": "--weights",
    "max_makespan": "--max-makespan",
    "cv": "--cv",
    "robust": "--robust",
    "risk": "--risk",
    "plan_file": "--from",
    "explain_bound": "--explain-bound",
}
"""Options that ask about one product alone: the name of the argument, and what is typed."""


SHARES = "shares"
"""Instead of counts: as the cell's own shares say."""


class Mix(click.ParamType):  # type: ignore[type-arg]  # older releases of click take no parameter
    """Names and counts, `short=2,long=1`; or `shares`."""

    name = "NAME=N,..."

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> dict[str, int] | str:
        if isinstance(value, dict):
            return value
        if value == SHARES:
            return SHARES
        mix: dict[str, int] = {}
        for part in str(value).split(","):
            name, equals, count = part.rpartition("=")
            if not (
                equals and name.strip() and count.strip().isascii() and count.strip().isdigit()
            ):
                self.fail(
                    f"{part!r} is no name and count, such as short=2,long=1; nor {SHARES}.",
                    param,
                    ctx,
                )
            if clean(name) in mix:
                self.fail(f"{clean(name)!r} stands there twice.", param, ctx)
            mix[clean(name)] = int(count)
        return mix


def cycle_options(command: F) -> F:
    """--cycle, --takt, --max-in-process, --mix, --one-allocation, --batch and --variant, in this
    order in the help.
    """
    for option in (
        click.option(
            "--variant",
            "product",
            metavar="NAME",
            help="Plan this variant of the cell instead of the cell itself.",
        ),
        click.option(
            "--batch",
            type=click.IntRange(1),
            metavar="N",
            help=(
                "The least time for N products, from an empty station to an empty one, each"
                " assembled in its own way where that helps."
            ),
        ),
        click.option(
            "--one-allocation",
            is_flag=True,
            help="With --mix: a task is done by the same operators in every product that has it.",
        ),
        click.option(
            "--mix",
            type=Mix(),
            help=(
                "With --cycle: what each cycle makes, as variants and how many of each (`base` is"
                " the cell itself), in whatever order is best; `shares` for the smallest mix that"
                " has the variants' shares."
            ),
        ),
        click.option(
            "--max-in-process",
            type=click.IntRange(1),
            metavar="N",
            help=(
                "With --cycle or --takt: at most so many products in the station at once; as many"
                " as help when absent."
            ),
        ),
        click.option(
            "--takt",
            type=float,
            metavar="S",
            help=(
                "A product every S seconds: the least stress that keeps it, then the fewest"
                " products in process, then the least cycle time."
            ),
        ),
        click.option(
            "--cycle",
            is_flag=True,
            help=(
                "The station makes one product after the other: every compromise of cycle time and"
                " stress, instead of makespan and stress."
            ),
        ),
    ):
        command = option(command)
    return command


@dataclass(frozen=True)
class Repeated:
    """What was asked about a station that repeats."""

    cycle: bool
    takt: float | None
    max_in_process: int | None
    batch: int | None
    mix: dict[str, int] | str | None = None
    one_allocation: bool = False

    @property
    def of_cycle(self) -> bool:
        """The steady state is asked for."""
        return self.cycle or self.takt is not None

    def __bool__(self) -> bool:
        others = (self.max_in_process, self.batch, self.mix)
        return self.of_cycle or self.one_allocation or any(one is not None for one in others)

    def check(self, minimize: str | None, given: Callable[[str], bool]) -> None:
        """Raises UsageError when other options do not go with these.

        Args:
          given: whether an option was typed.
        """
        asked = "--cycle" if self.of_cycle else "--batch"
        if self.max_in_process is not None and not self.of_cycle:
            raise UsageError("--max-in-process goes with --cycle or --takt: give one of them.")
        if wrong := [typed for name, typed in NOT_OF_A_CYCLE.items() if given(name)]:
            names = " and ".join(wrong)
            raise UsageError(f"{names}: asks about one product alone, and not with {asked}.")
        if self.of_cycle and minimize in ("makespan", "worst-stress"):
            raise UsageError(f"--minimize {minimize}: with --cycle choose cycle_time or stress.")
        if (self.mix is not None or self.one_allocation) and not self.cycle:
            raise UsageError("--mix and --one-allocation go with --cycle.")
        if self.one_allocation and self.mix is None:
            raise UsageError("--one-allocation goes with --mix: it is one allocation for several.")
        if self.mix is not None and (
            self.takt is not None or self.batch is not None or self.max_in_process is not None
        ):
            raise UsageError("--mix does not go with --takt, --batch or --max-in-process.")
        if self.takt is not None and minimize is not None:
            raise UsageError("--minimize and --takt exclude each other: give one of them.")
        if not self.of_cycle and minimize not in (None, "makespan"):
            raise UsageError(f"--minimize {minimize}: the least time is what --batch asks for.")


@dataclass(frozen=True)
class Outputs:
    """Where the answer goes.

    Attributes:
      files: to be written.
      source: the cell file as it was named; None where there is none, or a variant was planned.
      stem: what an interrupted plan is called.
    """

    files: tuple[Path, ...]
    source: str | None
    stem: str
    as_json: bool
    point: int | None
    lang: str
    quiet: bool


def answer(
    cell: Cell, asked: Repeated, minimize: str | None, outputs: Outputs, **effort: Any
) -> int:
    """Plans the cell as a station that repeats, shows and writes what was found; the exit code.

    Args:
      effort: `method`, `max_stress`, `time_limit`, `work`, `seed`, `workers`.
    """
    if not asked.of_cycle:
        return _batch_alone(cell, asked, outputs, effort)
    from tandem.plan.cycle.methods import plan_cycle
    from tandem.plan.cycle.mix import each_alone, plan_mix
    from tandem.report.cycle.files import ready_to_write
    from tandem.report.language import words

    ready_to_write(outputs.files)
    _tell_left_out(cell)
    with _counting(outputs) as on_point:
        asked_of: dict[str, Any] = {
            "minimize": minimize or "front",
            "on_point": on_point,
            **effort,
        }
        mix = _mix(cell, asked)
        front = (
            plan_mix(cell, mix, one_allocation=asked.one_allocation, **asked_of)
            if mix
            else plan_cycle(cell, takt=asked.takt, max_in_process=asked.max_in_process, **asked_of)
        )
    # the cell of a mix stands in no file
    front = replace(front, source=None if mix else outputs.source)
    if outputs.point is not None and not 1 <= outputs.point <= len(front):
        points = ", ".join(f"({time:g} s, {load:g})" for time, load in front.points)
        raise UsageError(f"--point {outputs.point}: the front has {len(front)}: {points}.")
    batch, alone = None, None
    if asked.batch is not None and not front.interrupted:
        batch = _batch(cell, asked.batch, effort)
    if mix and not front.interrupted:
        alone = each_alone(cell, mix, **effort)
    _show(front, batch, alone, asked, outputs)
    if front.interrupted:
        click.echo(words(outputs.lang)("terminal.stopped"), err=True)
    return 130 if front.interrupted else 0


def _mix(cell: Cell, asked: Repeated) -> dict[str, int]:
    """What each cycle makes; empty where it is one product."""
    from tandem.plan.cycle.mix import shares

    if asked.mix == SHARES and not cell.variants:
        raise UsageError("--mix shares: the cell has no variants.")
    if asked.mix == SHARES:
        return shares(cell)
    return asked.mix if isinstance(asked.mix, dict) else {}


def _show(
    front: CycleFront,
    batch: Front | None,
    alone: Alone | None,
    asked: Repeated,
    outputs: Outputs,
) -> None:
    """Writes the files, and the document or the view on stdout."""
    from tandem.plan.cycle.batch import told

    files = [*outputs.files]
    files += kept_when_interrupted(front, files, f"{outputs.stem}.yaml")
    write_outputs(front, files, outputs.lang, point=outputs.point)
    if outputs.as_json:
        document = front.to_dict()
        if batch is not None and asked.batch is not None:
            assignments = batch[0].schedule.to_list()
            document["batch"] = {**told(batch, asked.batch), "assignments": assignments}
        if alone is not None:
            document["alone"] = alone.to_dict()
        click.echo(json.dumps(document, ensure_ascii=False))
    else:
        show(front, False, outputs.lang, point=outputs.point)
        if batch is not None and asked.batch is not None:
            _tell_batch(batch, asked.batch)
        if alone is not None:
            _tell_mix(front, alone)
    tell_written(files, outputs.lang)


def _tell_mix(front: CycleFront, alone: Alone) -> None:
    """What a cycle makes, and what each product would take alone."""
    from tandem.cell.written import number

    made = ", ".join(f"{count} {name}" for name, count in front.mix)
    least = round(front[0].cycle_time / front.products, 4)
    own = ", ".join(f"{name} {number(time)} s" for name, time in alone.seconds.items())
    click.echo(f"Each cycle makes {made}: {number(least)} s a product at the quickest point.")
    click.echo(
        f"Each made alone: {own}; mean {number(round(alone.mean, 4))} s, worst"
        f" {number(alone.worst)} s."
    )


def _batch_alone(cell: Cell, asked: Repeated, outputs: Outputs, effort: dict[str, Any]) -> int:
    """The batch as an ordinary plan of the cell that makes all products: it can be drawn, printed
    and checked like one.
    """
    from tandem.plan.cycle.batch import told
    from tandem.report.files import ready_to_write
    from tandem.report.language import words

    assert asked.batch is not None
    ready_to_write(outputs.files)
    front = _batch(cell, asked.batch, effort)
    files = [*outputs.files]
    files += kept_when_interrupted(front, files, f"{outputs.stem}.yaml")
    write_outputs(front, files, outputs.lang, point=None)
    if outputs.as_json:
        document = {**front.to_dict(), "batch": told(front, asked.batch)}
        click.echo(json.dumps(document, ensure_ascii=False))
    else:
        show(front, False, outputs.lang)
        _tell_batch(front, asked.batch)
    tell_written(files, outputs.lang)
    if front.interrupted:
        click.echo(words(outputs.lang)("terminal.stopped"), err=True)
    return 130 if front.interrupted else 0


def _batch(cell: Cell, products: int, effort: dict[str, Any]) -> Front:
    """The batch, planned. Raises UsageError for what no batch is asked about."""
    from tandem.plan.cycle.batch import plan_batch

    if effort["method"] != "exact":
        raise UsageError(f"--method {effort['method']}: batches are planned by exact.")
    if effort["max_stress"] is not None:
        raise UsageError("--max-stress: is no limit on a batch; the least time is asked for.")
    limits = {name: effort[name] for name in ("time_limit", "work", "seed", "workers")}
    return plan_batch(cell, products, **limits)


def _tell_batch(front: Front, products: int) -> None:
    from tandem.cell.written import number
    from tandem.plan.cycle.batch import told

    batch = told(front, products)
    proof = "proven" if batch["status"] == "optimal" else f"at least {number(batch['bound'])} s"
    each = number(batch["per_product"])
    click.echo(f"{products} products: {number(batch['makespan'])} s ({proof}), {each} s each.")


def _tell_left_out(cell: Cell) -> None:
    """Says on stderr what plays no part in a steady state."""
    resting = [name for name, operator in cell.operators.items() if operator.breaks]
    if resting:
        click.echo(
            f"The cycle time holds between breaks: those of {', '.join(resting)} play no part.",
            err=True,
        )


@contextmanager
def _counting(outputs: Outputs) -> Iterator[Callable[[int], None] | None]:
    """Counts the points on stderr while they are found, where somebody looks."""
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    if outputs.quiet or not console.is_terminal or console.is_dumb_terminal:
        yield None
        return
    with console.status("searching ...") as status:
        yield lambda points: status.update(f"{points} point{'s' * (points != 1)} ...")
