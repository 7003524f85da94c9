"""Which of a run's policies is taken, said on stderr where there was a choice."""

from __future__ import annotations

from pathlib import Path

import click


def say_which_seed(learned: str | None) -> None:
    """Names the seed that is taken of a run's folder; says nothing of a file, or of a run of one
    seed.
    """
    if learned is None or not Path(learned).is_dir():
        return
    from tandem.learn.training.runs import RunFolder

    if said := RunFolder(Path(learned)).chosen():
        click.echo(said, err=True)
