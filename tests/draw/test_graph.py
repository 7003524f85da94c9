"""The precedence graph: only arrows that say something, layers in order, everyone who can."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.draw.cells import desk, gearbox, layered, thesis
from tests.schedule.cells import GLUED, glued

from tandem.cell.model import Cell
from tandem.draw.figure import figure_for
from tandem.draw.graph import chips, plot_graph, who_can
from tandem.draw.language import words
from tandem.draw.layers import critical_chain, layers, reduced


def chain_cell(pairs: list[tuple[int, int]], tasks: int) -> Cell:
    made = {
        str(i): {"time": {"r": 1 + i % 3}, "after": [str(a) for a, b in pairs if b == i]}
        for i in range(tasks)
    }
    return Cell.model_validate({"operators": {"r": {"kind": "robot"}}, "tasks": made})


graphs = st.integers(1, 12).flatmap(
    lambda n: st.builds(
        chain_cell,
        st.lists(
            st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)).filter(lambda p: p[0] < p[1]),
            unique=True,
            max_size=30,
        ),
        st.just(n),
    )
)


def reach(after: dict[str, tuple[str, ...]]) -> set[tuple[str, str]]:
    found = {(a, b) for b, firsts in after.items() for a in firsts}
    while more := {(a, d) for a, b in found for c, d in found if b == c} - found:
        found |= more
    return found


@settings(max_examples=60, deadline=None)
@given(graphs)
def test_the_reduction_keeps_what_follows_and_no_arrow_too_many(cell: Cell) -> None:
    less = reduced(cell)
    full = reach({name: task.after for name, task in cell.tasks.items()})
    assert reach(less) == full
    for name, firsts in less.items():
        for first in firsts:
            assert (first, name) not in reach(
                {**less, name: tuple(f for f in firsts if f != first)}
            )


@settings(max_examples=60, deadline=None)
@given(graphs)
def test_no_two_tasks_overlap_and_arrows_run_to_the_right(cell: Cell) -> None:
    drawn = layers(cell)
    assert set(drawn.at) == set(cell.tasks)
    places = list(drawn.at.values())
    assert [
        1 for i, (x, y) in enumerate(places) for a, b in places[:i] if x == a and abs(y - b) < 0.999
    ] == []
    assert set(drawn.arrows) == {
        (first, name) for name, firsts in reduced(cell).items() for first in firsts
    }
    for (first, then), points in drawn.arrows.items():
        assert (points[0], points[-1]) == (drawn.at[first], drawn.at[then])
        assert all(b[0] - a[0] == 1 for a, b in itertools.pairwise(points))
    assert min(y for _, y in places) >= -1e-9


def test_the_thesis_graph_has_the_arrows_that_are_left() -> None:
    assert reduced(thesis()) == {
        "1": (),
        "2": (),
        "3": (),
        "4": ("1", "2"),
        "5": ("3",),
        "6": ("4",),
        "7": ("5", "6"),
    }
    assert critical_chain(thesis()) == (("1", "4", "6", "7"), 16.0)


def test_a_wait_is_an_arrow_and_counts_in_the_longest_chain() -> None:
    assert reduced(glued()) == {"sort": (), "glue": (), "press": ("sort", "glue"), "cool": ()}
    assert critical_chain(glued()) == (("sort", "press"), 110.0)
    quick = {**GLUED["tasks"], "sort": {"time": {"anna": 30}}}
    assert critical_chain(glued(tasks=quick)) == (("glue", "press"), 55.0)


def test_crossings_that_can_be_avoided_are_avoided() -> None:
    cell = chain_cell([(0, 5), (1, 4), (2, 3)], 6)
    at = layers(cell).at
    assert [at["5"][1] > at["4"][1] > at["3"][1], at["0"][1] > at["1"][1] > at["2"][1]] in (
        [True, True],
        [False, False],
    )


@pytest.mark.parametrize(
    "cell", [thesis(), gearbox(), desk(), layered(120)], ids=lambda cell: cell.name
)
def test_every_task_has_a_node_and_every_kept_precedence_an_arrow(cell: Cell) -> None:
    ax = plot_graph(cell, figure_for(cell, kind="graph").axes[0])
    gids = [patch.get_gid() for patch in ax.patches if patch.get_gid()]
    assert sorted(g for g in gids if g.startswith("task ")) == sorted(
        f"task {name}" for name in cell.tasks
    )
    assert len([g for g in gids if g.startswith("arrow ")]) == sum(map(len, reduced(cell).values()))


def test_nodes_say_who_can_and_how_long() -> None:
    assert [chip.words for chip in chips(thesis(), "1", words())] == ["R 9", "H 10"]
    assert [chip.words for chip in chips(gearbox(), "housing", words())] == ["A 6.5", "A+C1 8"]
    assert who_can(gearbox())["cover"] == ("ben", "cobot2")
    crowd = Cell.model_validate(
        {
            "operators": {f"r{i}": {"kind": "robot"} for i in range(9)},
            "tasks": {"a": {"time": {f"r{i}": 2 for i in range(9)}}},
        }
    )
    assert [chip.words for chip in chips(crowd, "a", words())] == ["R0 2", "R1 2", "R2 2", "+6"]


def test_a_large_cell_gets_room_for_every_node() -> None:
    cell = layered(120)
    figure = figure_for(cell, kind="graph")
    columns, rows = layers(cell).extent
    assert figure.get_figwidth() / columns > 1.9
    assert figure.get_figheight() / rows > 0.8
