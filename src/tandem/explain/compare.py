"""What changed between two cells, or between two schedules: task by task."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.cell.written import number
from tandem.files.yaml_writer import flow
from tandem.schedule.measures import exact
from tandem.schedule.model import Assignment, Schedule


@dataclass(frozen=True)
class Change:
    """One thing that differs.

    Attributes:
      path: keys from the top of the cell file, such as `("tasks", "6", "time", "robot")`.
      before, after: the values; None where there is none.
    """

    path: tuple[str, ...]
    before: Any
    after: Any

    def __str__(self) -> str:
        return _sentence(self)

    def to_dict(self) -> dict[str, Any]:
        return {
            "path": list(self.path),
            "before": self.before,
            "after": self.after,
            "sentence": str(self),
        }


def compare_cells(before: Cell, after: Cell) -> tuple[Change, ...]:
    """Every key whose value differs, in the order of the cell file; a list counts as one value."""
    return tuple(_differences((), before.to_dict(), after.to_dict()))


def _differences(path: tuple[str, ...], before: Any, after: Any) -> Iterator[Change]:
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        for key in dict.fromkeys([*before, *after]):
            yield from _differences((*path, str(key)), before.get(key), after.get(key))
    elif before != after:
        yield Change(path, before, after)


def _sentence(change: Change) -> str:
    path, before, after = change.path, change.before, change.after
    match path:
        case ("tasks" | "operators" | "tools" | "zones" as room, name):
            what = "new" if before is None else "gone" if after is None else "other"
            return f"{room[:-1]} {name}: {what}" + (
                f" ({_ways(after)})" if room == "tasks" and after else ""
            )
        case ("tasks", name, "time", who):
            if after is None:
                return f"task {name}: {who} can no longer do it (took {number(before)} s)"
            return (
                f"task {name}: {who} can do it now, in {number(after)} s"
                if before is None
                else f"task {name}: {who} takes {number(after)} s instead of {number(before)} s"
            )
        case ("tasks", name, "after"):
            return f"task {name}: {_list_change('waits for', before or [], after or [])}"
        case ("tasks", name, "together"):
            if not before or not after:
                can = (
                    "can be done together now, by"
                    if after
                    else "can no longer be done together, as by"
                )
                return f"task {name}: {can} {_joint(after or before)}"
            return f"task {name}: done together by {_joint(after)} instead of {_joint(before)}"
    where = (
        f"{path[0][:-1]} {path[1]}: {' of '.join(path[2:])}"
        if path[0] in ("tasks", "operators", "tools", "zones") and len(path) > 2
        else ".".join(path)
    )
    return f"{where} is {_shown(after)} instead of {_shown(before)}"


def _ways(task: Mapping[str, Any]) -> str:
    times = [f"{who} {number(seconds)} s" for who, seconds in task.get("time", {}).items()]
    return ", ".join(
        [
            *times,
            *(
                f"{' + '.join(map(str, way['operators']))} {number(way['time'])} s"
                for way in task.get("together", ())
            ),
        ]
    )


def _list_change(verb: str, before: list[Any], after: list[Any]) -> str:
    more = [str(name) for name in after if name not in before]
    less = [str(name) for name in before if name not in after]
    said = [f"now {verb} {', '.join(more)}"] if more else []
    said += [f"no longer {verb} {', '.join(less)}"] if less else []
    return " and ".join(said) or f"{verb} the same in another order"


def _joint(ways: list[Mapping[str, Any]] | None) -> str:
    """Joint ways in words: "anna + cobot in 12 s, stress 3"."""
    said = []
    for way in ways or ():
        load = way.get("stress")
        stress = "" if load is None else f", stress {_shown(load)}"
        said.append(f"{' + '.join(map(str, way['operators']))} in {number(way['time'])} s{stress}")
    return " or ".join(said)


def _shown(value: Any) -> str:
    """A value as the cell file has it; text in quotes."""
    if isinstance(value, str):
        return repr(value)
    return "nothing" if value is None else flow(plain(value), name=True)


# --- schedules ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Move:
    """One task in two schedules; None where it does not stand in one of them."""

    task: str
    before: Assignment | None
    after: Assignment | None

    @property
    def other_operators(self) -> bool:
        """Somebody else does it."""
        return (
            self.before is not None
            and self.after is not None
            and set(self.before.operators) != set(self.after.operators)
        )

    @property
    def later(self) -> float | None:
        """Seconds by which it starts later; negative for earlier."""
        return (
            None
            if self.before is None or self.after is None
            else float(exact(self.after.start) - exact(self.before.start))
        )

    @property
    def changed(self) -> bool:
        """Anything differs: who, start or end."""
        if self.before is None or self.after is None:
            return True
        return self.other_operators or (self.before.start, self.before.end) != (
            self.after.start,
            self.after.end,
        )

    def __str__(self) -> str:
        if self.before is None or self.after is None:
            row = self.before or self.after
            assert row is not None
            when = "only before" if self.after is None else "only after"
            return (
                f"task {self.task}: {when}, {' + '.join(row.operators)}, {number(row.start)} to"
                f" {number(row.end)} s"
            )
        who = (
            f"{' + '.join(self.before.operators)} -> {' + '.join(self.after.operators)}, "
            if self.other_operators
            else ""
        )
        return (
            f"task {self.task}:"
            f" {who or ' + '.join(self.after.operators) + ', '}{number(self.before.start)} to"
            f" {number(self.before.end)} s -> {number(self.after.start)} to"
            f" {number(self.after.end)} s"
        )

    def to_dict(self) -> dict[str, Any]:
        return {
            "task": self.task,
            "before": _row(self.before),
            "after": _row(self.after),
            "other_operators": self.other_operators,
            "later": plain(self.later),
            "changed": self.changed,
        }


def compare_schedules(before: Schedule, after: Schedule) -> tuple[Move, ...]:
    """Every task of the two, in order of its start before; tasks that are only in the second come
    last.
    """
    first, second = ({a.task: a for a in schedule} for schedule in (before, after))
    return tuple(
        Move(task, first.get(task), second.get(task)) for task in dict.fromkeys([*first, *second])
    )


def _row(a: Assignment | None) -> dict[str, Any] | None:
    return None if a is None else Schedule((a,)).to_list()[0]
