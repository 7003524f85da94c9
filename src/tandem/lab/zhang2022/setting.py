"""The cell as two agents share it, and what is counted, as data.

Axes: 2 agents, row 0 the robot and row 1 the human; `T` tasks, `W` ways and `U` tools as in
`world/arrays.py`; `K` choices of an agent, 0 is waiting; `G` abilities of the robot.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.errors import CellError, Fault, UsageError
from tandem.lab.refusal import enumerated_crew
from tandem.world.arrays import Array, Arrays, Names

ROBOT, HUMAN = 0, 1
AGENTS = ("robot_0", "human_0")

LIGHT, HEAVY = 0.04, 0.15
"""Fatigue per minute of the lightest and the hardest work: the range of Xue et al.'s raw rates for
handling and placing. Their unit of time is not stated; the minute is an ASSUMPTION.
"""
RECOVERY = 0.05
"""Recovery per minute of rest, Xue et al.'s raw rate. ASSUMPTION: the minute."""


class Duo(NamedTuple):
    """One cell.

    arrays: the event world's.
    row: `[2]` int32, the operators of robot and human among the cell's.
    pick: `[2, K, W]` bool, the way that an agent's choice means; no way for choice 0.
    joint: `[W]` bool, both take part. of_tool: `[T, U]` bool, the tool that the task needs.
    clash: `[W, W]` bool, the two ways cannot begin at one moment: the same task, or no room for
    both at a tool or in a zone. difficulty: `[W, 2]` float32, for each agent who takes part.
    tiring: `[W]` float32, the human's fatigue per second of it. ability: `[G, W]` bool, ways that
    the robot loses together: those with one tool, or of one task without a tool. tick: `[]`
    float32, seconds. work: `[]` float32, seconds of work in all, each task in its quickest way,
    shared by two.
    """

    arrays: Arrays
    row: Array
    pick: Array
    joint: Array
    of_tool: Array
    clash: Array
    difficulty: Array
    tiring: Array
    ability: Array
    tick: Array
    work: Array


class Setting(NamedTuple):
    """What counts, and what may happen; numbers, so that a batch of them can be mapped over. Made
    by `setting(...)`.

    time, difficulty, fatigue: the cost of a second, of a unit of difficulty, and of a second at
    full fatigue. unit: the cost that is paid as a reward of -1. tires, rests: factors on the
    human's rates of fatigue and recovery. slows: how much longer the human takes at full fatigue,
    as a share. spread: coefficient of variation of the human's real times (log-normal of mean 1).
    change: probability that something unforeseen happens. early, late: when, as a share of
    `Duo.work`. search: seconds until a tool that went missing is back.
    """

    time: Array
    difficulty: Array
    fatigue: Array
    unit: Array
    tires: Array
    rests: Array
    slows: Array
    spread: Array
    change: Array
    early: Array
    late: Array
    search: Array


def setting(
    *,
    time: float = 1.0,
    difficulty: float = 1.0,
    fatigue: float = 0.0,
    unit: float = 10.0,
    tires: float = 1.0,
    rests: float = 1.0,
    slows: float = 0.0,
    spread: float = 0.0,
    change: float = 0.0,
    early: float = 0.1,
    late: float = 0.9,
    search: float = 30.0,
) -> Setting:
    """The numbers of a `Setting`, checked. All are ASSUMPTIONS: those of Zhang et al. (2022) are
    not public.

    Raises UsageError with everything that is out of range.
    """
    given = dict(locals())
    faults = [
        f"{name} {value}: must be a number, 0 or more."
        for name, value in given.items()
        if not (math.isfinite(value) and value >= 0)
    ]
    faults += [
        f"{name} {given[name]}: must be more than 0." for name in ("unit",) if given[name] == 0
    ]
    if change > 1:
        faults.append(f"change {change}: is a probability, at most 1.")
    if not early <= late:
        faults.append(f"early {early}, late {late}: the first must not be the larger one.")
    if time == difficulty == 0:
        faults.append("time and difficulty: one of them must cost something.")
    if faults:
        raise UsageError(
            "The setting does not hold:\n" + "\n".join(f"- {fault}" for fault in faults)
        )
    return Setting(**{name: np.float32(value) for name, value in given.items()})


def duo(cell: Cell) -> tuple[Duo, Names]:
    """The cell as the two agents share it, and the names that lead back.

    Raises:
      CellError: with everything that cannot be expressed.
    """
    if faults := [fault for rule in RULES for fault in rule(cell)]:
        raise CellError(faults)
    names = Names.of(cell, per_second=None)
    arrays = names.arrays()
    row = [names.operators.index(cell.robots[0]), names.operators.index(cell.humans[0])]
    uses = arrays.way_uses[:, row]
    own = [np.flatnonzero(uses[:, agent] & arrays.way_open) for agent in (ROBOT, HUMAN)]
    pick = np.zeros((2, 1 + max(map(len, own)), len(uses)), bool)
    for agent, ways in enumerate(own):
        pick[agent, 1 + np.arange(len(ways)), ways] = True
    hard = np.array(
        [
            [difficulty_of(cell, task, mode).get(names.operators[who], 0.0) for who in row]
            for task, mode in names.ways
        ]
    )
    return (
        Duo(
            arrays=arrays,
            row=np.array(row, np.int32),
            pick=pick,
            joint=uses.all(1),
            of_tool=_of_tool(cell, names)[:, : arrays.tool_places.shape[0]],
            clash=_clashes(cell, names),
            difficulty=hard.astype(np.float32),
            tiring=_tiring(hard[:, HUMAN], uses[:, HUMAN]),
            ability=_abilities(cell, names, uses[:, ROBOT]),
            tick=np.float32(1 / names.per_second),
            work=np.float32(
                sum(
                    min(mode.time * len(mode.operators) for mode in cell.modes(task))
                    for task in cell.tasks
                )
                / 2
            ),
        ),
        names,
    )


def difficulty_of(cell: Cell, task: str, mode: Mode) -> Mapping[str, float]:
    """Operator -> how hard this way of doing the task is for them. In a cell that states no
    difficulty at all, the stress on the human is it.
    """
    if any(one.difficulty for one in cell.tasks.values()):
        return {who: cell.tasks[task].difficulty.get(who, 0.0) for who in mode.operators}
    return {who: mode.stress.get(who, 0.0) for who in mode.operators}


def tool_of(cell: Cell, task: str) -> str | None:
    """The tool of a task; one for all who do it."""
    tool = cell.tasks[task].tool
    assert not isinstance(tool, Mapping), "_one_tool_a_task lets no table pass"
    return tool


def _of_tool(cell: Cell, names: Names) -> Array:
    """A tool that can never be short, and that nobody takes time to take up, is none here."""
    instance, needs = names.instance, [tool_of(cell, task) for task in cell.tasks]
    matters = [
        name if instance.has_swaps or room else ""
        for name, room in zip(names.tools, instance.tool_room, strict=True)
    ]
    return np.array([[need == tool for tool in matters] for need in needs], bool).reshape(
        len(needs), len(matters)
    )


def _clashes(cell: Cell, names: Names) -> Array:
    """Both operators are free when they begin at one moment, so all places are: what does not fit
    then never does.
    """
    tasks = [name for name, _ in names.ways]
    places = (
        {name: tool.capacity for name, tool in cell.tools.items()},
        {name: zone.capacity for name, zone in cell.zones.items()},
    )
    partners = {frozenset(pair) for pair in cell.same_operator}

    def clash(one: str, other: str) -> bool:
        a, b = cell.tasks[one], cell.tasks[other]
        crowded = [
            mine is not None and mine == yours and room.get(mine, 1) < 2
            for mine, yours, room in (
                (tool_of(cell, one), tool_of(cell, other), places[0]),
                (a.zone, b.zone, places[1]),
            )
        ]
        return one == other or any(crowded) or frozenset((one, other)) in partners

    return np.array([[clash(one, other) for other in tasks] for one in tasks])


def _tiring(difficulty: Any, human: Any) -> Array:
    """Between `LIGHT` and `HEAVY` by the human's difficulty. ASSUMPTION."""
    hardest = max(float(difficulty.max()), 1e-9)
    return np.where(human, (LIGHT + (HEAVY - LIGHT) * difficulty / hardest) / 60, 0).astype(
        np.float32
    )


def _abilities(cell: Cell, names: Names, robot: Any) -> Array:
    by = [tool_of(cell, task) or f"task {task}" for task, _ in names.ways]
    groups = [
        [mine == group and uses for mine, uses in zip(by, robot, strict=True)]
        for group in dict.fromkeys(by)
    ]
    return np.array([group for group in groups if any(group)], bool).reshape(-1, len(by))


def _one_robot_and_one_human(cell: Cell) -> Iterator[Fault]:
    if len(cell.robots) != 1 or len(cell.humans) != 1 or cell.machines:
        yield Fault(
            f"the cell has {enumerated_crew(cell)}; two agents work side by side here, one"
            " robot and one human.",
            ("operators",),
        )


def _only_what_it_knows(cell: Cell) -> Iterator[Fault]:
    if cell.stress_of_set is not None:
        yield Fault(
            "stress_of_set says which sets of tasks the human may do; these two agents know no such"
            " list. Leave it out.",
            ("stress_of_set",),
        )
    for name, operator in cell.operators.items():
        stated = {"stress_limit": operator.stress_limit is not None, "limits": operator.limits}
        for key in (key for key, is_stated in stated.items() if is_stated):
            yield Fault(
                f"a {key.removesuffix('s')} may leave nobody for a task; these two agents count"
                " difficulty and know no limit. Leave it out.",
                ("operators", name, key),
            )
    if cell.walk:
        yield Fault(
            "the two agents have all at hand and know no ways to walk. Leave walk out.", ("walk",)
        )
    for name, zone in cell.zones.items():
        if zone.apart:
            yield Fault(
                "these two agents know no zone that keeps kinds apart; leave `apart` out.",
                ("zones", name, "apart"),
            )
    for name, task in cell.tasks.items():
        if task.deadline is not None:
            yield Fault(
                "the two agents may be late and are not told; leave the deadline out.",
                ("tasks", name, "deadline"),
            )
        if task.wait:
            yield Fault(
                "the two agents are not told how long something has cured or cooled; leave the wait"
                " out.",
                ("tasks", name, "wait"),
            )


def _one_tool_a_task(cell: Cell) -> Iterator[Fault]:
    for name, task in cell.tasks.items():
        if isinstance(task.tool, Mapping) or any(joint.tool is not None for joint in task.together):
            yield Fault(
                "a task has one tool here, whoever does it; these two agents know no tools per"
                " operator or group. Name one tool, or leave it out.",
                ("tasks", name, "tool"),
            )


RULES: tuple[Callable[[Cell], Iterator[Fault]], ...] = (
    _one_robot_and_one_human,
    _only_what_it_knows,
    _one_tool_a_task,
)
