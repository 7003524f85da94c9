"""`tandem dispatch`: a shift, live: events in, decisions out, a journal between them."""

from __future__ import annotations

import json
import signal
import sys
import time
from codecs import BOM_UTF8
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import click

from tandem.cell.names import clean
from tandem.cli.options import FORMAT, KNEE, decider_options
from tandem.cli.seeds import say_which_seed
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.dispatch.journal import Journal
    from tandem.dispatch.shift.live import Settings, Shift
    from tandem.dispatch.shift.simulated import SimulatedFloor

Show = Callable[["Shift", dict[str, Any]], None]


class Moment(click.ParamType):  # type: ignore[type-arg]  # older releases of click take no parameter
    """A time on the wall clock with its zone."""

    name = "ISO-8601"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> datetime:
        try:
            moment = value if isinstance(value, datetime) else datetime.fromisoformat(str(value))
        except ValueError:
            self.fail(f"{value!r} is no time, such as 2026-03-02T06:00:00+01:00.", param, ctx)
        if moment.tzinfo is None:
            self.fail(f"{value!r} has no time zone. Add one, such as +01:00 or Z.", param, ctx)
        return moment


@click.command("dispatch")
@click.argument("cell_file", metavar="CELL", type=click.Path())
@FORMAT
@click.option(
    "--policy",
    default="auto",
    show_default=True,
    help="Who decides; `tandem policies` lists them, one of your own is package.module:maker.",
)
@click.option(
    "--journal",
    type=click.Path(dir_okay=False, path_type=Path),
    help="File that keeps the shift. Begin again with it to go on where it ended.",
)
@click.option(
    "--replay",
    "replays",
    is_flag=True,
    help="Take the journal's events anew, and say whether the decisions are the same.",
)
@click.option(
    "--events",
    type=click.Path(exists=True, dir_okay=False, allow_dash=True),
    default="-",
    help="File of events, a line each; standard input when absent.",
)
@click.option(
    "--products",
    type=int,
    default=1,
    show_default=True,
    help="So many of CELL are ordered at the start; 0 waits for the event `product`.",
)
@click.option(
    "--variant",
    "variants",
    multiple=True,
    metavar="NAME=FILE",
    help="A cell that the event `product` may name, for products that differ. May be repeated.",
)
@click.option(
    "--seed",
    type=int,
    default=0,
    show_default=True,
    help="Seed of the decider, and of the simulated floor.",
)
@decider_options
@click.option(
    "--start",
    type=Moment(),
    help="When the shift begins, for events that tell the time; the first such event when absent.",
)
@click.option(
    "--simulate",
    "people",
    metavar="PEOPLE",
    help="No floor but a simulated one: compliant, random:0.5, pace:2+forgetful:0.1, ...",
)
@click.option(
    "--cv",
    type=click.FloatRange(0.0),
    default=0.0,
    show_default=True,
    help="Simulated: how far times scatter where the cell does not say (lognormal).",
)
@click.option(
    "--failures",
    type=click.FloatRange(0.0, min_open=True),
    help="Simulated: mean seconds until a robot or machine breaks down; never when absent.",
)
@click.option(
    "--absences",
    type=click.FloatRange(0.0, min_open=True),
    help="Simulated: mean seconds until a human is called away; never when absent.",
)
@click.option(
    "--speed",
    type=click.FloatRange(0.0, min_open=True),
    help="Simulated: so many times as fast as real time; as fast as possible when absent.",
)
@click.option(
    "--json/--words",
    "as_json",
    default=None,
    help="JSON lines, or words for people; words on a terminal, JSON lines elsewhere when absent.",
)
@click.pass_context
def dispatch_command(ctx: click.Context, /, **given: Any) -> int:
    """Run a shift on CELL, product after product: events in, decisions out, a line of JSON each.

    \b
    Examples:
      tandem dispatch cell.yaml --journal shift.db
      tandem dispatch cell.yaml --products 0 --variant long=long.yaml --journal shift.db
      tandem dispatch cell.yaml --simulate pace:1.5 --cv 0.2 --products 50
      tandem dispatch cell.yaml --plan plan.json --point 2 --change-penalty 3
      tandem dispatch cell.yaml --journal shift.db --replay

    An event is {"event": "done", "at": 12.5, "task": "4"}; the manual has them all. Advice, not a
    safety function.
    """
    from tandem.dispatch.journal import IN_MEMORY, Journal
    from tandem.files.load import load

    if given["cell_file"] == "-":
        raise UsageError(
            "CELL cannot come from standard input, where the events come from. Name a file."
        )
    cell = load(given["cell_file"], given["form"])
    path: Path | None = given["journal"]
    if given["replays"]:
        if path is None:
            raise UsageError("--replay: name the journal with --journal FILE.")
        with Journal(path, read_only=True) as journal:
            return _replay(cell, journal, given["policy"], bool(given["as_json"]))
    show = (
        _json_line
        if given["as_json"] or (given["as_json"] is None and not _is_terminal())
        else _screen()
    )
    with Journal(IN_MEMORY if path is None else path) as journal, _terminated_cleanly() as stopped:
        try:
            return _run(ctx, cell, journal, given, show)
        except KeyboardInterrupt:
            go_on = (
                f"Go on with: tandem dispatch {given['cell_file']} --journal {path}"
                if path
                else "Nothing was kept; --journal FILE would."
            )
            click.echo(f"{'terminated' if stopped else 'interrupted'}. {go_on}", err=True)
            return 0 if stopped else 130


def _run(
    ctx: click.Context, cell: Cell, journal: Journal, given: dict[str, Any], show: Show
) -> int:
    from tandem.dispatch.deciders.memory import settled_memory
    from tandem.dispatch.shift.documents import is_over, summary
    from tandem.dispatch.shift.live import Shift

    # a decider that is late and still computes leaves the processor to the rule sooner
    sys.setswitchinterval(0.001)
    kept = _kept(ctx, journal, cell, given)
    variants = _variants(given["variants"])
    say_which_seed(given["learned"])
    settings = _settings(cell, given) if kept is None else kept
    shift = Shift.open(cell, journal, settings, given["start"], variants=variants)
    floor = None if given["people"] is None else _floor(shift, given)
    if shift.basis is not None and shift.basis.doubt:
        click.echo(f"{shift.settings.policy}: {shift.basis.doubt}", err=True)
    with settled_memory() as settle:
        _live(shift, floor, given, show, settle)
    show(shift, summary(shift.situation, journal.entries()))
    if not is_over(shift.situation) and given["journal"] and given["people"] is None:
        click.echo(
            "the events have ended, the shift has not. Go on with: tandem dispatch"
            f" {given['cell_file']} --journal {given['journal']}",
            err=True,
        )
    return 0


def _live(
    shift: Shift,
    floor: SimulatedFloor | None,
    given: dict[str, Any],
    show: Show,
    between: Callable[[], None],
) -> None:
    """Says where the shift stands, and takes line by line until no more come. `between`: called
    after each answer, when nobody waits.
    """
    show(shift, shift.hello())
    show(shift, shift.decision)
    if floor is None:
        with _events(given["events"]) as file:
            for came in _lines(file):
                for document in shift.take(came):
                    show(shift, document)
                between()
    else:
        floor.catch_up(
            shift.settings.beginning(shift.cell, shift.variants), shift.journal.entries()
        )
        for line in _simulated(floor, shift, given["speed"]):
            for document in shift.take(line):
                show(shift, document)
            between()


def _settings(cell: Cell, given: dict[str, Any]) -> Settings:
    """Of a new shift."""
    from tandem.cli.following import change_penalty, steered
    from tandem.dispatch.deciders.policy import Options
    from tandem.dispatch.lookahead.branch_and_bound import measured
    from tandem.dispatch.shift.live import Settings

    objective, plan = steered(cell, given, [given["policy"]], KNEE)
    options = Options(
        budget_ms=given["budget"],
        steps_per_ms=measured(),
        seed=given["seed"],
        frozen_s=given["frozen"],
        change_penalty=change_penalty(given, plan),
        learned=given["learned"],
        plan=plan,
        **({} if given["prior"] is None else {"prior": given["prior"]}),
    )
    return Settings(given["policy"], objective, options, given["taking_apart"], given["products"])


def _variants(given: tuple[str, ...]) -> dict[str, Cell]:
    """The cells that --variant names."""
    from tandem.files.load import load

    found: dict[str, Cell] = {}
    for text in given:
        name, equals, file = text.partition("=")
        if not (name.strip() and equals and file):
            raise UsageError(f"--variant {text}: write NAME=FILE, such as long=long.yaml.")
        if clean(name) in found:
            raise UsageError(f"--variant {text}: the name {clean(name)!r} was given twice.")
        found[clean(name)] = load(file)
    return found


def _kept(
    ctx: click.Context, journal: Journal, cell: Cell, given: dict[str, Any]
) -> Settings | None:
    """The settings in the journal, None in a new one. What is stated must be what the shift was
    begun with.
    """
    from tandem.dispatch.shift.live import kept_settings, named_again

    if journal.is_new:
        return None
    kept = kept_settings(journal)
    named_again(journal, kept, given["policy"])
    there = {
        "policy": kept.policy,
        "budget": kept.options.budget_ms,
        "seed": kept.options.seed,
        "weights": (kept.objective.time, kept.objective.stress),
        "max_stress": kept.objective.max_stress,
        "frozen": kept.options.frozen_s,
        "change_penalty": kept.options.change_penalty,
        "learned": kept.options.learned,
        "prior": dict(kept.options.prior),
        "taking_apart": kept.taking_apart,
        "products": kept.products,
    }
    stated = [
        key
        for key in there
        if ctx.get_parameter_source(key) is click.core.ParameterSource.COMMANDLINE
        and given[key] != KNEE
    ]
    wrong = [
        f"--{key.replace('_', '-')} is {_stated(given[key])}, the shift was begun with"
        f" {_stated(there[key])}."
        for key in stated
        if given[key] != there[key]
    ]
    wrong += _other_plan(kept, cell, given)
    if wrong:
        raise UsageError(
            "\n".join(
                [*wrong, f"{journal.path}: go on without these options, or name another journal."]
            )
        )
    # the simulated floor reads these too
    given |= there
    return kept


def _other_plan(kept: Settings, cell: Cell, given: dict[str, Any]) -> Iterator[str]:
    """What there is to say when another plan is named than the shift was begun with."""
    from tandem.cli.following import stored

    if given["plan"] is None:
        return
    front, point = stored(given["plan"], cell, given)
    digest, began = front[point].schedule.digest, kept.options.plan
    if began is None or began.schedule.digest != digest:
        yield (
            f"--plan is the plan {digest}, the shift was begun with"
            f" {'none' if began is None else f'the plan {began.schedule.digest}'}."
        )


def _stated(value: Any) -> str:
    """The value of an option as it is written on the command line."""
    from tandem.dispatch.deciders.policy import prior_words

    match value:
        case None:
            return "not stated"
        case dict():
            return prior_words(value)
        case tuple():
            return ",".join(f"{part:g}" for part in value)
        case float():
            return f"{value:g}"
    return str(value)


def _floor(shift: Shift, given: dict[str, Any]) -> SimulatedFloor:
    from tandem.dispatch.shift.simulated import SimulatedFloor
    from tandem.world.randomness import Chance

    chance = Chance(
        spread=(
            "lognormal"
            if given["cv"]
            or any(
                _states_spread(task.spread)
                for cell in (shift.cell, *shift.variants.values())
                for task in cell.tasks.values()
            )
            else "off"
        ),
        cv=given["cv"],
        failure_s=given["failures"],
        absence_s=given["absences"],
        undo=given["taking_apart"],
    )
    return SimulatedFloor(shift.cell, given["people"], chance, given["seed"], shift.variants)


def _states_spread(spread: Any) -> bool:
    return any(spread.values()) if isinstance(spread, dict) else bool(spread)


def _simulated(floor: SimulatedFloor, shift: Shift, speed: float | None) -> Iterator[str]:
    """What happens on the floor, a line each; in time with the wall clock when there is a speed."""
    while (event := floor.next(shift.situation, shift.decision["look_again"])) is not None:
        if speed is not None:
            time.sleep(max(0.0, event.at - shift.situation.clock) / speed)
        yield json.dumps(event.to_dict(), ensure_ascii=False)


@contextmanager
def _events(name: str) -> Iterator[IO[bytes]]:
    if name != "-":
        with open(name, "rb") as file:
            yield file
        return
    if sys.stdin.isatty():
        click.echo(
            'events from the keyboard, a line each, such as {"event": "started", "at": 0, "task":'
            ' "1", "operator": "robot"}; Ctrl-D ends.',
            err=True,
        )
    yield sys.stdin.buffer


def _lines(file: IO[bytes]) -> Iterator[bytes]:
    """Lines that are not blank, as they came. Of a line that is longer than any event only the
    beginning is kept.
    """
    from tandem.dispatch.situation.events import MOST_BYTES

    most = MOST_BYTES + 8
    while line := file.readline(most):
        rest = line
        while len(rest) == most and not rest.endswith(b"\n"):
            rest = file.readline(most)
        if line.removeprefix(BOM_UTF8).strip():
            yield line.strip()


@contextmanager
def _terminated_cleanly() -> Iterator[list[int]]:
    """Within it SIGTERM ends the shift as Ctrl-C does; what is yielded tells afterwards whether
    that was so.
    """
    stopped: list[int] = []

    def stop(number: int, _: object) -> None:
        stopped.append(number)
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield stopped
    finally:
        signal.signal(signal.SIGTERM, before)


def _replay(cell: Cell, journal: Journal, policy: str, as_json: bool) -> int:
    from tandem.dispatch.shift.replay import replay

    found = replay(cell, journal, policy=policy)
    if as_json:
        click.echo(json.dumps({"type": "replay", **vars(found)}, ensure_ascii=False))
    else:
        click.echo(
            f"{found.entries} entries, {found.events} events taken, {found.decisions} decisions:"
            f" {'DIFFERENT' if found.differences else 'the same'}."
        )
        for difference in found.differences:
            click.echo(f"- {difference}")
    return 1 if found.differences else 0


def _screen() -> Show:
    from tandem.cli.screen import Screen

    return Screen()


def _is_terminal() -> bool:
    return sys.stdout.isatty()


def _json_line(_: Shift, document: dict[str, Any]) -> None:
    click.echo(json.dumps(document, ensure_ascii=False))
    sys.stdout.flush()
