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
from tandem.errors import CellError, InfeasibleError, NotReadWarning, TandemError

VERBS: dict[str, tuple[str, str]] = {
    "init": ("tandem.cli.project", "init_command"),
    "plan": ("tandem.cli.planning", "plan_command"),
    "check": ("tandem.cli.planning", "check_command"),
    "explain": ("tandem.cli.answers", "explain_command"),
    "compare": ("tandem.cli.answers", "compare_command"),
    "sensitivity": ("tandem.cli.answers", "sensitivity_command"),
    "train": ("tandem.cli.learn", "train_command"),
    "evaluate": ("tandem.cli.learn", "evaluate_command"),
    "reproduce": ("tandem.cli.laboratory", "reproduce_command"),
    "dispatch": ("tandem.cli.dispatch", "dispatch_command"),
    "simulate": ("tandem.cli.simulate", "simulate_command"),
    "policies": ("tandem.cli.simulate", "policies_command"),
    "methods": ("tandem.cli.planning", "methods_command"),
    "generate": ("tandem.cli.cells", "generate"),
    "board": ("tandem.cli.boards", "board_command"),
    "convert": ("tandem.cli.cells", "convert_command"),
    "schema": ("tandem.cli.cells", "schema_command"),
    "import": ("tandem.cli.sheets", "import_command"),
    "template": ("tandem.cli.sheets", "template_command"),
}
"""Verb -> the module and the name of its command, which is loaded when it is needed. A new verb is a line here."""

MOST_FAULTS = 50


class Verbs(click.Group):
    """Loads a command when it is asked for, so that `tandem --version` and each verb start quickly."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in VERBS:
            return None
        module, name = VERBS[cmd_name]
        command: click.Command = getattr(importlib.import_module(module), name)
        return command

    def resolve_command(self, ctx: click.Context, args: list[str]) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in VERBS and (args[0].endswith((".yaml", ".yml", ".json")) or os.path.exists(args[0])):
            raise click.UsageError(f"{args[0]!r} is a file, not a verb. Did you mean: tandem plan {args[0]}?", ctx)
        return super().resolve_command(ctx, args)


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
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
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a task name must not stop a terminal that cannot print it
    code = run(arguments)
    with contextlib.suppress(OSError):
        sys.stdout.flush()
    sys.exit(code)


def run(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line; returns the exit code. Everything expected is told in one message on stderr, without a traceback."""
    try:
        with warnings.catch_warnings():
            _tell_what_is_not_read()
            result: Any = tandem.main(args=None if arguments is None else list(arguments), prog_name="tandem", standalone_mode=False)
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
        return _say(f"{what}{(error.strerror or str(error)).lower()}. Nothing was left half written; choose another place for the output.", 2)
    except Exception as error:
        if os.environ.get("TANDEM_DEBUG"):
            raise
        return _say(
            f"this is a bug in Tandem, not in your input: {type(error).__name__}: {error}\n"
            "Please report it with the command and the cell file. With TANDEM_DEBUG=1 in the environment the traceback is shown.",
            1,
        )


def _tell_what_is_not_read() -> None:
    """Whatever command loads a file: what has no place in the cell is named on stderr, one line each."""
    warnings.simplefilter("always", NotReadWarning)
    show_others = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *rest: Any, **named: Any) -> None:
        if issubclass(category, NotReadWarning):
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
