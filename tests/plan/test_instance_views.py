"""One instance for all: what is left out of it, finer ticks and other paces, and its sets as
bits.
"""

from __future__ import annotations

from dataclasses import fields

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.plan.test_judges import two_parts
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.plan.instance import Instance, bits

OPTIONS = {"deadline": None, "max_examples": 60}


def same_but(one: Instance, other: Instance, *names: str) -> bool:
    """Whether two instances differ in these fields at most."""
    kept = [field.name for field in fields(Instance) if field.name not in names]
    return all(getattr(one, name) == getattr(other, name) for name in kept)


@settings(**OPTIONS)
@given(cells(max_tasks=7), st.data())
def test_a_restricted_instance_is_that_of_the_cell_without_the_other_tasks(
    cell: Cell, data: st.DataObject
) -> None:
    """Predecessors that are left out are taken as done, as what is left of an assembly takes
    them.
    """
    full = Instance.of(cell)
    kept = data.draw(st.lists(st.sampled_from(range(len(full.tasks))), unique=True, min_size=1))
    names = [full.tasks[task] for task in kept]
    tasks = cell.to_dict()["tasks"]
    for name in names:
        tasks[name]["after"] = [first for first in tasks[name].get("after", ()) if first in names]
        waits = tasks[name].get("wait", ())
        tasks[name]["wait"] = [wait for wait in waits if wait["after"] in names]
    # Stated, so that tools and zones keep what they are though no task may name them any more.
    tools = {
        name: {
            "capacity": full.tool_places[u],
            "changeover": {
                who: full.seconds(ticks)
                for who, ticks in zip(full.operators, full.changeover[u], strict=True)
            },
        }
        for u, name in enumerate(full.tools)
    }
    smaller = Instance.of(
        Cell.model_validate(
            {
                **cell.to_dict(),
                "operators": {
                    who: {key: value for key, value in entry.items() if key != "holds"}
                    for who, entry in cell.to_dict()["operators"].items()
                },
                "tasks": {name: tasks[name] for name in names},
                "tools": tools,
                "zones": {
                    name: {"capacity": full.zone_places[z]} for z, name in enumerate(full.zones)
                },
                "same_operator": [pair for pair in cell.same_operator if set(pair) <= set(names)],
                "stress_of_set": None,
            }
        )
    )
    rest = full.restricted(
        kept, [full.ways[task] for task in kept], [full.release[task] for task in kept]
    )
    order = {name: u for u, name in enumerate(smaller.tools)}
    zones = {name: z for z, name in enumerate(smaller.zones)}
    scale, units = full.per_second // smaller.per_second, full.per_stress // smaller.per_stress
    assert rest.tasks == smaller.tasks
    assert [set(row) for row in rest.before] == [set(row) for row in smaller.before]
    assert set(rest.lags) == set(smaller.scaled(scale).lags)
    assert rest.release == smaller.scaled(scale).release
    assert rest.deadline == smaller.scaled(scale).deadline
    assert rest.breaks == smaller.scaled(scale).breaks
    assert [[(w.operators, w.ticks) for w in row] for row in rest.ways] == [
        [(w.operators, w.ticks * scale) for w in row] for row in smaller.ways
    ]
    assert [[w.stress for w in row] for row in rest.ways] == [
        [w.stress * units for w in row] for row in smaller.ways
    ]
    assert [
        [[None if u is None else order[full.tools[u]] for u in w.tools] for w in row]
        for row in rest.ways
    ] == [[list(w.tools) for w in row] for row in smaller.ways]
    assert [None if z is None else zones[full.zones[z]] for z in rest.zone] == list(smaller.zone)
    assert rest.same_operator == smaller.same_operator
    assert rest.team == smaller.team


@settings(**OPTIONS)
@given(cells(max_tasks=7))
def test_nothing_is_lost_when_all_tasks_stay(cell: Cell) -> None:
    full = Instance.of(cell)
    assert same_but(
        full.restricted(range(len(full.tasks)), full.ways, full.release), full, "stress_of_set"
    )


@settings(**OPTIONS)
@given(cells(max_tasks=7), st.integers(2, 1000))
def test_finer_ticks_mean_the_same_seconds(cell: Cell, times: int) -> None:
    stated = Instance.of(cell)
    finer = stated.scaled(times)
    assert [[finer.seconds(way.ticks) for way in row] for row in finer.ways] == [
        [stated.seconds(way.ticks) for way in row] for row in stated.ways
    ]
    assert finer.horizon == times * stated.horizon
    assert finer.head == tuple(times * ticks for ticks in stated.head)
    assert finer.tail == tuple(times * ticks for ticks in stated.tail)
    assert finer.arrival == tuple(times * ticks for ticks in stated.arrival)


def test_a_group_goes_at_the_pace_of_its_slowest() -> None:
    cell = Cell.model_validate({
        "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": {"a": {"time": {"anna": 2.0, "cobot": 3.0}, "together": [{"operators": ["cobot",
        "anna"], "time": 1.0}]}},
    })  # fmt: skip
    paced = Instance.of(cell).scaled(1000, [1.5, 1.0])
    assert [way.ticks for way in paced.ways[0]] == [3000, 3000, 1500]


@settings(**OPTIONS)
@given(cells(max_tasks=7))
def test_sets_as_bits_say_what_the_lists_say(cell: Cell) -> None:
    instance = Instance.of(cell)
    tasks = range(len(instance.tasks))
    assert instance.needs == tuple(bits(row) for row in instance.before)
    for one in tasks:
        for other in tasks:
            assert instance.followers[one] >> other & 1 == instance.needs[other] >> one & 1
    assert (
        instance.humans
        | bits(o for o, name in enumerate(instance.operators) if name not in cell.humans)
        == instance.everybody
    )
    places = {task: place for place, task in enumerate(instance.order)}
    assert all(places[first] < places[task] for task in tasks for first in instance.before[task])
    for group in instance.team:
        assert group < 0 or instance.team.count(group) > 1


def test_what_is_left_of_a_hold_says_whether_the_part_is_in_already() -> None:
    instance = Instance.of(two_parts())
    at = {name: task for task, name in enumerate(instance.tasks)}

    def left(tasks: list[str], begun: list[str]) -> list[tuple[int, int, list[str]]]:
        held = instance.still_held([at[name] for name in tasks], bits(at[name] for name in begun))
        inside = [[name for i, name in enumerate(tasks) if w >> i & 1] for w in held["within"]]
        return [
            (first, last, names)
            for (_, first, last), names in zip(held["holds"], inside, strict=True)
        ]

    assert left(["in 1", "run 1", "out 1"], []) == [(0, 2, ["in 1", "run 1", "out 1"])]
    assert left(["run 1", "out 1", "stamp"], ["in 1"]) == [(-1, 1, ["run 1", "out 1"])]
    assert left(["in 1", "stamp"], []) == [(0, -1, ["in 1"])]
    assert left(["run 1"], ["in 1"]) == [(-1, -1, ["run 1"])]
    assert left(["stamp"], ["in 1", "run 1", "out 1"]) == []
    assert left(["stamp"], []) == []
