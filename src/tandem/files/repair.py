"""A stand-in for what is not well formed, so that all else can be judged in the same breath.

Nobody ever sees the repaired cell. Each stand-in is the most harmless value there is: a time of one
second, room for everyone, no deadline. So whatever is then found wrong with the fit of the parts is
wrong with what the user wrote.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tandem.files.messages import Flaw

Path = tuple[str | int, ...]

_GONE = object()
ROOM = 10_000


@dataclass
class Repaired:
    """The mended values, and what must be known to blame the right place.

    Attributes:
      moved: path of a list that lost entries -> the places that the others had before.
      roomless: whether what a zone or tool holds is unknown.
    """

    data: dict[str, Any]
    moved: dict[Path, list[int]]
    roomless: bool

    def original(self, path: Path) -> Path:
        """Where a value of the mended data stood in the user's."""
        back: list[str | int] = []
        for step in path:
            kept = self.moved.get(tuple(back))
            back.append(
                kept[step]
                if kept is not None and isinstance(step, int) and step < len(kept)
                else step
            )
        return tuple(back)


def repaired(data: Mapping[str, Any], flaws: list[Flaw]) -> Repaired | None:
    """The data with a harmless value in place of each flaw; None when too little is left to
    judge.
    """
    copy = _copy(data)
    if not isinstance(copy, dict) or not isinstance(copy.get("tasks"), dict) or not copy["tasks"]:
        return None
    for task in copy["tasks"].values():
        for key in ("wait", "ergonomics"):
            if isinstance(task, dict) and isinstance(task.get(key), dict):
                task[key] = [task[key]]
    open_tasks: set[str] = set()
    roomless = False
    for flaw in flaws:
        path, value = _stand_in(flaw)
        if path[:1] == ("tasks",) and len(path) >= 2 and _may_be_a_way(flaw):
            open_tasks.add(str(path[1]))
        roomless |= path in (("zones",), ("tools",)) or (
            flaw.kind == "extra_forbidden" and len(path) == 1
        )
        if path[2:] == ("kind",) and _holds(copy["operators"][path[1]]):
            value = "machine"  # nobody else could hold a part
        _put(copy, path, value)
    moved: dict[Path, list[int]] = {}
    _sweep(copy, (), moved)
    if not copy.get("tasks"):
        return None
    if not isinstance(copy.get("operators"), dict) or not copy["operators"]:
        copy["operators"] = {who: {"kind": "human"} for who in _named(copy) or ["somebody"]}
    for name in open_tasks & copy["tasks"].keys():
        times = copy["tasks"][name].setdefault("time", {})
        for who in copy["operators"]:
            times.setdefault(who, 1)
    return Repaired(copy, moved, roomless)


def _stand_in(flaw: Flaw) -> tuple[Path, Any]:
    """Which value to replace, and by what."""
    path = flaw.path
    if flaw.kind in ("key", "comma", "extra_forbidden"):
        return path, _GONE
    if path[0] in ("places", "walk", "stress_of_set"):
        return _in_a_table(path)
    match path:
        case ("operators", name):
            return path, {"kind": "human"}
        case ("operators", name, "kind"):
            return path, "human"
        case (
            ("operators", _, "breaks" | "holds", _, *_)
            | ("tasks", _, "wait" | "ergonomics", _, *_)
            | ("zones", _, "apart", *_)
        ):
            return path[: 3 if path[2] == "apart" else 4], _GONE
        case ("tasks", _):
            return path, {}
        case ("tasks", _, "time", _) | ("tasks", _, "together", _, "time"):
            return path, 1
        case ("tasks", name, "together", way, *rest) if rest[:1] not in (["stress"], ["tool"]):
            return ("tasks", name, "together", way), _GONE
        case ("zones" | "tools", _):
            return path, {"capacity": ROOM}
        case ("zones" | "tools", _, "capacity"):
            return path, ROOM
        case ("same_operator", pair, *_):
            return ("same_operator", pair), _GONE
    return path, _GONE


def _in_a_table(path: Path) -> tuple[Path, Any]:
    """Nothing is far from anything, and no set of tasks is hard."""
    match path:
        case ("places", name, *_):
            return ("places", name), [0.0, 0.0]
        case ("stress_of_set", _):
            return path, 0
    return (path[0],), _GONE


def _holds(operator: Any) -> bool:
    return isinstance(operator, dict) and "holds" in operator


def _may_be_a_way(flaw: Flaw) -> bool:
    """Whether what is taken out could have said who can do the task."""
    match flaw.path:
        case (_, _):
            return flaw.kind != "key"
        case (
            (_, _, "time")
            | (_, _, "together")
            | (_, _, "together", _)
            | (_, _, "together", _, "operators", *_)
        ):
            return True
        case (_, _, "time", _):
            return flaw.kind == "key"
        case (_, _, _):
            return flaw.kind == "extra_forbidden" and flaw.meant in ("time", "together", None)
    return False


def _copy(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _copy(item) for key, item in value.items()}
    return [_copy(item) for item in value] if isinstance(value, list | tuple) else value


def _put(data: Any, path: Path, value: Any) -> None:
    for step in path[:-1]:
        if isinstance(data, dict) and str(step) in data:
            data = data[str(step)]
        elif isinstance(data, list) and isinstance(step, int) and step < len(data):
            data = data[step]
        else:
            return
    last = path[-1]
    if isinstance(data, dict):
        data[str(last)] = value
    elif isinstance(data, list) and isinstance(last, int) and last < len(data):
        data[last] = value


def _sweep(value: Any, path: Path, moved: dict[Path, list[int]]) -> None:
    """Takes out what is gone; lists remember which entries are left. Paths are those of the user's
    data.
    """
    if isinstance(value, dict):
        for key in [key for key, item in value.items() if item is _GONE]:
            del value[key]
        for key, item in value.items():
            _sweep(item, (*path, key), moved)
    elif isinstance(value, list):
        for place, item in enumerate(value):
            _sweep(item, (*path, place), moved)
        kept = [place for place, item in enumerate(value) if item is not _GONE]
        if len(kept) < len(value):
            moved[path] = kept
            value[:] = [value[place] for place in kept]


def _named(data: dict[str, Any]) -> list[str]:
    names: dict[str, None] = {}
    for task in data["tasks"].values():
        if isinstance(task, dict):
            names.update(dict.fromkeys(task.get("time") or {}))
            for joint in task.get("together") or []:
                names.update(dict.fromkeys(map(str, joint.get("operators") or [])))
    return list(names)
