"""Figures 6-1 to 6-8 of the thesis, redrawn from the records of runs here.

6-1 the precedence graph; 6-2 the training curves; 6-3, 6-5, 6-7 the schedules that table 6-1
publishes for the factors 0, 1, 5; 6-4, 6-6, 6-8 beside each what the thesis's recipe, as it is
written, learned here at the same factor.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tandem.draw.curves import plot_curves
from tandem.draw.figure import blank, figure_for
from tandem.draw.gantt import plot_gantt
from tandem.draw.graph import plot_graph
from tandem.lab.kinat2023.episode import Episode, follow, play
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.optimal import return_optimal
from tandem.lab.kinat2023.rewards import reward_set
from tandem.lab.kinat2023.runs import FACTORS, OURS, PUBLISHED, VARIANTS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STAGES = (("end of stage 1", 800), ("end of stage 2", 1300))
Records = Sequence[Mapping[str, Any]]


def figures(document: Mapping[str, Any]) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after the other; the figures of learned schedules only where a run
    finished.
    """
    records = document["records"]
    yield "figure-6-1", precedence()
    yield "figure-6-2", curves(records)
    for index, factor in enumerate(FACTORS):
        yield f"figure-6-{3 + 2 * index}", published(factor)
        learned = [
            record
            for record in records
            if record["factor"] == factor
            and record["variant"] == "thesis"
            and record["greedy"]["makespan"] is not None
        ]
        if learned:
            yield f"figure-6-{4 + 2 * index}", learned_schedule(factor, learned)


def precedence() -> Figure:
    """Figure 6-1: what must be done before what."""
    cell = thesis_cell()
    figure = figure_for(cell, kind="graph")
    plot_graph(cell, ax=figure.axes[0])
    return figure


def curves(records: Records) -> Figure:
    """Figure 6-2: return over episodes; above the thesis's recipe in its variants, below ours;
    factor 1, mean over seeds.
    """
    figure = blank(8.6, 8.2)
    figure.clear()
    above, below = figure.subplots(2, 1)
    lines = {}
    for variant in VARIANTS:
        own = [
            record
            for record in records
            if record["variant"] == variant
            and record["factor"] == 1
            and record["curve"]["episodes"]
        ]
        if own:
            label = (
                variant.replace("thesis, ", "with ")
                .replace("thesis", "as written")
                .replace("table 5-2", "table 5-2 (other units)")
            )
            lines[label] = _line(own, "returns")
    plot_curves(
        lines,
        above,
        ylabel="return, robot and human summed",
        title=(
            "The thesis's recipe at factor 1 (mean over 30 episodes, then over seeds, with 95 %"
            " interval)"
        ),
        marks=dict(STAGES) if lines else None,
    )
    ours = [
        record
        for record in records
        if record["variant"] == OURS and record["factor"] == 1 and record["curve"]["episodes"]
    ]
    if ours:
        pair = {
            "return": _line(ours, "returns"),
            "critics' value of the first state": _line(ours, "first_value"),
        }
        best = return_optimal(thesis_cell(), reward_set("appendix", stress_factor=1)).value
        plot_curves(
            pair,
            below,
            ylabel="return, robot and human summed",
            title=f"Our recipe at factor 1 ({len(ours)} seeds)",
            levels={"return-optimal (DP)": best},
        )
    return figure


def published(factor: float) -> Figure:
    """Figures 6-3, 6-5, 6-7: a schedule of the published makespan and stress; a return-optimal
    policy of the appendix's rewards plays it.
    """
    cell, rewards = thesis_cell(), reward_set("appendix", stress_factor=factor)
    wanted = PUBLISHED[int(factor)]
    found = return_optimal(cell, rewards)
    actions = next(
        actions for way, actions in found.actions.items() if (way.makespan, way.stress) == wanted
    )
    return _gantt(
        play(cell, rewards, follow(actions), by="ticks"),
        f"A schedule of the published result at factor {factor:g}: {wanted[0]} s, stress"
        f" {wanted[1]}",
    )


def learned_schedule(factor: float, records: Records) -> Figure:
    """Figures 6-4, 6-6, 6-8: the greedy play of the run that lost least among `records`, which have
    the same rewards; its seed in the title.
    """
    best = max(
        records,
        key=lambda record: (_is_published(record, factor), sum(record["greedy"]["returns"])),
    )
    steps = [(robot, human) for robot, human in best["greedy"]["actions"]]
    episode = play(
        thesis_cell(), reward_set("appendix", stress_factor=factor), follow(steps), by="ticks"
    )
    reached = sum(_is_published(record, factor) for record in records)
    title = (
        f"Learned at factor {factor:g}, seed {best['seed']}: {episode.ticks} s, stress"
        f" {episode.stress:g}"
    )
    return _gantt(episode, f"{title}. Published pair: {reached} of {len(records)} runs that finish")


def _gantt(episode: Episode, title: str) -> Figure:
    cell = thesis_cell()
    figure = figure_for(cell, episode.schedule)
    plot_gantt(cell, episode.schedule, ax=figure.axes[0], until=30, title=title, critical=False)
    return figure


def _is_published(record: Mapping[str, Any], factor: float) -> bool:
    return (record["greedy"]["makespan"], record["greedy"]["stress"]) == PUBLISHED[int(factor)]


def _line(records: Records, name: str) -> tuple[list[list[float]], list[list[float]]]:
    """Episodes and the sum over both agents, a list per seed."""
    return [record["curve"]["episodes"] for record in records], [
        [sum(values) for values in record["curve"][name]] for record in records
    ]
