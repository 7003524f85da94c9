"""A cell as a Choco model: a second engine, which shares nothing with CP-SAT or with Tandem's own
reading of a cell.

Written from docs/cell-file.md for cells in whole seconds with `time`, `together`, `stress`,
`after`, `release`, `deadline`, `stress_limit`, `zone` with `zones`, and `tool` with `tools` that
take no changeover. Anything else is refused, so that nothing is left out in silence.

Choco (Prud'homme, Fages, Lorca 2022, Journal of Open Source Software 7(78), 4708) runs natively
here, by `pychoco`; no Java is needed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from pychoco import Model

KEYS = {"name", "format", "operators", "tasks", "zones", "tools"}
OPERATOR_KEYS = {"kind", "stress_limit"}
TASK_KEYS = {
    "time", "stress", "after", "together", "release", "deadline", "zone", "tool"
}  # fmt: skip


class Way(NamedTuple):
    """One way of doing a task: by whom, for so many seconds, at this stress on each human."""

    operators: frozenset[str]
    seconds: int
    stress: Mapping[str, int]


def ways(cell: Mapping[str, Any], task: Mapping[str, Any]) -> list[Way]:
    """Everybody who can do the task alone, and every group that can do it together."""
    humans = {name for name, about in cell["operators"].items() if about["kind"] == "human"}

    def loads(who: Iterable[str], stress: Any) -> dict[str, int]:
        each = stress if isinstance(stress, Mapping) else dict.fromkeys(who, stress)
        return {name: each.get(name, 0) for name in who if name in humans}

    own = task.get("stress", 0)
    alone = [
        Way(frozenset([who]), seconds, loads([who], own))
        for who, seconds in task.get("time", {}).items()
    ]
    groups = [
        Way(
            frozenset(way["operators"]),
            way["time"],
            loads(way["operators"], way.get("stress", own)),
        )
        for way in task.get("together", ())
    ]
    return [*alone, *groups]


class Question:
    """Is there a schedule that ends by `makespan` and has at most `stress`?

    Args:
      allocation: task -> operators who do it, where that is given; all others are free.
    """

    def __init__(
        self,
        cell: Mapping[str, Any],
        makespan: int,
        stress: int | None = None,
        allocation: Mapping[str, Iterable[str]] | None = None,
    ) -> None:
        _check(cell)
        self.cell, self.model, self.makespan = cell, Model(), makespan
        self.ways = {name: ways(cell, task) for name, task in cell["tasks"].items()}
        self.possible = True
        self.start: dict[str, Any] = {}
        self.end: dict[str, Any] = {}
        self.chosen: dict[str, list[Any]] = {}
        self.takes: dict[str, Any] = {}
        for name, task in cell["tasks"].items():
            self._decide(name, task)
        if not self.possible:
            return
        for rule in (_precedence, _one_at_a_time, _places, _work_fits, _loads):
            rule(self)
        if stress is not None:
            self._at_most(stress, lambda way: sum(way.stress.values()))
        for name, who in (allocation or {}).items():
            for way, literal in zip(self.ways[name], self.chosen[name], strict=True):
                self.model.arithm(literal, "=", int(way.operators == frozenset(who))).post()

    def _decide(self, name: str, task: Mapping[str, Any]) -> None:
        seconds = [way.seconds for way in self.ways[name]]
        first, last = (
            task.get("release", 0),
            min(task.get("deadline", self.makespan), self.makespan),
        )
        if first + min(seconds) > last:
            self.possible = False
            return
        model = self.model
        self.start[name] = model.intvar(first, last - min(seconds), f"start {name}")
        self.end[name] = model.intvar(first + min(seconds), last, f"end {name}")
        self.chosen[name] = [model.boolvar(name=f"{name} {way}") for way in range(len(seconds))]
        model.sum(self.chosen[name], "=", 1).post()
        takes = model.intvar(sorted({*seconds}), name=f"seconds {name}")
        model.scalar(self.chosen[name], seconds, "=", takes).post()
        model.arithm(self.start[name], "+", takes, "=", self.end[name]).post()
        self.takes[name] = takes

    def _at_most(self, limit: int, worth: Any) -> None:
        """The chosen ways are worth at most so much."""
        literals = [x for row in self.chosen.values() for x in row]
        worths = [worth(way) for row in self.ways.values() for way in row]
        if any(worths):
            self.model.scalar(literals, worths, "<=", limit).post()
        elif limit < 0:
            self.possible = False

    def answer(self, *, nodes: int, seconds: int) -> bool | None:
        """Whether there is one; None when the limits on the search were too small to tell."""
        if not self.possible:
            return False
        solver = self.model.get_solver()
        literals = [x for row in self.chosen.values() for x in row if len(row) > 1]
        solver.set_conflict_history_search(*literals, *self.start.values())
        # (its search by weighted degrees prints every variable that it is given)
        found = solver.find_solution(time_limit=f"{seconds}s", node_limit=nodes)
        if found is not None:
            return True
        return False if str(solver.get_search_state()).endswith("TERMINATED") else None


def _check(cell: Mapping[str, Any]) -> None:
    unknown = set(cell) - KEYS
    unknown |= {key for about in cell["operators"].values() for key in about} - OPERATOR_KEYS
    unknown |= {key for task in cell["tasks"].values() for key in task} - TASK_KEYS
    unknown |= {key for tool in cell.get("tools", {}).values() for key in tool} - {"capacity"}
    unknown |= {key for zone in cell.get("zones", {}).values() for key in zone} - {"capacity"}
    if unknown:
        raise ValueError(f"the second engine knows nothing of {sorted(unknown)}.")


def _precedence(asked: Question) -> None:
    for name, task in asked.cell["tasks"].items():
        for before in task.get("after", ()):
            asked.model.arithm(asked.end[before], "<=", asked.start[name]).post()


def _one_at_a_time(asked: Question) -> None:
    for operator in asked.cell["operators"]:
        _room(
            asked, {name: lambda way, o=operator: int(o in way.operators) for name in asked.ways}, 1
        )


def _places(asked: Question) -> None:
    """A place in the zone, and a tool, for every operator who does the task."""
    for key, room in (("zone", "zones"), ("tool", "tools")):
        for thing in {task[key] for task in asked.cell["tasks"].values() if key in task}:
            capacity = asked.cell.get(room, {}).get(thing, {}).get("capacity", 1)
            users = [name for name, task in asked.cell["tasks"].items() if task.get(key) == thing]
            _room(asked, {name: lambda way: len(way.operators) for name in users}, capacity)


def _room(asked: Question, needs: Mapping[str, Any], capacity: int) -> None:
    """At no moment more than there is."""
    tasks, heights = [], []
    for name, need in needs.items():
        wants = [need(way) for way in asked.ways[name]]
        if not any(wants):
            continue
        height = asked.model.intvar(sorted({*wants}))
        asked.model.scalar(asked.chosen[name], wants, "=", height).post()
        # a task of its own for each rule: Choco ends the process where two rules share one
        tasks.append(asked.model.task(asked.start[name], asked.takes[name], asked.end[name]))
        heights.append(height)
    if tasks:
        asked.model.cumulative(tasks, heights, asked.model.intvar(capacity)).post()


def _work_fits(asked: Question) -> None:
    """What follows from the rules and shortens the search: nobody's work is more than the time."""
    for operator in asked.cell["operators"]:
        asked._at_most(
            asked.makespan, lambda way, o=operator: way.seconds if o in way.operators else 0
        )


def _loads(asked: Question) -> None:
    for operator, about in asked.cell["operators"].items():
        if "stress_limit" in about:
            asked._at_most(about["stress_limit"], lambda way, o=operator: way.stress.get(o, 0))
