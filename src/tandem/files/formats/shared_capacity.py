"""Projects under shared capacities (RCPSP and its multi-mode form) as cells: what an activity needs
of a resource becomes hands that each hold one unit of it.

A cell has no activity that simply takes five of twenty-four units. It has operators who each hold a
tool, tools of which there are so many, and joint tasks. So each activity has a crew of its own, as
many hands for a resource as it needs units, and the resource is a tool with its capacity. That is
exact: a crew is shared only by activities that precedence puts in one row, which never run at once,
so that nothing but the capacities and the precedence is left to decide.

What is used up for good (nonrenewable resources) has no place in a cell and is refused, unless
there is enough of it for whatever is chosen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from typing import Any, NamedTuple

from tandem.errors import CellError, Fault
from tandem.files.formats.lines import Translated, few_enough, title
from tandem.files.positions import Path

MOST_HANDS = 2_000
"""More than other formats may have operators: each belongs to a few activities only."""


class Way(NamedTuple):
    """A mode: its line, its duration in whole units of time, and what it needs, resource ->
    units.
    """

    line: int
    duration: int
    needs: Mapping[str, int]


@dataclass(frozen=True)
class Activity:
    """An activity: the line of its first mode, its modes, and who comes directly before it."""

    line: int
    ways: tuple[Way, ...]
    after: tuple[str, ...]


@dataclass(frozen=True)
class Project:
    """A project as its file states it.

    Attributes:
      stated: the line where the capacities stand.
      renewable: resource -> units there are at any moment.
      consumed: resource -> units there are for the whole project.
      activities: by name, in the file's order, source and sink among them.
    """

    source: str
    stated: int
    renewable: Mapping[str, int]
    consumed: Mapping[str, int]
    activities: Mapping[str, Activity]


def as_cell(project: Project) -> Translated:
    """The project as a cell that has the same schedules.

    Raises:
      CellError: it uses something up, an activity finds no room or takes no time but needs
        something, or its crews are more than a cell can hold; with every reason at its line.
    """
    faults = [*_used_up(project), *_in_no_time(project), *_without_room(project)]
    if faults:
        raise CellError(faults)
    activities = _without_moments(project.activities)
    crews = _crews(project, activities)
    hands = _hands(project, activities, crews)
    ways = sum(len(activity.ways) for activity in activities.values())
    few_enough(project.source, project.stated, len(hands), ways, MOST_HANDS)
    tasks: dict[str, Any] = {}
    places: dict[Path, int] = {}
    for name, activity in activities.items():
        tasks[name] = _task(activity, crews[name], project)
        places["tasks", name] = activity.line
    tools = {name: {"capacity": units} for name, units in project.renewable.items() if units}
    used = {tool for tool in hands.values() if tool is not None}
    data = {
        "name": title(project.source),
        "operators": {hand: {"kind": "machine"} for hand in hands},
        "tasks": tasks,
        "tools": {name: tool for name, tool in tools.items() if name in used},
    }
    return Translated(project.source, data, places)


def _used_up(project: Project) -> Iterator[Fault]:
    for resource, units in project.consumed.items():
        most = {
            name: max(way.needs.get(resource, 0) for way in activity.ways)
            for name, activity in project.activities.items()
        }
        if (total := sum(most.values())) > units:
            hungriest = max(most, key=most.__getitem__)
            yield Fault(
                f"resource {resource} is used up: there are {units} units for the whole project,"
                f" and its activities may use up to {total} (activity {hungriest} up to"
                f" {most[hungriest]}). A cell holds what is free again when a task ends (tools"
                " with a capacity), and no stock. Leave out modes until the rest cannot use more"
                f" than {units}, or use a solver of multi-mode projects.",
                (),
                f"{project.source}:{project.stated}",
            )


def _in_no_time(project: Project) -> Iterator[Fault]:
    for name, activity in project.activities.items():
        for way in activity.ways:
            if way.duration == 0 and (any(way.needs.values()) or len(activity.ways) > 1):
                yield Fault(
                    f"activity {name} takes 0 s and is more than a mark in the plan: it needs"
                    " resources or has other modes. A task of a cell takes more than 0 s. State"
                    " its time.",
                    (),
                    f"{project.source}:{way.line}",
                )


def _without_room(project: Project) -> Iterator[Fault]:
    for name, activity in project.activities.items():
        if not any(_fits(way, project) for way in activity.ways):
            way = activity.ways[0]
            resource = next(
                key for key, units in way.needs.items() if units > project.renewable.get(key, units)
            )
            yield Fault(
                f"activity {name} needs {way.needs[resource]} units of {resource}, but there are"
                f" {project.renewable[resource]}. Mend one of the two.",
                (),
                f"{project.source}:{way.line}",
            )


def _fits(way: Way, project: Project) -> bool:
    return all(units <= project.renewable.get(key, units) for key, units in way.needs.items())


def _without_moments(activities: Mapping[str, Activity]) -> dict[str, Activity]:
    """The activities that take time; those before one that takes none come before what follows
    it.
    """
    moments = {name for name, one in activities.items() if one.ways[0].duration == 0}

    def before(name: str, seen: set[str]) -> Iterator[str]:
        for first in activities[name].after:
            if first not in moments:
                yield first
            elif first not in seen:
                seen.add(first)
                yield from before(first, seen)

    return {
        name: replace(one, after=tuple(dict.fromkeys(before(name, set()))))
        for name, one in activities.items()
        if name not in moments
    }


def _crews(project: Project, activities: Mapping[str, Activity]) -> dict[str, int]:
    """Activity -> the number of its crew, from 1: activities of one crew follow one another by
    precedence. Each joins the crew that has to grow least for it. A graph with a circle gives each
    a crew; the cell's rules refuse it.
    """
    graph = {name: activity.after for name, activity in activities.items()}
    try:
        order = list(TopologicalSorter(graph).static_order())
    except CycleError:
        return {name: number for number, name in enumerate(activities, 1)}
    earlier: dict[str, frozenset[str]] = {}
    last: list[str] = []
    size: list[dict[str, int]] = []
    crews: dict[str, int] = {}
    for name in order:
        earlier[name] = frozenset(graph[name]).union(*(earlier[first] for first in graph[name]))
        needs = _most(activities[name], project)
        free = [number for number, one in enumerate(last) if one in earlier[name]]
        crew = min(free, key=lambda number: _growth(size[number], needs), default=len(last))
        if crew == len(last):
            last.append(name)
            size.append({})
        last[crew] = name
        size[crew] = {key: max(units, size[crew].get(key, 0)) for key, units in needs.items()}
        crews[name] = crew + 1
    return crews


def _most(activity: Activity, project: Project) -> dict[str, int]:
    ways = [way for way in activity.ways if _fits(way, project)]
    return {key: max(way.needs.get(key, 0) for way in ways) for key in project.renewable}


def _growth(size: Mapping[str, int], needs: Mapping[str, int]) -> int:
    return sum(max(0, units - size.get(key, 0)) for key, units in needs.items())


def _hands(
    project: Project, activities: Mapping[str, Activity], crews: Mapping[str, int]
) -> dict[str, str | None]:
    """Operator -> the resource it holds; None for the one who works where nothing is needed."""
    found: dict[str, str | None] = {}
    for name, activity in sorted(activities.items(), key=lambda item: crews[item[0]]):
        for way in activity.ways:
            if _fits(way, project):
                found |= _team(way, crews[name], project)
    return found


def _team(way: Way, crew: int, project: Project) -> dict[str, str | None]:
    team: dict[str, str | None] = {
        f"crew_{crew}_{resource}_{number}": resource
        for resource in project.renewable
        for number in range(1, way.needs.get(resource, 0) + 1)
    }
    return team or {f"crew_{crew}": None}


def _task(activity: Activity, crew: int, project: Project) -> dict[str, Any]:
    quickest: dict[tuple[str, ...], tuple[int, dict[str, str]]] = {}
    for way in activity.ways:
        if _fits(way, project):
            team = _team(way, crew, project)
            who = tuple(team)
            if who not in quickest or way.duration < quickest[who][0]:
                held = {hand: resource for hand, resource in team.items() if resource is not None}
                quickest[who] = way.duration, held
    task: dict[str, Any] = {"time": {}, "together": [], "tool": {}, "after": list(activity.after)}
    for who, (duration, held) in quickest.items():
        if len(who) == 1:
            task["time"][who[0]] = duration
            task["tool"] |= held
        else:
            task["together"].append({"operators": list(who), "time": duration, "tool": held})
    return {key: value for key, value in task.items() if value or key == "after"}
