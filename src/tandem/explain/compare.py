"""What changed between two cells, or between two schedules: task by task."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.explain.language import Words, words
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
        return self.sentence()

    def sentence(self, language: str = "en") -> str:
        """What it is now instead of what."""
        return _sentence(self, words(language))

    def to_dict(self, language: str = "en") -> dict[str, Any]:
        return {
            "path": list(self.path),
            "before": self.before,
            "after": self.after,
            "sentence": self.sentence(language),
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


def _sentence(change: Change, t: Words) -> str:
    path, before, after = change.path, change.before, change.after
    match path:
        case ("tasks" | "operators" | "tools" | "zones" as room, name):
            what = "new" if before is None else "gone" if after is None else "other"
            said = t(f"cells.{what}", what=t(f"cells.{room}", name=name))
            return said + (f" ({_ways(after, t)})" if room == "tasks" and after else "")
        case ("tasks", name, "time", who):
            values = {"name": name, "who": who}
            if after is None:
                return t("cells.no_longer", **values, before=t.seconds(before))
            if before is None:
                return t("cells.can", **values, after=t.seconds(after))
            return t("cells.takes", **values, after=t.seconds(after), before=t.seconds(before))
        case ("tasks", name, "after"):
            said = _list_change("cells.waits", before or [], after or [], t)
            return t("cells.waits", name=name, said=said)
        case ("tasks", name, "together"):
            if not before or not after:
                new = "new" if after else "gone"
                return t(f"cells.joint.{new}", name=name, ways=_joint(after or before, t))
            return t("cells.joint", name=name, after=_joint(after, t), before=_joint(before, t))
    where = ".".join(path)
    if path[0] in ("tasks", "operators", "tools", "zones") and len(path) > 2:
        what = t(f"cells.{path[0]}", name=path[1])
        where = t("cells.key", what=what, keys=t("cells.of").join(path[2:]))
    return t("cells.value", where=where, after=_shown(after, t), before=_shown(before, t))


def _ways(task: Mapping[str, Any], t: Words) -> str:
    times = [f"{who} {t.seconds(seconds)}" for who, seconds in task.get("time", {}).items()]
    joint = [
        f"{' + '.join(map(str, way['operators']))} {t.seconds(way['time'])}"
        for way in task.get("together", ())
    ]
    return ", ".join([*times, *joint])


def _list_change(key: str, before: list[Any], after: list[Any], t: Words) -> str:
    more = [str(name) for name in after if name not in before]
    less = [str(name) for name in before if name not in after]
    said = [
        t(f"{key}.{kind}", names=", ".join(names))
        for kind, names in (("more", more), ("less", less))
        if names
    ]
    if len(said) > 1:
        return t("and", first=said[0], last=said[1])
    return said[0] if said else t(f"{key}.order")


def _joint(ways: list[Mapping[str, Any]] | None, t: Words) -> str:
    """Joint ways in words: "anna + cobot in 12 s, stress 3"."""
    said = ""
    for way in ways or ():
        values = {
            "who": " + ".join(map(str, way["operators"])),
            "seconds": t.seconds(way["time"]),
        }
        load = way.get("stress")
        one = (
            t("cells.way", **values)
            if load is None
            else t("cells.way.stress", **values, stress=_shown(load, t))
        )
        said = t("cells.ways", first=said, last=one) if said else one
    return said


def _shown(value: Any, t: Words) -> str:
    """A value as the cell file has it; text in quotes."""
    if isinstance(value, str):
        return repr(value)
    return t("cells.nothing") if value is None else flow(plain(value), name=True)


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
        return self.sentence()

    def sentence(self, language: str = "en") -> str:
        """Who did it when, and who does it when now."""
        t = words(language)
        who, span = [], []
        for row in filter(None, (self.before, self.after)):
            who.append(" + ".join(row.operators))
            span.append(t("span", start=t.number(row.start), end=t.number(row.end)))
        if len(who) == 1:
            when = "before" if self.after is None else "after"
            return t(f"move.{when}", task=self.task, who=who[0], span=span[0])
        by = " -> ".join(who) if self.other_operators else who[1]
        return t("move.moved", task=self.task, who=by, before=span[0], after=span[1])

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
