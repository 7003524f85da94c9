"""What the parts of a cell must be to each other: one rule a function, every fault reported.

A rule reads the whole cell and leaves to the others what is theirs: an unknown name is met by the
rule for names, and all other rules step over it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

from tandem.cell.names import Known, difference, twins
from tandem.cell.parts import tools_of
from tandem.cell.precedence import between, no_task_waits_for_itself
from tandem.cell.slips import slips
from tandem.cell.times import (
    a_deadline_can_be_met,
    breaks_are_apart,
    exact_planning_can_count_it,
    numbers_have_few_decimals,
)
from tandem.cell.ways import RULES as WAYS
from tandem.cell.written import number
from tandem.errors import Fault

if TYPE_CHECKING:
    from tandem.cell.parts import Fields, Task, Together, Tool, Zone

Path = tuple[str | int, ...]


def faults(cell: Fields) -> Iterator[Fault]:
    """Everything that keeps the cell from being sound, rule by rule."""
    for rule in RULES:
        yield from rule(cell)


def operators_are_known(cell: Fields) -> Iterator[Fault]:
    """Whoever a task or a tool names is one of the cell's operators."""
    known = Known(cell.operators)
    of_cost = cell.cost.operators if cell.cost is not None else {}
    costs = ((("cost", "operators", who), who, "cost") for who in of_cost)
    for path, name, what in (*_operators_named(cell), *costs):
        if name not in known:
            yield Fault(
                f"{what} names {name!r}, who is no operator of the cell. {known.hint(name)}", path
            )


def names_can_be_told_apart(cell: Fields) -> Iterator[Fault]:
    """No two tasks, operators, tools, zones or places look alike though they are made of other
    signs, such as a Cyrillic letter.
    """
    used: dict[str, dict[str, Path]] = {"operators": {}, "tasks": {}}
    used |= _things_named(cell)
    for key, named in used.items():
        stated: Mapping[str, object] = getattr(cell, key)
        for first, name in twins([*stated, *named]):
            yield Fault(
                f"{key[:-1]} {name!r} looks like {key[:-1]} {first!r} but is written with other"
                f" signs ({difference(first, name)}). Spell both alike if they are one, else rename"
                " one of them.",
                (key, name) if name in stated else named[name],
            )


def tasks_are_known(cell: Fields) -> Iterator[Fault]:
    """Whatever stands in `after`, `wait` and `same_operator` is one of the cell's tasks;
    `stress_of_set` has a rule of its own.
    """
    known = Known(cell.tasks)
    for name, task in cell.tasks.items():
        for place, first in enumerate(task.after):
            if first not in known:
                yield Fault(
                    f"task {name!r} comes after {first!r}, which is no task. {known.hint(first)}",
                    ("tasks", name, "after", place),
                )
        for place, wait in enumerate(task.wait):
            if wait.after not in known:
                yield Fault(
                    f"task {name!r} waits after {wait.after!r}, which is no task."
                    f" {known.hint(wait.after)}",
                    ("tasks", name, "wait", place, "after"),
                )
    for place, pair in enumerate(cell.same_operator):
        for side, name in enumerate(pair):
            if name not in known:
                yield Fault(
                    f"same_operator names {name!r}, which is no task. {known.hint(name)}",
                    ("same_operator", place, side),
                )


def tasks_of_held_parts_are_known(cell: Fields) -> Iterator[Fault]:
    """Whatever stands in the `holds` of an operator is one of the cell's tasks."""
    known = Known(cell.tasks)
    for who, operator in cell.operators.items():
        for place, pair in enumerate(operator.holds):
            for side, name in enumerate(pair):
                if name not in known:
                    yield Fault(
                        f"operator {who!r}: holds names {name!r}, which is no task."
                        f" {known.hint(name)}",
                        ("operators", who, "holds", place, side),
                    )


def no_task_comes_after_itself(cell: Fields) -> Iterator[Fault]:
    """A task is not its own predecessor, and no pair of `same_operator` holds one task twice."""
    for name, task in cell.tasks.items():
        if name in task.after:
            yield Fault(
                f"task {name!r} comes after itself. Take {name!r} out of its `after`.",
                ("tasks", name, "after", task.after.index(name)),
            )
        for place, wait in enumerate(task.wait):
            if wait.after == name:
                yield Fault(
                    f"task {name!r} waits for itself. Name the task that comes first, or take the"
                    " wait out.",
                    ("tasks", name, "wait", place, "after"),
                )
    for place, (one, other) in enumerate(cell.same_operator):
        if one == other:
            yield Fault(
                f"same_operator pairs task {one!r} with itself. Name two different tasks, or take"
                " the pair out.",
                ("same_operator", place),
            )


def a_wait_leaves_time_to_start(cell: Fields) -> Iterator[Fault]:
    """The most that may pass is not below the least, and what is counted from one moment is stated
    once.
    """
    for name, task in cell.tasks.items():
        stated: dict[tuple[str, str], int] = {}
        for place, wait in enumerate(task.wait):
            path: Path = ("tasks", name, "wait", place)
            if wait.at_most is not None and wait.at_most < wait.at_least:
                least, most = number(wait.at_least), number(wait.at_most)
                yield Fault(
                    f"task {name!r}: the wait after {wait.after!r} is at least {least} s and at"
                    f" most {most} s, which leaves no moment to start. Write `at_least: {most},"
                    f" at_most: {least}` if they were mixed up, or make at_most larger.",
                    (*path, "at_most"),
                )
            first = stated.setdefault((wait.after, wait.between), place)
            if first != place:
                yield Fault(
                    f"task {name!r}: the wait after {wait.after!r} ({wait.between}) is stated"
                    " twice. Make one of them: the larger at_least, the smaller at_most.",
                    path,
                )


def a_group_names_each_operator_once(cell: Fields) -> Iterator[Fault]:
    """No operator takes part in a joint task twice, and no group is stated twice for a task."""
    for name, task in cell.tasks.items():
        seen: dict[frozenset[str], int] = {}
        for place, joint in enumerate(task.together):
            path: Path = ("tasks", name, "together", place)
            twice = [who for who, count in Counter(joint.operators).items() if count > 1]
            if twice:
                yield Fault(
                    f"task {name!r}: {_listed(twice)} stands twice in one group. A joint task needs"
                    " different operators.",
                    (*path, "operators"),
                )
                continue
            first = seen.setdefault(frozenset(joint.operators), place)
            if first != place:
                times = f"{number(task.together[first].time)} s and {number(joint.time)} s"
                yield Fault(
                    f"task {name!r}: the group {_listed(joint.operators)} is stated twice, with"
                    f" {times}. Keep one of them.",
                    path,
                )


def someone_can_do_each_task(cell: Fields) -> Iterator[Fault]:
    """Each task has a way of being done that finds room: enough places in its zone and enough of
    its tool.
    """
    for name, task in cell.tasks.items():
        path: Path = ("tasks", name)
        if not task.time and not task.together:
            of = "one of " * (len(cell.operators) > 1)
            here = f"{of}{_listed(cell.operators)}"
            yield Fault(
                f"task {name!r}: nobody can do it. Give `time` for {here}, or a group in"
                " `together`.",
                path,
            )
        elif not task.time:
            yield from _room_for_a_group(cell, name, task)


def _room_for_a_group(cell: Fields, name: str, task: Task) -> Iterator[Fault]:
    """Should no group find room: why the smallest one finds none."""
    groups = sorted(task.together, key=lambda joint: len(set(joint.operators)))
    crowded = [list(_crowded(cell, task, joint)) for joint in groups]
    if not all(crowded):
        return
    for key, used, size, capacity in crowded[0]:
        room = (
            f"zone {used!r} holds {capacity} at a time"
            if key == "zone"
            else f"there is {capacity} of tool {used!r}"
        )
        yield Fault(
            f"task {name!r}: {_listed(groups[0].operators)} can only do it together, but {room},"
            f" so they never meet. State `{key}s: {{{used}: {{capacity: {size}}}}}`, or let one"
            " operator do it alone.",
            ("tasks", name, key),
        )


def _crowded(cell: Fields, task: Task, joint: Together) -> Iterator[tuple[str, str, int, int]]:
    """(kind, name, places that the group needs, places that there are) where they are too few."""
    who = dict.fromkeys(joint.operators)
    tools = tools_of(task.tool if joint.tool is None else joint.tool, who)
    zones = {} if task.zone is None else dict.fromkeys(who, task.zone)
    tables: tuple[tuple[str, Mapping[str, str], Mapping[str, Tool | Zone]], ...] = (
        ("zone", zones, cell.zones),
        ("tool", tools, cell.tools),
    )
    for kind, used, table in tables:
        for name, size in Counter(used.values()).items():
            capacity = table[name].capacity if name in table else 1
            if size > capacity:
                yield kind, name, size, capacity


def a_tool_of_a_group_is_used_by_its_members(cell: Fields) -> Iterator[Fault]:
    """A group's tools are stated for those who take part; one for anybody else would count for
    nobody.
    """
    for name, task in cell.tasks.items():
        for place, joint in enumerate(task.together):
            for who in joint.tool if isinstance(joint.tool, Mapping) else ():
                if who in cell.operators and who not in joint.operators:
                    yield Fault(
                        f"task {name!r}: together: a tool is stated for {who!r}, who takes no part."
                        f" Taking part are {_listed(joint.operators)}; take {who!r} out of the"
                        " tools, or into the group.",
                        ("tasks", name, "together", place, "tool", who),
                    )


def kinds_are_kept_apart_from_each_other(cell: Fields) -> Iterator[Fault]:
    """A zone that keeps kinds apart names several, each once, and every task in it can be done by
    operators who may be there together.
    """
    for name, zone in cell.zones.items():
        if zone.apart and len(set(zone.apart)) < 2:
            yield Fault(
                f"zone {name!r}: keeps only {zone.apart[0]!r} apart, and from nobody. Name two"
                " kinds or more, such as `apart: [human, robot]`, or leave it out.",
                ("zones", name, "apart"),
            )
        elif twice := [kind for kind, count in Counter(zone.apart).items() if count > 1]:
            yield Fault(
                f"zone {name!r}: `apart` names {_listed(twice)} twice. Name each once.",
                ("zones", name, "apart"),
            )
    for name, task in cell.tasks.items():
        place = cell.zones.get(task.zone or "")
        if place is None or not place.apart or task.time or not task.together:
            continue
        groups = [joint.operators for joint in task.together]
        if all(len(_kinds_apart(cell, place, group)) > 1 for group in groups):
            kinds = " and ".join(place.apart)
            yield Fault(
                f"task {name!r}: {_listed(groups[0])} can only do it together, but zone"
                f" {task.zone!r} keeps {kinds} apart, so they never meet. Take the task out of the"
                " zone, let one operator do it alone, or take `apart` out.",
                ("tasks", name, "zone"),
            )


def _kinds_apart(cell: Fields, zone: Zone, group: tuple[str, ...]) -> set[str]:
    kinds: set[str] = {cell.operators[who].kind for who in group if who in cell.operators}
    return kinds & set(zone.apart)


def stress_is_put_on_humans(cell: Fields) -> Iterator[Fault]:
    """Stress per human names humans, and only humans have a stress limit."""
    for path, stress, what in _stresses(cell):
        for who in stress:
            kind = cell.operators[who].kind if who in cell.operators else "human"
            if kind != "human":
                yield Fault(
                    f"{what}: stress is stated for {who!r}, a {kind}. Only humans have stress; take"
                    f" {who!r} out.",
                    (*path, who),
                )
    for who, operator in cell.operators.items():
        if operator.kind != "human" and operator.stress_limit is not None:
            yield Fault(
                f"operator {who!r} is a {operator.kind} and has a stress_limit. Only humans have"
                " stress; take it out.",
                ("operators", who, "stress_limit"),
            )


def machines_hold_from_one_task_to_a_later_one(cell: Fields) -> Iterator[Fault]:
    """Only machines hold parts: each from one task to another that comes after it, once."""
    for who, operator in cell.operators.items():
        path: Path = ("operators", who, "holds")
        if operator.holds and operator.kind != "machine":
            yield Fault(
                f"operator {who!r} is a {operator.kind} and has `holds`. Only machines hold parts;"
                " take it out, or write `kind: machine`.",
                path,
            )
            continue
        for place, (first, last) in enumerate(operator.holds):
            if first not in cell.tasks or last not in cell.tasks:
                continue
            if first == last:
                yield Fault(
                    f"operator {who!r} holds a part from {first!r} to {last!r}. Name two tasks, the"
                    " one that puts the part in and the one that takes it out, or leave it out.",
                    (*path, place),
                )
            elif not between(cell, first, last):
                yield Fault(
                    f"operator {who!r} holds a part from {first!r} to {last!r}, but {last!r} does"
                    f" not come after {first!r}. Write {first!r} into `after` of {last!r}, or name"
                    " another pair.",
                    (*path, place),
                )
            elif operator.holds.index((first, last)) != place:
                yield Fault(
                    f"operator {who!r} holds a part from {first!r} to {last!r} twice. Keep one of"
                    " them.",
                    (*path, place),
                )


def stress_of_a_group_is_put_on_its_members(cell: Fields) -> Iterator[Fault]:
    """A group's stress per human names humans who take part; a number for anybody else would count
    for nobody.
    """
    for name, task in cell.tasks.items():
        for place, joint in enumerate(task.together):
            if not isinstance(joint.stress, Mapping):
                continue
            for who in joint.stress:
                known = who in cell.operators and cell.operators[who].kind == "human"
                if known and who not in joint.operators:
                    yield Fault(
                        f"task {name!r}: together: stress is stated for {who!r}, who takes no part."
                        f" Taking part are {_listed(joint.operators)}; take {who!r} out of the"
                        " stress, or into the group.",
                        ("tasks", name, "together", place, "stress", who),
                    )


def pairs_have_a_common_way(cell: Fields) -> Iterator[Fault]:
    """Two tasks that must be done by the same operators can be done by the same operators."""
    for place, (one, other) in enumerate(cell.same_operator):
        if one == other or one not in cell.tasks or other not in cell.tasks:
            continue
        ways = [_groups(cell.tasks[name]) for name in (one, other)]
        if all(ways) and not ways[0] & ways[1]:
            can = " and ".join(
                f"{name!r} by {_or(way)}" for name, way in zip((one, other), ways, strict=True)
            )
            yield Fault(
                f"tasks {one!r} and {other!r} must have the same operators, but nobody can do both:"
                f" {can}. Take the pair out, or give somebody a time for each.",
                ("same_operator", place),
            )


def sets_are_spelled_in_order(cell: Fields) -> Iterator[Fault]:
    """The keys of `stress_of_set` are known tasks, each once, in the cell's order, joined by
    commas.
    """
    if cell.stress_of_set is None:
        return
    order = {name: place for place, name in enumerate(cell.tasks)}
    known = Known(cell.tasks)
    for name in cell.tasks:
        if "," in name:
            yield Fault(
                f"task {name!r} has a comma in its name, so that stress_of_set cannot name it."
                " Rename the task.",
                ("tasks", name),
            )
    seen: dict[str, str] = {}
    for key in cell.stress_of_set:
        path: Path = ("stress_of_set", key)
        names = [part.strip() for part in key.split(",")] if key else []
        unknown = [name for name in names if name not in order]
        for name in unknown:
            yield Fault(
                f"stress_of_set {key!r} names {name!r}, which is no task. {known.hint(name)}", path
            )
        if unknown:
            continue
        right = ",".join(sorted(set(names), key=order.__getitem__))
        if right in seen:
            yield Fault(
                f"stress_of_set states the set {right!r} twice, as {seen[right]!r} and {key!r}."
                " Keep one of them.",
                path,
            )
        elif right != key:
            yield Fault(
                f"stress_of_set {key!r}: the tasks stand in the cell's order, each once, without"
                f" blanks. Write {right!r}.",
                path,
            )
        seen.setdefault(right, key)


def listed_things_are_not_misspelled(cell: Fields) -> Iterator[Fault]:
    """A tool, zone or place that is listed, used by nobody and spelled almost like an unlisted one
    in use is a slip of the pen.

    One that is listed, unused and like no other is no fault.
    """
    for key, used in _things_named(cell).items():
        listed: Mapping[str, object] = getattr(cell, key)
        strays = Known(name for name in used if name not in listed)
        for name in listed:
            if name not in used and (meant := strays.nearest(name)) is not None:
                yield Fault(
                    f"{key[:-1]} {name!r} is listed but never used, while {meant!r} is used but not"
                    " listed. Spell both alike.",
                    (key, name),
                )


def things_are_spelled_alike(cell: Fields) -> Iterator[Fault]:
    """Tools, zones, and places, that differ by capitals or one letter are one; listing both says
    that they are two.

    A name that is listed and used by nobody is left to the rule above.
    """
    for key, used in _things_named(cell).items():
        listed: Mapping[str, object] = getattr(cell, key)
        # a listed name is the one that is meant
        in_order = sorted(used, key=lambda name: name not in listed)
        for name, meant in slips(in_order).items():
            if name not in listed:
                kind = key[:-1]
                two = "rename one" if key == "places" else f"list both under `{key}`"
                yield Fault(
                    f"{kind} {name!r} is spelled almost like {kind} {meant!r}, so that they count"
                    f" as two. Did you mean {meant!r}? If they are two, {two}.",
                    used[name],
                )


def _things_named(cell: Fields) -> dict[str, dict[str, Path]]:
    """Every tool, zone and place that is named, with where it is first."""
    used: dict[str, dict[str, Path]] = {"tools": {}, "zones": {}, "places": {}}
    for name, task in cell.tasks.items():
        for path, tool in task.tools_named():
            used["tools"].setdefault(tool, ("tasks", name, *path))
        if task.zone is not None:
            used["zones"].setdefault(task.zone, ("tasks", name, "zone"))
        if task.place is not None:
            used["places"].setdefault(task.place, ("tasks", name, "place"))
    for who, operator in cell.operators.items():
        if operator.tool is not None:
            used["tools"].setdefault(operator.tool, ("operators", who, "tool"))
        if operator.place is not None:
            used["places"].setdefault(operator.place, ("operators", who, "place"))
    return used


def _operators_named(cell: Fields) -> Iterator[tuple[Path, str, str]]:
    for name, task in cell.tasks.items():
        here: Path = ("tasks", name)
        for place, joint in enumerate(task.together):
            for seat, who in enumerate(joint.operators):
                yield (*here, "together", place, "operators", seat), who, f"task {name!r}: together"
    for path, table, what in _tables_of_operators(cell):
        for who in table:
            yield (*path, who), who, what


def _tables_of_operators(cell: Fields) -> Iterator[tuple[Path, Mapping[str, object], str]]:
    """Every table by operators: where it stands, and what messages call it."""
    for name, task in cell.tasks.items():
        here: Path = ("tasks", name)
        tables = (("time", task.time), ("difficulty", task.difficulty), ("spread", task.spread))
        for key, table in tables:
            if isinstance(table, Mapping):
                yield (*here, key), table, f"task {name!r}: {key}"
        yield from (
            (path, tools, f"{what}: tool") for path, tools, what in _tool_tables(name, task)
        )
    yield from ((path, stress, f"{what}: stress") for path, stress, what in _stresses(cell))
    for name, tool in cell.tools.items():
        yield ("tools", name, "changeover"), tool.changeover, f"tool {name!r}: changeover"
    yield ("walk",), cell.walk, "walk"


def _tool_tables(name: str, task: Task) -> Iterator[tuple[Path, Mapping[str, str], str]]:
    """Every table of operators to tools of the task."""
    if isinstance(task.tool, Mapping):
        yield ("tasks", name, "tool"), task.tool, f"task {name!r}"
    for place, joint in enumerate(task.together):
        if isinstance(joint.tool, Mapping):
            path: Path = ("tasks", name, "together", place, "tool")
            yield path, joint.tool, f"task {name!r}: together"


def invested_money_is_spread_over_hours(cell: Fields) -> Iterator[Fault]:
    """Money that was invested says nothing about a piece without the hours that it lasts."""
    if cell.cost is not None and (cell.cost.invest > 0) != (cell.cost.hours is not None):
        missing = "hours" if cell.cost.hours is None else "invest"
        stated = "invest" if cell.cost.hours is None else "hours"
        yield Fault(
            f"cost states {stated} ({number(getattr(cell.cost, stated) or 0.0)}) but not {missing}:"
            f" invested money is spread over hours. State both, or leave {stated} out.",
            ("cost", stated),
        )


def assessments_can_be_scored(cell: Fields) -> Iterator[Fault]:
    """The facts of each assessment are those of its method, in its range, and complete; it is made
    for humans who can do the task.
    """
    if any(task.ergonomics for task in cell.tasks.values()):
        # the methods take a moment to load, and most cells need none
        from tandem.cell.assessed import faults

        yield from faults(cell)


def limits_can_be_kept(cell: Fields) -> Iterator[Fault]:
    """`limits` stand at humans, and name measures that every plan and decision can keep."""
    if any(operator.limits for operator in cell.operators.values()):
        from tandem.cell.measures import faults

        yield from faults(cell)


def _stresses(cell: Fields) -> Iterator[tuple[Path, Mapping[str, float], str]]:
    """Every stress that is stated per human."""
    for name, task in cell.tasks.items():
        if isinstance(task.stress, Mapping):
            yield ("tasks", name, "stress"), task.stress, f"task {name!r}"
        for place, joint in enumerate(task.together):
            if isinstance(joint.stress, Mapping):
                yield (
                    ("tasks", name, "together", place, "stress"),
                    joint.stress,
                    f"task {name!r}: together",
                )


def _groups(task: Task) -> set[frozenset[str]]:
    return {frozenset((who,)) for who in task.time} | {
        frozenset(joint.operators) for joint in task.together
    }


def _or(groups: set[frozenset[str]]) -> str:
    return " or ".join(sorted("+".join(sorted(group)) for group in groups))


def _listed(names: object) -> str:
    quoted = [repr(name) for name in names]  # type: ignore[attr-defined]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"


RULES: tuple[Callable[[Fields], Iterator[Fault]], ...] = (
    names_can_be_told_apart,
    operators_are_known,
    tasks_are_known,
    tasks_of_held_parts_are_known,
    no_task_comes_after_itself,
    no_task_waits_for_itself,
    a_wait_leaves_time_to_start,
    a_group_names_each_operator_once,
    someone_can_do_each_task,
    kinds_are_kept_apart_from_each_other,
    stress_is_put_on_humans,
    machines_hold_from_one_task_to_a_later_one,
    stress_of_a_group_is_put_on_its_members,
    a_tool_of_a_group_is_used_by_its_members,
    breaks_are_apart,
    a_deadline_can_be_met,
    pairs_have_a_common_way,
    sets_are_spelled_in_order,
    listed_things_are_not_misspelled,
    things_are_spelled_alike,
    *WAYS,
    numbers_have_few_decimals,
    exact_planning_can_count_it,
    invested_money_is_spread_over_hours,
    assessments_can_be_scored,
    limits_can_be_kept,
)
