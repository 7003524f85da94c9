"""What `tandem plan` does with --cycle, --takt, --max-in-process and --batch: the station that
makes one product after the other.
"""

from __future__ import annotations

import datetime
import json
import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from tandem.cli.outputs import kept_when_interrupted, show, tell_written, write_outputs
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.cycle.result import CycleFront
    from tandem.plan.result import Front

F = TypeVar("F", bound=Callable[..., Any])

NOT_OF_A_CYCLE = ("weights", "max_makespan", "cv", "robust", "risk", "hint")
"""Options that ask about one product alone."""


def cycle_options(command: F) -> F:
    """--cycle, --takt, --max-in-process and --batch, in this order in the help."""
    for option in (
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

    @property
    def of_cycle(self) -> bool:
        """The steady state is asked for."""
        return self.cycle or self.takt is not None

    def __bool__(self) -> bool:
        return self.of_cycle or self.max_in_process is not None or self.batch is not None

    def check(self, minimize: str | None, given: Callable[[str], bool]) -> None:
        """Raises UsageError when other options do not go with these.

        Args:
          given: whether an option was typed.
        """
        asked = "--cycle" if self.of_cycle else "--batch"
        if self.max_in_process is not None and not self.of_cycle:
            raise UsageError("--max-in-process goes with --cycle or --takt: give one of them.")
        if wrong := [name for name in NOT_OF_A_CYCLE if given(name)]:
            names = " and ".join(f"--{name.replace('_', '-')}" for name in wrong)
            raise UsageError(f"{names}: asks about one product alone, and not with {asked}.")
        if self.of_cycle and minimize == "makespan":
            raise UsageError("--minimize makespan: with --cycle choose cycle_time or stress.")
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
    from tandem.report.cycle.files import ready_to_write
    from tandem.report.language import words

    ready_to_write(outputs.files)
    _tell_left_out(cell)
    with _counting(outputs) as on_point:
        front = plan_cycle(
            cell,
            minimize=minimize or "front",  # type: ignore[arg-type]
            takt=asked.takt,
            max_in_process=asked.max_in_process,
            on_point=on_point,
            **effort,
        )
    front = replace(front, source=outputs.source)
    if outputs.point is not None and not 1 <= outputs.point <= len(front):
        points = ", ".join(f"({time:g} s, {load:g})" for time, load in front.points)
        raise UsageError(f"--point {outputs.point}: the front has {len(front)}: {points}.")
    batch = None
    if asked.batch is not None and not front.interrupted:
        batch = _batch(cell, asked.batch, effort)
    _show(front, batch, asked, outputs)
    if front.interrupted:
        click.echo(words(outputs.lang)("terminal.stopped"), err=True)
    return 130 if front.interrupted else 0


def _show(front: CycleFront, batch: Front | None, asked: Repeated, outputs: Outputs) -> None:
    """Writes the files, and the document or the view on stdout."""
    from rich.console import Console

    from tandem.plan.cycle.batch import told
    from tandem.report.cycle.files import write
    from tandem.report.cycle.terminal import CycleView

    files = list(outputs.files)
    if front.interrupted and not any(path.suffix == ".json" for path in files):
        files.append(Path(f"{outputs.stem}.interrupted.json"))
    for path in files:
        write(
            front,
            path,
            command=shlex.join(["tandem", *sys.argv[1:]]),
            date=datetime.date.today().isoformat(),
            language=outputs.lang,
            point=outputs.point,
        )
    if outputs.as_json:
        document = front.to_dict()
        if batch is not None and asked.batch is not None:
            assignments = batch[0].schedule.to_list()
            document["batch"] = {**told(batch, asked.batch), "assignments": assignments}
        click.echo(json.dumps(document, ensure_ascii=False))
    else:
        console = Console(file=sys.stdout, highlight=False)
        console.print(CycleView(front, language=outputs.lang, point=outputs.point))
        if batch is not None and asked.batch is not None:
            _tell_batch(batch, asked.batch)
    tell_written(files, outputs.lang)


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
