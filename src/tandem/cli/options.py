"""Options that several commands take."""

from __future__ import annotations

from typing import Any

import click

from tandem.files.formats.table import FORMATS

FORMAT = click.option(
    "--format",
    "form",
    metavar="NAME",
    help=f"What CELL is written in; told from its content when absent: {', '.join(FORMATS)}.",
)


class Weights(click.ParamType):  # type: ignore[type-arg]  # older releases of click take no parameter
    """Two numbers joined by a comma."""

    name = "TIME,STRESS"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        if isinstance(value, tuple):
            return value
        try:
            time, stress = (float(part) for part in str(value).split(","))
        except ValueError:
            self.fail(f"{value!r} is not two numbers joined by a comma, such as 1,0.5.", param, ctx)
        return time, stress
