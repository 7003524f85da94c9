"""Random small cells with every feature, for hypothesis. They are sound by construction; some have
no schedule at all.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

from hypothesis import strategies as st

from tandem.cell.model import Cell
from tandem.errors import CellError

STEPS = (1.0, 1.0, 0.5, 0.1, 0.25)
"""Seconds that all times of one cell are multiples of."""


@st.composite
def cells(
    draw: st.DrawFn,
    min_tasks: int = 1,
    max_tasks: int = 7,
    max_operators: int = 3,
    rich: bool = True,
) -> Cell:
    """A sound cell of 1 to 5 tasks, seldom more, and 1 to 3 operators.

    `rich=False` leaves out tools, zones, breaks, deadlines, waits, limits, pairs and tables: only
    times, joint tasks, precedence and stress. Most cells can be planned; deadlines, waits with a
    most, stress limits and tables make some of them infeasible.
    """
    step = draw(st.sampled_from(STEPS))
    operators = draw(_operators(max_operators, step, rich))
    most = draw(st.sampled_from((min(5, max_tasks),) * 4 + (max_tasks,)))
    count = draw(st.integers(min(min_tasks, most), most))
    names = [str(place + 1) for place in range(count)]
    tools = draw(_tools(list(operators), step)) if rich else {}
    zones = draw(_zones()) if rich else {}
    tasks: dict[str, dict[str, Any]] = {}
    for place, name in enumerate(names):
        tasks[name] = draw(_task(operators, names[:place], step))
        if rich:
            _add_place_and_tool(draw, tasks[name], tools, zones, step)
    data: dict[str, Any] = {
        "name": "random",
        "operators": operators,
        "tasks": tasks,
        "tools": tools,
        "zones": zones,
    }
    if rich:
        _put_tools_in_hands(draw, operators, tools)
        if draw(_seldom()):
            data |= _add_places(draw, operators, tasks, step)
        data["same_operator"] = draw(_pairs(tasks))
        if draw(_seldom()):
            data["stress_of_set"] = draw(_table(tasks, operators))
        if draw(_seldom()):
            data["tasks"] = {name: tasks[name] for name in draw(st.permutations(names))}
            data.pop("stress_of_set", None)
        if count > 1 and draw(_seldom()):
            _add_waits(draw, names, tasks, step)
        _let_machines_hold(draw, operators, tasks)
        if draw(_seldom()):
            return _with_deadlines(draw, data, step)
    return Cell.model_validate(data)


def _seldom() -> st.SearchStrategy[bool]:
    return st.sampled_from((False, False, False, True))


def _seconds(step: float, low: int = 1, high: int = 8) -> st.SearchStrategy[float]:
    return st.integers(low, high).map(lambda count: round(count * step, 6))


def _stress() -> st.SearchStrategy[float]:
    return st.one_of(st.integers(0, 6), st.integers(0, 24).map(lambda quarters: quarters / 4))


@st.composite
def _operators(draw: st.DrawFn, most: int, step: float, rich: bool) -> dict[str, dict[str, Any]]:
    kinds = draw(
        st.lists(
            st.sampled_from(("human", "human", "robot", "robot", "machine")),
            min_size=1,
            max_size=most,
        )
    )
    operators: dict[str, dict[str, Any]] = {}
    for place, kind in enumerate(kinds):
        operator: dict[str, Any] = {"kind": kind}
        if rich and draw(_seldom()):
            start = draw(st.integers(0, 8))
            first = (round(start * step, 6), round((start + draw(st.integers(1, 4))) * step, 6))
            operator["breaks"] = [first]
            if draw(_seldom()):
                gap = draw(st.integers(0, 5))
                operator["breaks"].append(
                    (round(first[1] + gap * step, 6), round(first[1] + (gap + 2) * step, 6))
                )
        if rich and draw(_seldom()):
            operator["setup"] = round(draw(st.integers(1, 6)) * step, 6)
        if rich and kind == "human" and draw(_seldom()):
            operator["stress_limit"] = draw(st.integers(0, 14))
        operators[f"{kind}_{place}"] = operator
    return operators


@st.composite
def _tools(draw: st.DrawFn, operators: list[str], step: float) -> dict[str, dict[str, Any]]:
    tools = {}
    for name in ("driver", "wrench")[: draw(st.sampled_from((0, 0, 1, 2, 2)))]:
        changeover = draw(
            st.dictionaries(st.sampled_from(operators), _seconds(step, 0, 4), max_size=3)
        )
        tools[name] = {"capacity": draw(st.integers(1, 2)), "changeover": changeover}
    return tools


@st.composite
def _zones(draw: st.DrawFn) -> dict[str, dict[str, Any]]:
    zones: dict[str, dict[str, Any]] = {}
    for name in ("jig", "bench")[: draw(st.sampled_from((0, 0, 0, 1, 2)))]:
        zones[name] = {"capacity": draw(st.integers(1, 2))}
        if draw(_seldom()):
            kinds = st.sampled_from(("human", "robot", "machine"))
            zones[name]["apart"] = draw(st.lists(kinds, min_size=2, unique=True))
    return zones


@st.composite
def _task(
    draw: st.DrawFn, operators: dict[str, Any], earlier: list[str], step: float
) -> dict[str, Any]:
    names = list(operators)
    humans = [name for name in names if operators[name]["kind"] == "human"]
    groups = [group for size in range(2, len(names) + 1) for group in combinations(names, size)]
    together = (
        draw(st.lists(st.sampled_from(groups), unique=True, max_size=2))
        if groups and draw(_seldom())
        else []
    )
    alone = draw(st.lists(st.sampled_from(names), unique=True, min_size=0 if together else 1))
    task: dict[str, Any] = {"time": {name: draw(_seconds(step)) for name in alone}}

    def stress(among: list[str]) -> Any:
        if among and draw(_seldom()):
            return {
                name: draw(_stress())
                for name in draw(st.lists(st.sampled_from(among), unique=True))
            }
        return draw(_stress())

    task["stress"] = stress(humans)
    task["together"] = []
    for group in together:
        joint: dict[str, Any] = {
            "operators": draw(st.permutations(group)),
            "time": draw(_seconds(step)),
        }
        if draw(st.booleans()):
            joint["stress"] = stress([name for name in humans if name in group])
        task["together"].append(joint)
    if earlier:
        task["after"] = draw(st.lists(st.sampled_from(earlier), unique=True, max_size=2))
    return task


def _add_place_and_tool(
    draw: st.DrawFn, task: dict[str, Any], tools: dict[str, Any], zones: dict[str, Any], step: float
) -> None:
    """Where and with what a task is done; only what leaves room for one way of doing it."""
    least = 1 if task["time"] else min(len(joint["operators"]) for joint in task["together"])
    for key, table in (("tool", tools), ("zone", zones)):
        roomy = [
            name
            for name, entry in table.items()
            if entry["capacity"] >= least and (task["time"] or not entry.get("apart"))
        ]
        if roomy and draw(st.booleans()):
            task[key] = draw(st.sampled_from(roomy))
        if roomy and key == "tool" and draw(_seldom()):
            _add_own_tools(draw, task, roomy)
    if draw(_seldom()):
        task["release"] = draw(_seconds(step, 0, 10))
    if draw(_seldom()):
        task["difficulty"] = {name: draw(_stress()) for name in task["time"]}
    if draw(_seldom()):
        task["spread"] = draw(st.sampled_from((0.1, 0.25)))


def _add_own_tools(draw: st.DrawFn, task: dict[str, Any], tools: list[str]) -> None:
    """Tools by operator, and for groups of their own."""
    everybody = sorted({who for group in _groups(task) for who in group})
    task["tool"] = draw(
        st.dictionaries(st.sampled_from(everybody), st.sampled_from(tools), max_size=3)
    )
    for joint in task["together"]:
        if draw(st.booleans()):
            joint["tool"] = draw(
                st.dictionaries(st.sampled_from(joint["operators"]), st.sampled_from(tools))
            )


def _let_machines_hold(draw: st.DrawFn, operators: dict[str, Any], tasks: dict[str, Any]) -> None:
    def ahead(name: str) -> set[str]:
        waits = tasks[name].get("wait", ())
        waits = [waits] if isinstance(waits, dict) else waits
        ended = (wait["after"] for wait in waits if wait.get("between") != "start-start")
        direct = {*tasks[name].get("after", ()), *ended}
        return direct.union(*(ahead(first) for first in direct))

    chains = [(first, name) for name in tasks for first in tasks if first in ahead(name)]
    for operator in operators.values():
        if operator["kind"] == "machine" and chains and draw(st.booleans()):
            pairs = st.lists(st.sampled_from(chains), min_size=1, max_size=2, unique=True)
            operator["holds"] = draw(pairs)


def _put_tools_in_hands(draw: st.DrawFn, operators: dict[str, Any], tools: dict[str, Any]) -> None:
    for operator in operators.values():
        if tools and draw(_seldom()):
            operator["tool"] = draw(st.sampled_from(list(tools)))


def _add_places(
    draw: st.DrawFn, operators: dict[str, Any], tasks: dict[str, Any], step: float
) -> dict[str, Any]:
    """Where tasks are done: seconds between two places, or a speed between three."""
    spots = {"bench": (0, 0), "press": (3, 4), "shelf": (-1.5, 2)}
    far = draw(st.booleans())
    names = list(spots)[: 3 if far else 2]
    for part in tasks.values():
        if draw(st.booleans()):
            part["place"] = draw(st.sampled_from(names))
    for part in operators.values():
        if draw(_seldom()):
            part["place"] = draw(st.sampled_from(names))
    used = {part.get("place") for part in (*tasks.values(), *operators.values())} - {None}
    if not far and used != {"bench", "press"}:
        return {}
    walk = {
        who: {"speed": draw(st.sampled_from((1.0, 2.5)))}
        if far
        else {
            key: draw(_seconds(step, 0, 4))
            for key in draw(st.sampled_from((("bench-press",), ("bench-press", "press-bench"))))
        }
        for who in draw(st.lists(st.sampled_from(list(operators)), unique=True, min_size=1))
    }
    return {"walk": walk, "places": spots if far else {}}


def _groups(task: dict[str, Any]) -> set[frozenset[str]]:
    return {frozenset((name,)) for name in task["time"]} | {
        frozenset(joint["operators"]) for joint in task["together"]
    }


@st.composite
def _pairs(draw: st.DrawFn, tasks: dict[str, dict[str, Any]]) -> list[tuple[str, str]]:
    fitting = [(a, b) for a, b in combinations(tasks, 2) if _groups(tasks[a]) & _groups(tasks[b])]
    return (
        draw(st.lists(st.sampled_from(fitting), max_size=1)) if fitting and draw(_seldom()) else []
    )


@st.composite
def _table(
    draw: st.DrawFn, tasks: dict[str, dict[str, Any]], operators: dict[str, Any]
) -> dict[str, float]:
    """Stress of every set of tasks that humans may do, not additive; a few sets are left out and so
    forbidden.
    """
    weights = {
        name: draw(st.integers(0, 6))
        for name, task in tasks.items()
        if any(operators[who]["kind"] == "human" for group in _groups(task) for who in group)
    }
    bend = draw(st.sampled_from((0.0, 0.5, 1.5)))
    sets = [chosen for size in range(len(weights) + 1) for chosen in combinations(weights, size)]
    missing = draw(st.lists(st.sampled_from(sets), max_size=2))
    return {
        ",".join(s): sum(weights[x] for x in s)
        + bend * max((weights[x] for x in s), default=0) * len(s)
        for s in sets
        if s not in missing or s == sets[-1]
    }


def _add_waits(
    draw: st.DrawFn, names: list[str], tasks: dict[str, dict[str, Any]], step: float
) -> None:
    """One or two waits after earlier tasks, each after another one."""
    later = draw(st.lists(st.sampled_from(names[1:]), unique=True, min_size=1, max_size=2))
    for name in later:
        wait: dict[str, Any] = {
            "after": draw(st.sampled_from(names[: names.index(name)])),
            "between": draw(st.sampled_from(("end-start", "start-start"))),
            "at_least": draw(_seconds(step, 0, 6)),
        }
        if draw(_seldom()):
            wait["at_most"] = round(wait["at_least"] + draw(_seconds(step, 0, 9)), 6)
        tasks[name]["wait"] = [wait]


def _with_deadlines(draw: st.DrawFn, data: dict[str, Any], step: float) -> Cell:
    """The cell with one or two deadlines, or without when not even a chain of quickest tasks could
    keep them.
    """
    chosen = draw(
        st.lists(st.sampled_from(list(data["tasks"])), unique=True, min_size=1, max_size=2)
    )
    late = {name: draw(_seconds(step, 2, 30)) for name in chosen}
    tasks = {
        name: {**task, "deadline": late[name]} if name in late else task
        for name, task in data["tasks"].items()
    }
    try:
        return Cell.model_validate({**data, "tasks": tasks})
    except CellError:
        return Cell.model_validate(data)
