"""Figures 6-1 to 6-8 of the thesis, redrawn from the records of runs here.

6-1 the precedence graph; 6-2 the training curves, each episode of each run for both agents; 6-3,
6-5, 6-7 the schedules that table 6-1 publishes for the factors 0, 1, 5; 6-4, 6-6, 6-8 beside each
what the thesis's recipe, as it is written, learned here at the same factor. As in the thesis these
six are step curves over time of the decisions in force, d_R(t) and d_H(t); below them stand the
same schedules as Gantt charts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell
from tandem.draw.curves import COLOURS, plot_curves
from tandem.draw.figure import blank, figure_for
from tandem.draw.gantt import plot_gantt
from tandem.draw.graph import plot_graph
from tandem.draw.style import FAINT_INK, INK, RULE
from tandem.lab.kinat2023.episode import Episode, follow, play
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.optimal import return_optimal
from tandem.lab.kinat2023.rewards import reward_set
from tandem.lab.kinat2023.runs import FACTORS, OURS, PUBLISHED, VARIANTS
from tandem.schedule.measures import makespan
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

AGENTS = ("robot", "human")
WINDOW = 30
"""Episodes of the sliding mean, as the thesis has it."""
STAGES = (("end of stage 1", 800), ("end of stage 2", 1300))
REWARD_TICKS = (-5000, -2000, -1000, -500, -200, 0)
Records = Sequence[Mapping[str, Any]]


def figures(document: Mapping[str, Any]) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after the other; the figures of learned schedules only where a run
    finished.
    """
    records = document["records"]
    yield "figure-6-1", precedence()
    if document.get("watched"):
        yield "figure-6-2", training(document["watched"])
    yield "figure-6-2-variants", curves(records)
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


def training(runs: Records) -> Figure:
    """Figure 6-2 as it is in the thesis: each episode's reward, its sliding mean over the last 30,
    and what the critic thought the first state worth (Q0). A row a run, a column an agent.
    """
    figure = blank(10.4, 2.9 * len(runs) + 0.5)
    figure.clear()
    rows = figure.subplots(len(runs), len(AGENTS), sharex=True, squeeze=False)
    for row, record in zip(rows, runs, strict=True):
        for agent, (ax, name) in enumerate(zip(row, AGENTS, strict=True)):
            _watch(ax, record, agent)
            ax.set_title(
                f"{name}, factor {record['factor']:g}, seed {record['seed']}", loc="left", size=10
            )
    for ax in rows[-1]:
        ax.set_xlabel("episode")
    rows[0][0].legend(frameon=False, fontsize=8, loc="lower right")
    return figure


def _watch(ax: Axes, record: Mapping[str, Any], agent: int) -> None:
    """One agent of one run, as the toolbox's training monitor shows it."""
    from matplotlib.ticker import NullLocator

    paid, thought = (
        [pair[agent] for pair in record["every_episode"][name]]
        for name in ("returns", "first_value")
    )
    episodes = range(1, len(paid) + 1)
    ax.plot(episodes, paid, color=COLOURS[0], lw=0.5, alpha=0.45, label="reward of the episode")
    ax.plot(episodes, sliding_mean(paid), color=COLOURS[4], lw=1.6, label=f"mean over {WINDOW}")
    ax.plot(episodes, thought, color=COLOURS[2], lw=1.2, ls="--", label="critic's estimate, Q0")
    for _, where in STAGES:
        ax.axvline(where, color=FAINT_INK, lw=0.8, ls=(0, (2, 3)), zorder=0)
    # the first episodes cost thousands: on a plain axis all later ones would be one line
    ax.set_yscale("symlog", linthresh=500)
    ax.set_yticks(REWARD_TICKS, [f"{tick:,}" for tick in REWARD_TICKS])
    ax.yaxis.set_minor_locator(NullLocator())
    ax.set_ylim(1.15 * min(paid), max(100, *paid, *thought))
    ax.set_ylabel("reward")
    ax.grid(True, color=RULE, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)


def sliding_mean(values: Sequence[float], window: int = WINDOW) -> list[float]:
    """Mean of each value and those before it, `window` at most."""
    return [
        sum(values[max(0, end - window) : end]) / min(end, window)
        for end in range(1, len(values) + 1)
    ]


def curves(records: Records) -> Figure:
    """Figure 6-2 over all seeds: return over episodes; above the thesis's recipe in its variants,
    below ours; factor 1, mean over seeds.
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
    return _decisions_and_gantt(
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
    return _decisions_and_gantt(
        episode, f"{title}. Published pair: {reached} of {len(records)} runs that finish"
    )


def _decisions_and_gantt(episode: Episode, title: str) -> Figure:
    """The decisions in force as the thesis draws them, and the schedule as we do, over one time."""
    cell, schedule = thesis_cell(), episode.schedule
    figure = blank(9.6, 6.4)
    figure.clear()
    *above, below = figure.subplots(
        len(AGENTS) + 1, 1, sharex=True, gridspec_kw={"height_ratios": [1, 1, 1.25]}
    )
    for ax, name, operator in zip(above, "RH", (cell.robots[0], cell.humans[0]), strict=True):
        plot_decisions(ax, decisions_in_force(cell, schedule, operator), len(cell.tasks))
        ax.set_ylabel(f"$d_{name}(t)$, {operator}")
    above[0].set_title(title, loc="left", fontsize=11)
    plot_gantt(cell, schedule, ax=below, until=30, title="", critical=False)
    return figure


def decisions_in_force(
    cell: Cell, schedule: Schedule, operator: str
) -> tuple[list[float], list[int]]:
    """When what the operator does changes, seconds, and the number of the task from then on; 0 =
    none. The last moment is the schedule's end.
    """
    numbers = {name: number for number, name in enumerate(cell.tasks, 1)}
    own = sorted((row for row in schedule if operator in row.operators), key=lambda row: row.start)
    moments, doing = [0.0], [0]
    for row in own:
        for moment, number in ((row.start, numbers[row.task]), (row.end, 0)):
            if moments[-1] == moment:
                doing[-1] = number
            else:
                moments.append(moment)
                doing.append(number)
    if moments[-1] < (end := makespan(schedule)):
        moments.append(end)
        doing.append(0)
    return moments, doing


def plot_decisions(ax: Axes, changes: tuple[list[float], list[int]], tasks: int) -> None:
    """The number of the task in hand over time, as a step curve."""
    moments, doing = changes
    ax.step(moments, doing, where="post", color=INK, lw=1.8)
    ax.set_ylim(-0.4, tasks + 0.4)
    ax.set_yticks(range(tasks + 1))
    ax.grid(True, color=RULE, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)


def _is_published(record: Mapping[str, Any], factor: float) -> bool:
    return (record["greedy"]["makespan"], record["greedy"]["stress"]) == PUBLISHED[int(factor)]


def _line(records: Records, name: str) -> tuple[list[list[float]], list[list[float]]]:
    """Episodes and the sum over both agents, a list per seed."""
    return [record["curve"]["episodes"] for record in records], [
        [sum(values) for values in record["curve"][name]] for record in records
    ]
