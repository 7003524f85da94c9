"""The command tree, and what happens when a command ends other than well."""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Any

import click

import tandem as package
from tandem.errors import CellError, InfeasibleError, NotReadWarning, NotWrittenWarning, TandemError

VERBS: dict[str, tuple[str, str, str]] = {
    "init": (
        "tandem.cli.project",
        "init_command",
        "Lay out a project: a cell, variants, a place for results.",
    ),
    "plan": (
        "tandem.cli.planning",
        "plan_command",
        "Find every compromise of time and stress, with proof.",
    ),
    "replan": (
        "tandem.cli.replan",
        "replan_command",
        "Plan a changed cell with the fewest changes to an old plan.",
    ),
    "check": (
        "tandem.cli.planning",
        "check_command",
        "Say whether a cell is sound, and a result keeps to it.",
    ),
    "explain": (
        "tandem.cli.explain",
        "explain_command",
        "Say why a schedule is so, and what else would cost.",
    ),
    "report": (
        "tandem.cli.report",
        "report_command",
        "Write reports, sheets and pictures of a stored plan.",
    ),
    "compare": (
        "tandem.cli.compare",
        "compare_command",
        "Say what changed between two cells or two results.",
    ),
    "sensitivity": (
        "tandem.cli.sensitivity",
        "sensitivity_command",
        "Say which task time moves the front most.",
    ),
    "studio": (
        "tandem.cli.studio",
        "studio_command",
        "Edit, plan and question a cell on a local web page.",
    ),
    "train": (
        "tandem.cli.learn",
        "train_command",
        "Learn by trial and error who begins which task.",
    ),
    "evaluate": (
        "tandem.cli.learn",
        "evaluate_command",
        "Play what a run has learned, beside the exact front.",
    ),
    "crossplay": (
        "tandem.cli.crossplay",
        "crossplay_command",
        "Play the robots of one run beside the humans of another.",
    ),
    "play": (
        "tandem.cli.laboratory",
        "play_command",
        "Simulate a robot and a human, each trained in a file.",
    ),
    "reproduce": (
        "tandem.cli.laboratory",
        "reproduce_command",
        "Run a published system beside ours and the exact one.",
    ),
    "dispatch": (
        "tandem.cli.dispatch",
        "dispatch_command",
        "Run a shift: events in, decisions out.",
    ),
    "simulate": (
        "tandem.cli.simulate",
        "simulate_command",
        "Judge who decides, over many assemblies beside people.",
    ),
    "policies": (
        "tandem.cli.simulate",
        "policies_command",
        "List the policies: who can decide live.",
    ),
    "bench": (
        "tandem.cli.bench",
        "bench_command",
        "Sweep methods and policies over cells, seeds and people.",
    ),
    "methods": ("tandem.cli.planning", "methods_command", "List the methods of planning."),
    "generate": (
        "tandem.cli.cells",
        "generate",
        "Make a cell: random layers, chessboards, a benchmark by name.",
    ),
    "board": (
        "tandem.cli.boards",
        "board_command",
        "Put a cell on the chessboard of Yu et al. (2020).",
    ),
    "convert": (
        "tandem.cli.cells",
        "convert_command",
        "Turn a public format into a cell file, or a cell into one.",
    ),
    "formats": (
        "tandem.cli.cells",
        "formats_command",
        "List the formats; or which files of a folder are cells.",
    ),
    "schema": (
        "tandem.cli.cells",
        "schema_command",
        "Print the JSON Schema of cell files or of a shift.",
    ),
    "import": (
        "tandem.cli.sheets",
        "import_command",
        "Turn a planner's workbook into a cell file.",
    ),
    "score": (
        "tandem.cli.score",
        "score_command",
        "Score tasks by ergonomic methods, from posture, load and rate.",
    ),
    "rotate": (
        "tandem.cli.rotate",
        "rotate_command",
        "Rotate people over the roles of a cell, period by period.",
    ),
    "separate": (
        "tandem.cli.separate",
        "separate_command",
        "Say which places people and robots may use at once.",
    ),
    "times": (
        "tandem.cli.times",
        "times_command",
        "Work out task times from motions, TMU or learning.",
    ),
    "template": (
        "tandem.cli.sheets",
        "template_command",
        "Write a workbook to fill in, or a cell as one.",
    ),
}
"""Verb -> the module and the name of its command, which is loaded when it is needed, and what it
does in a line. A new verb is a line here.
"""

MOST_FAULTS = 50


class Verbs(click.Group):
    """Loads a command when it is asked for, so that `tandem --version` and each verb start
    quickly.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in VERBS:
            return None
        module, name, _ = VERBS[cmd_name]
        command: click.Command = getattr(importlib.import_module(module), name)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The verbs, each in one line that is never cut; no command is loaded for it."""
        with formatter.section("Commands"):
            formatter.write_dl([(verb, what) for verb, (_, _, what) in VERBS.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if (
            args
            and args[0] not in VERBS
            and (args[0].endswith((".yaml", ".yml", ".json")) or os.path.exists(args[0]))
        ):
            raise click.UsageError(
                f"{args[0]!r} is a file, not a verb. Did you mean: tandem plan {args[0]}?", ctx
            )
        return super().resolve_command(ctx, args)


EXIT_CODES = """\b
Exit codes: 0 done, 1 a bug of ours, 2 wrong usage, 3 bad input file,
4 proven infeasible, 5 nothing found within the limit, 6 a schedule that
breaks its cell, 7 a device or server not reachable, 130 interrupted.
Answers go to stdout, everything else to stderr.

`tandem VERB --help` says more about each verb."""


@click.group(
    cls=Verbs,
    epilog=EXIT_CODES,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(package.__version__, prog_name="tandem")
def tandem() -> None:
    """Plan the work that people and collaborative robots share.

    \b
    Examples:
      tandem plan cell.yaml
      tandem plan cell.yaml --report plan.html --max-stress 5
    """


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line and ends the process with one of the exit codes of the manual."""
    # read before NumPy is: its matrices are small here, and threads for them only wait for each
    # other, which on a busy machine takes several times as long
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # a task name must not stop a terminal that cannot print it
            stream.reconfigure(errors="backslashreplace")
    code = run(arguments)
    with contextlib.suppress(OSError):
        sys.stdout.flush()
    sys.exit(code)


def run(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line; returns the exit code. Everything expected is told in one message on
    stderr, without a traceback.
    """
    try:
        with warnings.catch_warnings():
            _tell_what_is_not_read()
            result: Any = tandem.main(
                args=None if arguments is None else list(arguments),
                prog_name="tandem",
                standalone_mode=False,
            )
        return result if isinstance(result, int) else 0
    except click.exceptions.Exit as exit_:
        return exit_.exit_code
    except click.Abort:
        return _say("interrupted.", 130)
    except KeyboardInterrupt:
        return _say("interrupted before anything was found.", 130)
    except click.ClickException as error:
        error.show(file=sys.stderr)
        return 2
    except TandemError as error:
        return _say(_message(error), error.exit_code)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        what = f"{error.filename}: " if error.filename else ""
        return _say(
            f"{what}{(error.strerror or str(error)).lower()}. Nothing was left half written; choose"
            " another place for the output.",
            2,
        )
    except Exception as error:
        if os.environ.get("TANDEM_DEBUG"):
            raise
        return _say(
            f"this is a bug in Tandem, not in your input: {type(error).__name__}: {error}\nPlease"
            " report it with the command and the cell file. With TANDEM_DEBUG=1 in the environment"
            " the traceback is shown.",
            1,
        )


def _tell_what_is_not_read() -> None:
    """Whatever command loads or writes a file: what has no place in the cell, or in the form that
    it is written in, is named on stderr, one line each.
    """
    told = (NotReadWarning, NotWrittenWarning)
    for kind in told:
        warnings.simplefilter("always", kind)
    show_others = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *rest: Any, **named: Any) -> None:
        if issubclass(category, told):
            click.echo(f"tandem: {message}", err=True)
        else:
            show_others(message, category, *rest, **named)

    warnings.showwarning = show


def _message(error: TandemError) -> str:
    if isinstance(error, CellError):
        shown = [str(fault) for fault in error.faults[:MOST_FAULTS]]
        rest = len(error.faults) - len(shown)
        return "\n".join([*shown, *([f"... and {rest} more."] if rest > 0 else [])])
    if isinstance(error, InfeasibleError):
        return str(error)
    return str(error)


def _say(message: str, code: int) -> int:
    with contextlib.suppress(OSError):
        click.echo(f"tandem: {message}" if "\n" not in message else f"tandem:\n{message}", err=True)
    return code
