"""A cell in the whole numbers that live deciders reckon with: ways numbered through, sets of tasks
and operators as bits, paces in the times.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault
from tandem.plan.bounds import load_prices
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout

PER_SECOND = 1000
"""Ticks in a second at least, so that a pace of 0.6 or 1.25 leaves whole numbers."""


@dataclass(frozen=True)
class Numbers:
    """One cell. Ways are numbered through: those of the first task as `cell.modes` lists them, then
    the second's, and so on: `count` ways of doing. Then come as many of taking apart what was done
    wrongly, in the same order, and then, per operator, being away.

    Attributes:
      per_second: ticks in a second.
      task: per way, its task. `who`: bits of its operators. `ticks`: its duration. `units`: its
        stress. `loads`: the stress per operator.
      ways: per task, its ways of doing. `need`: per task, bits of its predecessors; `behind_task`:
        of its direct successors.
      human: bits of the humans. `everybody`: bits of all operators. `full`: bits of all tasks.
      tails: per task, ticks on the longest chain that begins with it; `work`: its cheapest work at
        `prices`, per operator; `ease`: its least stress.
      behind: per way, ticks on the longest chain behind its task. `price`: the prices of its
        operators together; `total`: of all operators.
      release: per task, ticks. `breaks`: per operator, `(from, to)`. `changeover`: per tool and
        operator. `limits`: units of stress per operator.
      team: per task, its group of `same_operator` tasks, -1 for none.
      tool_places, zone_places: capacities, 0 where they never bind.
      timeless: no rule looks at the clock. `swaps`: changing tools costs time. `limited`: somebody
        has a limit of stress.
      plain: none of these matters, nor do places and teams.
    """

    instance: Instance
    per_second: int
    task: tuple[int, ...]
    who: tuple[int, ...]
    ticks: tuple[int, ...]
    units: tuple[int, ...]
    loads: tuple[tuple[tuple[int, int], ...], ...]
    ways: tuple[tuple[int, ...], ...]
    need: tuple[int, ...]
    human: int
    everybody: int
    full: int
    count: int
    behind_task: tuple[int, ...]
    tails: tuple[int, ...]
    behind: tuple[int, ...]
    price: tuple[int, ...]
    prices: tuple[int, ...]
    total: int
    work: tuple[int, ...]
    ease: tuple[int, ...]
    release: tuple[int, ...]
    breaks: tuple[tuple[tuple[int, int], ...], ...]
    changeover: tuple[tuple[int, ...], ...]
    limits: tuple[int | None, ...]
    team: tuple[int, ...]
    tool_places: tuple[int, ...]
    zone_places: tuple[int, ...]
    timeless: bool
    swaps: bool
    limited: bool
    plain: bool

    @classmethod
    def of(
        cls,
        cell: Cell,
        pace: Mapping[str, float] | None = None,
        *,
        taking_apart: float = 1.0,
        max_stress: float | None = None,
    ) -> Self:
        """The cell's numbers when every operator needs `pace` times the stated time (1 for who is
        not named; a group goes at its slowest).

        Taking a task apart takes `taking_apart` times as long as doing it in the same way.
        `max_stress` limits the stress of the one human.

        Raises CellError when stress comes from a table of sets: it is then no sum, and what is
        still to come cannot be told apart from what was; and when `max_stress` is to hold for
        several humans together.
        """
        if cell.stress_of_set is not None:
            what = (
                "live decisions need a stress that adds up; take stress_of_set out, or plan with"
                " `tandem plan`."
            )
            raise CellError([Fault(what, ("stress_of_set",))])
        instance = Instance.of(cell)
        layout = Layout.of(instance)
        per_second = max(PER_SECOND, instance.per_second)
        ways = _ways(layout, per_second // instance.per_second, pace or {}, taking_apart)
        rules = _rules(layout, per_second // instance.per_second, max_stress)
        sets = _sets(instance)
        return cls(
            instance=instance,
            per_second=per_second,
            **ways,
            **_bounds(layout, ways),
            **rules,
            **sets,
        )


def _ways(
    layout: Layout, scale: int, pace: Mapping[str, float], taking_apart: float
) -> dict[str, Any]:
    instance = layout.instance
    factor = [pace.get(name, 1.0) for name in instance.operators]
    flat = [
        (task, number, way)
        for task, row in enumerate(instance.ways)
        for number, way in enumerate(row)
    ]
    usable = [{step.way for step in row} for row in layout.steps]
    away = range(len(factor))
    task = [place for place, _, _ in flat]
    who = [sum(1 << o for o in way.operators) for _, _, way in flat]
    ticks = [
        max(1, round(way.ticks * scale * max(factor[o] for o in way.operators)))
        for _, _, way in flat
    ]
    loads = [tuple(zip(way.operators, way.load, strict=True)) for _, _, way in flat]
    units = [way.stress for _, _, way in flat]
    return {
        "count": len(flat),
        "task": (*task, *task, *(len(instance.tasks) + o for o in away)),
        "who": (*who, *who, *(1 << o for o in away)),
        "ticks": (
            *ticks,
            *(max(1, round(one * taking_apart)) for one in ticks),
            *(1 for _ in away),
        ),
        "units": (*units, *units, *(0 for _ in away)),
        "loads": (*loads, *loads, *(() for _ in away)),
        "ways": tuple(
            tuple(
                way
                for way, (place, number, _) in enumerate(flat)
                if place == one and number in usable[one]
            )
            for one in range(len(usable))
        ),
    }


def _bounds(layout: Layout, numbers: Mapping[str, Any]) -> dict[str, Any]:
    task, who, ticks, ways, units = (
        numbers[name] for name in ("task", "who", "ticks", "ways", "units")
    )
    operators = range(len(layout.instance.operators))
    tails = _tails(layout.instance, ways, ticks)
    prices = tuple(
        max(1, round(1024 * price)) for price in load_prices(_paced(layout, ways, ticks))[1]
    )
    price = tuple(sum(prices[o] for o in operators if bits >> o & 1) for bits in who)
    quickest = [min((ticks[way] for way in row), default=0) for row in ways]
    return {
        "tails": tails,
        "behind": tuple(
            tails[place] - quickest[place] if way < numbers["count"] else 0
            for way, place in enumerate(task)
        ),
        "price": price,
        "prices": prices,
        "total": sum(prices),
        "work": tuple(min((ticks[way] * price[way] for way in row), default=0) for row in ways),
        "ease": tuple(min((units[way] for way in row), default=0) for row in ways),
    }


def _rules(layout: Layout, scale: int, max_stress: float | None) -> dict[str, Any]:
    instance, operators = layout.instance, len(layout.instance.operators)
    limits = _limits(instance, max_stress)
    places = {
        "tool_places": tuple(
            places if places < operators else 0 for places in instance.tool_places
        ),
        "zone_places": tuple(
            places if places < operators else 0 for places in instance.zone_places
        ),
    }
    timeless = not any(instance.release) and not any(instance.breaks)
    swaps = any(any(row) for row in instance.changeover)
    limited = any(limit is not None for limit in limits)
    bound = any(any(row) for row in places.values()) or max(layout.team, default=-1) >= 0
    return {
        **places,
        "release": tuple(x * scale for x in instance.release),
        "breaks": tuple(tuple((a * scale, b * scale) for a, b in row) for row in instance.breaks),
        "changeover": tuple(tuple(x * scale for x in row) for row in instance.changeover),
        "limits": limits,
        "team": layout.team,
        "timeless": timeless,
        "swaps": swaps,
        "limited": limited,
        "plain": timeless and not swaps and not limited and not bound,
    }


def _sets(instance: Instance) -> dict[str, Any]:
    return {
        "need": tuple(sum(1 << first for first in before) for before in instance.before),
        "behind_task": tuple(sum(1 << after for after in row) for row in instance.behind),
        "human": sum(1 << o for o, human in enumerate(instance.human) if human),
        "everybody": (1 << len(instance.operators)) - 1,
        "full": (1 << len(instance.tasks)) - 1,
    }


def _paced(layout: Layout, ways: Sequence[Sequence[int]], ticks: Sequence[int]) -> Layout:
    """The layout with the times that the operators really need."""
    steps = []
    for row, mine in zip(layout.steps, ways, strict=True):
        steps.append(
            tuple(
                step._replace(ticks=ticks[way])
                for step, way in zip(sorted(row, key=lambda step: step.way), mine, strict=True)
            )
        )
    return replace(layout, steps=tuple(steps))


def _limits(instance: Instance, max_stress: float | None) -> tuple[int | None, ...]:
    """Units of stress per operator; the limit over all humans is the limit of the one there is."""
    if max_stress is None:
        return instance.stress_limit
    if sum(instance.human) > 1:
        raise CellError(
            [
                Fault(
                    "a limit on the stress of several humans together cannot be kept live; give"
                    " each human a stress_limit.",
                    ("operators",),
                )
            ]
        )
    most = int(max_stress * instance.per_stress + 1e-9)
    return tuple(
        min(most, most if limit is None else limit) if human else limit
        for human, limit in zip(instance.human, instance.stress_limit, strict=True)
    )


def _tails(
    instance: Instance, ways: Sequence[Sequence[int]], ticks: Sequence[int]
) -> tuple[int, ...]:
    tails = [0] * len(ways)
    for task in reversed(instance.order):
        tails[task] = min((ticks[way] for way in ways[task]), default=0) + max(
            (tails[after] for after in instance.behind[task]), default=0
        )
    return tuple(tails)
