"""The curves of a run, from its figures on disk."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from tandem.draw.curves import plot_curves

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_training(
    rows: Sequence[dict[str, Any]], ax: Axes | None = None, *, title: str = ""
) -> Axes:
    """Return per agent and the critics' value of the first state over episodes, as the thesis's
    figure 6-2; mean over the seeds.

    Args:
      rows: `RunFolder.figures()`.
    """
    seeds = sorted({row["seed"] for row in rows})
    agents = [
        name.removeprefix("mean_return_") for name in rows[0] if name.startswith("mean_return_")
    ]

    def line(name: str) -> tuple[list[list[float]], list[list[float]]]:
        chosen = [[row for row in rows if row["seed"] == seed] for seed in seeds]
        return [[row["episodes"] for row in own] for own in chosen], [
            [row[name] for row in own] for own in chosen
        ]

    lines = {f"{agent}: return": line(f"mean_return_{agent}") for agent in agents}
    # not every algorithm has a critic
    judged = [agent for agent in agents if f"first_value_{agent}" in rows[0]]
    lines |= {
        f"{agent}: critic's value of the first state": line(f"first_value_{agent}")
        for agent in judged
    }
    return plot_curves(
        lines,
        ax,
        title=title or f"{len(seeds)} seed{'s' * (len(seeds) > 1)}, mean and 95 % interval",
    )
