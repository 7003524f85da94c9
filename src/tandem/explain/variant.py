"""What if: a cell with some values set, operators left out, and tasks forced to be done one way."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.cell.names import Known, clean
from tandem.cell.parts import Mode, Table, Task
from tandem.cell.walking import SPEED, pairs_of
from tandem.errors import UsageError
from tandem.files.validate import cell_of
from tandem.files.yaml_writer import flow
from tandem.schedule.measures import exact


def variant(
    cell: Cell, sets: Iterable[str] = (), without: Iterable[str] = (), force: Iterable[str] = ()
) -> Cell:
    """The cell as it would be.

    Args:
      sets: `PATH=VALUE` with the keys of a cell file joined by dots, such as
        "tasks.6.time.robot=8". A value of "none" takes the key out, "-10%" and "+10%" change the
        number that stands there. A key with dots is written in double quotes, or as it is when it
        exists.
      without: operators that are not there.
      force: `TASK=OPERATOR`, or `TASK=OPERATOR+OPERATOR` for a joint way: the task is done so and
        not otherwise.

    Raises:
      UsageError: what was asked for cannot be done to this cell; with everything that is wrong.
      CellError: the variant is not a sound cell.
    """
    data = cell.to_dict()
    wrong: list[str] = []
    for text in map(clean, sets):
        wrong += _set(data, text)
    for name in map(clean, without):
        if name not in data["operators"]:
            wrong.append(
                f"--without {name}: there is no such operator."
                f" {Known(data['operators']).hint(name)}"
            )
        else:
            _leave_out(data, name)
    if without and not wrong:
        _leave_out_sets(data)
    if wrong:
        raise UsageError("\n".join(wrong))
    changed = cell_of(data)
    choices: dict[str, Mode] = {}
    for text in map(clean, force):
        task, mode, complaint = _forced(changed, text)
        if complaint:
            wrong.append(complaint)
        elif mode is not None:
            choices[task] = mode
    if wrong:
        raise UsageError("\n".join(wrong))
    return force_modes(changed, choices)


def force_modes(cell: Cell, choices: Mapping[str, Mode]) -> Cell:
    """The cell in which each of these tasks has one way of being done, and tasks that need the same
    operators follow suit.

    Raises:
      CellError: the variant is not sound, as when a task that needs the same operators cannot be
        done by them.
    """
    tasks = dict(cell.tasks)
    for name, mode in choices.items():
        tasks[name] = _only(tasks[name], mode.operators)
        for partner in _bound_to(cell, name) - set(choices):
            tasks[partner] = _only(tasks[partner], mode.operators)
    if not choices:
        return cell
    return cell.replace(tasks=tasks, stress_of_set=_possible_sets(cell, tasks))


def _only(task: Task, operators: tuple[str, ...]) -> Task:
    """The task with the ways of just these operators."""
    time = {who: seconds for who, seconds in task.time.items() if operators == (who,)}
    return task.model_copy(
        update={
            "time": Table(time),
            "together": tuple(way for way in task.together if set(way.operators) == set(operators)),
        }
    )


def _bound_to(cell: Cell, name: str) -> set[str]:
    """Tasks that must be done by the same operators, directly or by way of others."""
    bound, grows = {name}, True
    while grows:
        more = {task for pair in cell.same_operator if bound & set(pair) for task in pair} - bound
        bound, grows = bound | more, bool(more)
    return bound - {name}


def _possible_sets(cell: Cell, tasks: Mapping[str, Task]) -> dict[str, float] | None:
    """The table of stress without the sets that name a task which no human can do any more."""
    if cell.stress_of_set is None:
        return None
    human = {
        name
        for name, task in tasks.items()
        if {*task.time, *(who for way in task.together for who in way.operators)} & set(cell.humans)
    }
    return {
        key: stress
        for key, stress in cell.stress_of_set.items()
        if set(filter(None, key.split(","))) <= human
    }


# --- set ------------------------------------------------------------------------------------------


def _set(data: dict[str, Any], text: str) -> list[str]:
    path, equals, value = text.partition("=")
    if not equals or not path.strip() or not value.strip():
        return [f"--set {text}: write PATH=VALUE, such as tasks.6.time.robot=8."]
    parent, key, complaint = _walk(data, _pieces(path.strip()))
    if complaint:
        return [f"--set {text}: {complaint}"]
    old = parent[key] if isinstance(parent, list) else parent.get(key)
    new, complaint = _value(value.strip(), old)
    if complaint:
        return [f"--set {text}: {complaint}"]
    if new is None and isinstance(parent, list):
        del parent[key]
    elif new is None:
        parent.pop(key, None)
    else:
        parent[key] = new
    return []


def _pieces(path: str) -> list[str]:
    return [
        clean(quoted or plain_key) for quoted, plain_key in re.findall(r'"([^"]*)"|([^.]+)', path)
    ]


def _walk(data: Any, pieces: list[str]) -> tuple[Any, Any, str]:
    """The table that holds the last key, the key, and what is wrong; a key with dots is found when
    it exists.
    """
    at, way = data, ""
    while True:
        if isinstance(at, list):
            if not pieces[0].isdecimal() or int(pieces[0]) >= len(at):
                return (
                    None,
                    None,
                    f"{way} has {len(at)} entries, counted from 0; {pieces[0]!r} is none of them.",
                )
            key: Any = int(pieces[0])
            taken = 1
        elif isinstance(at, Mapping):
            joined = [".".join(pieces[:count]) for count in range(len(pieces), 0, -1)]
            found = next((name for name in joined if name in at), None)
            key = found if found is not None else pieces[0]
            taken = joined[::-1].index(found) + 1 if found is not None else 1
        else:
            return None, None, f"{way} is {_written(at)} and has no {pieces[0]!r}."
        way = f"{way}.{key}" if way else str(key)
        pieces = pieces[taken:]
        if not pieces:
            return at, key, ""
        if isinstance(at, Mapping) and key not in at:
            if way.split(".")[0] in ("tasks", "operators") and way.count(".") == 1:
                kind = way.split(".")[0][:-1]
                return None, None, f"there is no {kind} {key!r}. {Known(at).hint(str(key))}"
            at[key] = {}  # type: ignore[index]
        at = at[key]


def _written(value: Any) -> str:
    """A value as the cell file has it."""
    return "nothing" if value is None else flow(plain(value), name=True)


def _value(text: str, old: Any) -> tuple[Any, str]:
    """The value that a text means; None for taking the key out."""
    if text.lower() in ("none", "null"):
        return None, ""
    if found := re.fullmatch(r"([-+−]\d+(?:\.\d+)?)\s*%", text):
        if not isinstance(old, int | float) or isinstance(old, bool):
            return None, f"{text} changes a number, but {_written(old)} stands there."
        share = exact(float(found[1].replace("−", "-"))) / 100 + 1
        return plain(float(round(exact(float(old)) * share, 6))), ""
    if re.fullmatch(r"[-+]?\d+", text):
        return int(text), ""
    if re.fullmatch(r"[-+]?(\d+\.\d*|\.\d+)", text):
        return float(text), ""
    if text.startswith("[") and text.endswith("]"):
        items = [_value(part.strip(), None)[0] for part in text[1:-1].split(",") if part.strip()]
        return items, ""
    return text.strip('"'), ""


# --- without --------------------------------------------------------------------------------------


def _leave_out(data: dict[str, Any], name: str) -> None:
    """Takes the operator out of everything that names it."""
    del data["operators"][name]
    for task in data["tasks"].values():
        task["together"] = [
            way for way in task.get("together", ()) if name not in map(str, way["operators"])
        ]
        for holder in (task, *task["together"]):
            for key in ("time", "stress", "difficulty", "spread", "tool"):
                if isinstance(holder.get(key), dict) and name in holder[key]:
                    del holder[key][name]
                    if not holder[key]:
                        del holder[key]
        if not task["together"]:
            del task["together"]
    for tool in data.get("tools", {}).values():
        if isinstance(tool.get("changeover"), dict):
            tool["changeover"].pop(name, None)
    data.get("cost", {}).get("operators", {}).pop(name, None)
    data.get("walk", {}).pop(name, None)
    _leave_out_ways(data)


def _leave_out_ways(data: dict[str, Any]) -> None:
    """Takes out the ways from and to places at which nobody and nothing is any more."""
    parts = [*data["tasks"].values(), *data["operators"].values()]
    known = {*data.get("places", {}), *(str(part["place"]) for part in parts if "place" in part)}
    for table in data.get("walk", {}).values():
        for key in [key for key in table if key != SPEED and not pairs_of(key, known)]:
            del table[key]


def _leave_out_sets(data: dict[str, Any]) -> None:
    """Takes out the sets of tasks that humans can no longer do."""
    humans = {
        name for name, operator in data["operators"].items() if operator.get("kind") == "human"
    }
    able = {
        name
        for name, task in data["tasks"].items()
        if humans
        & {
            *task.get("time", {}),
            *(str(who) for way in task.get("together", ()) for who in way["operators"]),
        }
    }
    if data.get("stress_of_set"):
        data["stress_of_set"] = {
            key: stress
            for key, stress in data["stress_of_set"].items()
            if set(filter(None, key.split(","))) <= able
        }


# --- force ----------------------------------------------------------------------------------------


def _forced(cell: Cell, text: str) -> tuple[str, Mode | None, str]:
    task, equals, who = text.rpartition("=")
    task = task.strip()
    if not equals or not task or not who.strip():
        return (
            task,
            None,
            (
                f"--force {text}: write TASK=OPERATOR, such as 5=human, or 5=human+robot for a"
                " joint way."
            ),
        )
    if task not in cell.tasks:
        return (
            task,
            None,
            f"--force {text}: there is no task {task!r}. {Known(cell.tasks).hint(task)}",
        )
    names = (
        [who.strip()]
        if who.strip() in cell.operators
        else [name.strip() for name in who.split("+")]
    )
    unknown = [name for name in names if name not in cell.operators]
    if unknown:
        return (
            task,
            None,
            (
                f"--force {text}: there is no operator {unknown[0]!r}."
                f" {Known(cell.operators).hint(unknown[0])}"
            ),
        )
    mode = next((mode for mode in cell.modes(task) if set(mode.operators) == set(names)), None)
    if mode is None:
        ways = ", ".join(spelled(way) for way in cell.modes(task))
        return (
            task,
            None,
            f"--force {text}: {'+'.join(names)} cannot do task {task!r}. It can be done by {ways}.",
        )
    return task, mode, ""


def spelled(mode: Mode) -> str:
    """Who takes part, as `--force` and sentences write it: "human", "human + robot"."""
    return " + ".join(mode.operators)


def ways_not_taken(cell: Cell, task: str, operators: tuple[str, ...]) -> Iterator[Mode]:
    """Every other way of doing the task than by these operators."""
    return (mode for mode in cell.modes(task) if set(mode.operators) != set(operators))
