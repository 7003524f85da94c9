"""The checker: judges a schedule by its cell alone. It knows no solver, and every rule of the model
stands here once more.

Times are compared as the exact decimals that they print as. Each rule is a generator of sentences
and is tested alone.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from difflib import get_close_matches
from math import isfinite, nan
from operator import attrgetter
from typing import Literal, NamedTuple

from tandem.cell.burdens import costs, named
from tandem.cell.model import Cell
from tandem.cell.parts import Mode, Operator
from tandem.schedule.measures import (
    Ready,
    exact,
    made_ready,
    mode_of,
    stress_of_tasks,
    unlisted_set,
)
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.said import Said, num, said


def faults(
    cell: Cell,
    schedule: Schedule,
    *,
    max_makespan: float | None = None,
    max_stress: float | None = None,
) -> list[str]:
    """Everything that is wrong with the schedule, in sentences; an empty list when it is sound.

    Args:
      max_makespan, max_stress: limits that the schedule has to keep besides its cell's, seconds and
        the cell's measure of stress.
    """
    judged = Judged.of(cell, schedule, max_makespan, max_stress)
    return [sentence for rule in RULES for sentence in rule(judged)]


class Row(NamedTuple):
    """An assignment in exact numbers.

    Attributes:
      who: the operators that the cell knows, each once.
      mode: what the assignment means by its operators and duration; None when it is no way of doing
        its task.
    """

    start: Decimal
    end: Decimal
    task: str
    who: frozenset[str]
    mode: Mode | None
    given: Assignment


@dataclass(frozen=True)
class Judged:
    """A schedule laid out for the rules.

    Attributes:
      rows: assignments of known tasks at finite times, by start.
      of_task: task -> its rows; a sound schedule has one each.
      of_operator: operator -> rows of positive length, by start.
    """

    cell: Cell
    given: tuple[Assignment, ...]
    rows: tuple[Row, ...]
    of_task: Mapping[str, list[Row]]
    of_operator: Mapping[str, list[Row]]
    max_makespan: Decimal | None
    max_stress: Decimal | None

    @classmethod
    def of(
        cls,
        cell: Cell,
        schedule: Schedule,
        max_makespan: float | None = None,
        max_stress: float | None = None,
    ) -> Judged:
        """Reads the schedule; what cannot be read is left to the rules on names and numbers."""
        given = tuple(schedule)
        rows = sorted(
            (_row(cell, a) for a in given if a.task in cell.tasks and _is_finite(a)),
            key=attrgetter("start", "end"),
        )
        of_task: dict[str, list[Row]] = {}
        of_operator: dict[str, list[Row]] = {}
        for row in rows:
            of_task.setdefault(row.task, []).append(row)
            if row.start < row.end:
                for name in row.who:
                    of_operator.setdefault(name, []).append(row)
        limits = (None if limit is None else exact(limit) for limit in (max_makespan, max_stress))
        return cls(cell, given, tuple(rows), of_task, of_operator, *limits)


def times_are_numbers(judged: Judged) -> Iterator[str]:
    for a in judged.given:
        if not _is_finite(a):
            yield said("time.none", task=a.task, start=str(a.start), end=str(a.end))


def tasks_are_known(judged: Judged) -> Iterator[str]:
    for a in judged.given:
        if a.task not in judged.cell.tasks:
            yield said("task.unknown", task=a.task, hint=_nearest(a.task, judged.cell.tasks))


def each_task_is_done_once(judged: Judged) -> Iterator[str]:
    count: dict[str, int] = {}
    for a in judged.given:
        count[a.task] = count.get(a.task, 0) + 1
    for name in judged.cell.tasks:
        if name not in count:
            yield said("task.missing", task=name)
        elif count[name] > 1:
            yield said("task.twice", task=name, times=count[name])


def operators_are_known(judged: Judged) -> Iterator[str]:
    for a in judged.given:
        for name in dict.fromkeys(a.operators):
            if name not in judged.cell.operators:
                hint = _nearest(name, judged.cell.operators)
                yield said("operator.unknown", task=a.task, operator=name, hint=hint)
            if (times := a.operators.count(name)) > 1:
                yield said("operator.twice", task=a.task, operator=name, times=times)


def the_group_can_do_the_task(judged: Judged) -> Iterator[str]:
    for row in judged.rows:
        if (
            row.mode is None
            and not _modes_of_group(judged.cell, row)
            and _names_are_known(judged.cell, row)
        ):
            ways = tuple(dict.fromkeys(mode.operators for mode in judged.cell.modes(row.task)))
            who = tuple(row.given.operators)
            yield said("group.cannot" if who else "group.none", task=row.task, who=who, ways=ways)


def durations_are_right(judged: Judged) -> Iterator[str]:
    for row in judged.rows:
        if row.mode is None and (modes := _modes_of_group(judged.cell, row)):
            right = sorted({exact(mode.time) for mode in modes})
            yield said(
                "duration",
                task=row.task,
                who=tuple(row.given.operators),
                span=row.end - row.start,
                start=row.start,
                end=row.end,
                right=tuple(right),
                ends=tuple(row.start + time for time in right),
            )


def nothing_starts_before_zero(judged: Judged) -> Iterator[str]:
    for row in judged.rows:
        if row.start < 0:
            yield said("start.negative", task=row.task, start=row.start)


def predecessors_end_first(judged: Judged) -> Iterator[str]:
    for row in judged.rows:
        for name in judged.cell.tasks[row.task].predecessors:
            end = max((first.end for first in judged.of_task.get(name, ())), default=row.start)
            if row.start < end:
                yield said("predecessor", task=row.task, start=row.start, before=name, end=end)


def waits_are_kept(judged: Judged) -> Iterator[str]:
    for row in judged.rows:
        for wait in judged.cell.tasks[row.task].wait:
            is_end = wait.between == "end-start"
            firsts = judged.of_task.get(wait.after, ())
            if not firsts:
                continue
            moment = max(first.end if is_end else first.start for first in firsts)
            past, least = row.start - moment, exact(wait.at_least)
            when = said(
                f"wait.{'before' if past < 0 else 'past'}.{wait.between}",
                other=wait.after,
                past=past,
            )
            at = {"task": row.task, "start": row.start, "when": when}
            # that it starts before the other has ended is said by the rule on predecessors
            if past < least and (past >= 0 or not is_end):
                yield said("wait.least", least=least, earliest=moment + least, **at)
            if wait.at_most is not None and past > exact(wait.at_most):
                most = exact(wait.at_most)
                yield said("wait.most", most=most, latest=moment + most, **at)


def an_operator_does_one_task_at_a_time(judged: Judged) -> Iterator[str]:
    for name in judged.cell.operators:
        latest: Row | None = None
        for row in judged.of_operator.get(name, ()):
            if latest is not None and row.start < latest.end:
                yield said(
                    "at_once",
                    operator=name,
                    first=latest.task,
                    first_start=latest.start,
                    first_end=latest.end,
                    second=row.task,
                    second_start=row.start,
                    second_end=row.end,
                )
            if latest is None or row.end > latest.end:
                latest = row


def releases_are_kept(judged: Judged) -> Iterator[str]:
    for row in judged.rows:
        release = exact(judged.cell.tasks[row.task].release)
        if row.start < release and release:
            yield said("release", task=row.task, start=row.start, release=release)


def deadlines_are_kept(judged: Judged) -> Iterator[str]:
    for row in judged.rows:
        deadline = judged.cell.tasks[row.task].deadline
        if deadline is not None and row.end > exact(deadline):
            yield said("deadline", task=row.task, end=row.end, deadline=exact(deadline))


def breaks_are_free_of_work(judged: Judged) -> Iterator[str]:
    for name, breaks in _breaks(judged.cell):
        for row in judged.of_operator.get(name, ()):
            for start, end in _overlapping(breaks, row.start, row.end):
                at = {"start": row.start, "end": row.end, "since": start, "until": end}
                yield said("break", operator=name, task=row.task, **at)


def operators_are_set_up_first(judged: Judged) -> Iterator[str]:
    for name, operator in judged.cell.operators.items():
        ready = _ready(operator)
        for row in judged.of_operator.get(name, ()):
            if row.start < ready:
                at = {"start": row.start, "end": row.end, "ready": ready}
                need = exact(operator.setup)
                yield said("setup", operator=name, task=row.task, setup=need, **at)


def operators_are_at_hand_in_time(judged: Judged) -> Iterator[str]:
    """Before a task there is time to walk to it and to take up its tool."""
    for name, before in _preparations(judged):
        if before.free > before.row.start:
            continue  # the tasks themselves overlap, which another rule says
        if before.start < before.free:
            since = (
                said("since.task", task=before.after.task)
                if before.after
                else said("since.setup" if before.free else "since.beginning")
            )
            yield said(
                "ready.late",
                gap=before.row.start - before.free,
                since=since,
                earliest=before.free + before.time,
                **_needs(name, before),
            )


def breaks_are_free_of_walks_and_changeovers(judged: Judged) -> Iterator[str]:
    breaks_of = dict(_breaks(judged.cell))
    for name, before in _preparations(judged):
        for start, end in _overlapping(breaks_of.get(name, []), before.start, before.row.start):
            yield said(
                "ready.break",
                begin=before.start,
                start=before.row.start,
                since=start,
                until=end,
                earliest=end + before.time,
                **_needs(name, before),
            )


def tools_are_enough(judged: Judged) -> Iterator[str]:
    for name, rows in _by_place(judged, "tool"):
        places = judged.cell.tools[name].capacity if name in judged.cell.tools else 1
        for crowd in _crowds(rows, places):
            key = "tool.one" if places == 1 else "tool.other"
            yield said(key, name=name, places=places, crowd=crowd)


def zones_are_wide_enough(judged: Judged) -> Iterator[str]:
    for name, rows in _by_place(judged, "zone"):
        places = judged.cell.zones[name].capacity if name in judged.cell.zones else 1
        for crowd in _crowds(rows, places):
            key = "zone.one" if places == 1 else "zone.other"
            yield said(key, name=name, places=places, crowd=crowd)


def kinds_are_kept_apart(judged: Judged) -> Iterator[str]:
    for name, rows in _by_place(judged, "zone"):
        apart = judged.cell.zones[name].apart if name in judged.cell.zones else ()
        there = [(row, who, kind) for row, _ in rows for who, kind in _of_kinds(judged, row, apart)]
        for place, (row, who, kind) in enumerate(there):
            for earlier, other, its in there[:place]:
                if its != kind and row.start < earlier.end:
                    yield said(
                        "apart",
                        name=name,
                        kinds=tuple(said(f"kind.{one}") for one in apart),
                        one=other,
                        first=earlier.task,
                        first_start=earlier.start,
                        first_end=earlier.end,
                        other=who,
                        second=row.task,
                        second_start=row.start,
                        second_end=row.end,
                        later="" if earlier is row else said("earliest", earliest=earlier.end),
                    )


def _of_kinds(judged: Judged, row: Row, kinds: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Who takes part, in the cell's order, with their kind; those of these kinds only."""
    for who, operator in judged.cell.operators.items():
        if who in row.who and operator.kind in kinds:
            yield who, operator.kind


def machines_hold_their_part(judged: Judged) -> Iterator[str]:
    for name, operator in judged.cell.operators.items():
        found = [hold for pair in operator.holds for hold in held(judged, *pair)]
        begins = {
            id(before.row): before.start
            for who, before in (_preparations(judged) if found else ())
            if who == name
        }
        for hold in found:
            for row in judged.of_operator.get(name, ()):
                begin = min(row.start, begins.get(id(row), row.start))
                if row.task not in hold.within and begin < hold.end and hold.start < row.end:
                    earliest = said("earliest", earliest=hold.end + row.start - begin)
                    yield said(
                        "hold.ready" if row.start >= hold.end else "hold.busy",
                        operator=name,
                        hold=hold.said,
                        task=row.task,
                        start=row.start,
                        end=row.end,
                        begin=begin,
                        later=earliest if hold.start <= begin else "",
                    )
        for place, hold in enumerate(found):
            for other in found[:place]:
                first, then = sorted((hold, other), key=lambda one: (one.start, one.end))
                if then.start < first.end and not lies_within(hold, other):
                    yield said(
                        "hold.two",
                        operator=name,
                        hold=first.said,
                        task=then.first,
                        start=then.start,
                        earliest=first.end,
                    )


class Hold(NamedTuple):
    """A machine's part from the start of one task to the end of another; `within` are the tasks
    between them, and these two.
    """

    first: str
    last: str
    start: Decimal
    end: Decimal
    within: frozenset[str]

    @property
    def said(self) -> Said:
        """In words."""
        return said("hold", first=self.first, start=self.start, last=self.last, end=self.end)

    def __str__(self) -> str:
        return self.said


def held(judged: Judged, first: str, last: str) -> Iterator[Hold]:
    """The hold, where the schedule does both tasks."""
    behind, ahead = {first}, {last}
    for _ in judged.cell.tasks:
        behind |= {n for n, task in judged.cell.tasks.items() if behind & set(task.predecessors)}
        ahead |= {before for name in ahead for before in judged.cell.tasks[name].predecessors}
    for one in judged.of_task.get(first, ()):
        for other in judged.of_task.get(last, ()):
            yield Hold(first, last, one.start, other.end, frozenset(behind & ahead))


def lies_within(one: Hold, other: Hold) -> bool:
    """Whether one of the two belongs to what the machine does during the other."""
    return {one.first, one.last} <= other.within or {other.first, other.last} <= one.within


def stress_limits_are_kept(judged: Judged) -> Iterator[str]:
    for name, operator in judged.cell.operators.items():
        if operator.stress_limit is None:
            continue
        loads = [
            (exact(row.mode.stress[name]), row.task)
            for row in judged.rows
            if row.mode and name in row.mode.stress
        ]
        total, limit = sum((load for load, _ in loads), Decimal(0)), exact(operator.stress_limit)
        if total > limit:
            hardest = ", ".join(
                f"{task!r} {num(load)}" for load, task in sorted(loads, reverse=True)[:3]
            )
            yield said(
                "stress.person",
                operator=name,
                total=total,
                limit=limit,
                over=total - limit,
                hardest=hardest,
            )


def limits_of_a_person_are_kept(judged: Judged) -> Iterator[str]:
    cell = judged.cell
    for name, operator in cell.operators.items():
        for key, most in operator.limits.items():
            measure, limit = named(key, cell), exact(most)
            values = [
                (cost[name], row.task)
                for row in judged.rows
                if row.mode and name in (cost := costs(cell, measure, row.task, row.mode))
            ]
            per_shift = exact(cell.cycles_per_shift or 1.0) if measure.what == "dose" else 1
            shares = [Decimal(0), *(value * per_shift for value, _ in values)]
            total = max(shares) if measure.what == "peak" else sum(shares, Decimal(0))
            if total > limit:
                hardest = ", ".join(
                    f"{task!r} {_short(value * per_shift)}"
                    for value, task in sorted(values, reverse=True)[:3]
                )
                yield said(
                    "limits.person",
                    operator=name,
                    total=_short(total),
                    measure=key,
                    limit=limit,
                    hardest=hardest,
                )


def _short(number: Decimal) -> str:
    """Six digits: damage has many more."""
    return f"{float(number):.6g}"


def pairs_have_the_same_operators(judged: Judged) -> Iterator[str]:
    for first, second in judged.cell.same_operator:
        for one in judged.of_task.get(first, ()):
            for other in judged.of_task.get(second, ()):
                if one.who != other.who:
                    yield said(
                        "pair",
                        first=first,
                        second=second,
                        one=tuple(one.given.operators),
                        other=tuple(other.given.operators),
                    )


def the_set_of_human_tasks_is_listed(judged: Judged) -> Iterator[str]:
    if judged.cell.stress_of_set is not None and all(
        len(judged.of_task.get(name, ())) == 1 for name in judged.cell.tasks
    ):
        done = _human_tasks(judged)
        if stress_of_tasks(judged.cell, done) is None:
            yield unlisted_set(judged.cell, done)


def the_makespan_is_within_its_limit(judged: Judged) -> Iterator[str]:
    if judged.max_makespan is not None:
        for row in judged.rows:
            if row.end > judged.max_makespan:
                yield said("limit.makespan", task=row.task, end=row.end, limit=judged.max_makespan)


def the_stress_is_within_its_limit(judged: Judged) -> Iterator[str]:
    if judged.max_stress is None:
        return
    if judged.cell.stress_of_set is None:
        total = sum(
            (exact(load) for row in judged.rows if row.mode for load in row.mode.stress.values()),
            Decimal(0),
        )
    else:
        listed = stress_of_tasks(judged.cell, _human_tasks(judged))
        total = Decimal(0) if listed is None else exact(listed)
    if total > judged.max_stress:
        yield said("limit.stress", total=total, limit=judged.max_stress)


RULES: tuple[Callable[[Judged], Iterator[str]], ...] = (
    times_are_numbers,
    tasks_are_known,
    each_task_is_done_once,
    operators_are_known,
    the_group_can_do_the_task,
    durations_are_right,
    nothing_starts_before_zero,
    predecessors_end_first,
    waits_are_kept,
    an_operator_does_one_task_at_a_time,
    releases_are_kept,
    deadlines_are_kept,
    breaks_are_free_of_work,
    operators_are_set_up_first,
    operators_are_at_hand_in_time,
    breaks_are_free_of_walks_and_changeovers,
    tools_are_enough,
    zones_are_wide_enough,
    kinds_are_kept_apart,
    machines_hold_their_part,
    stress_limits_are_kept,
    limits_of_a_person_are_kept,
    pairs_have_the_same_operators,
    the_set_of_human_tasks_is_listed,
    the_makespan_is_within_its_limit,
    the_stress_is_within_its_limit,
)


class _Preparation(NamedTuple):
    """What the operator does directly before `row`: it walks there, then takes up its tool. It is
    free from `free` on, when `after` has ended.
    """

    row: Row
    ready: Ready
    free: Decimal
    after: Row | None

    @property
    def time(self) -> Decimal:
        return exact(self.ready.walk) + exact(self.ready.change)

    @property
    def start(self) -> Decimal:
        return self.row.start - self.time


def _preparations(judged: Judged) -> Iterator[tuple[str, _Preparation]]:
    """Those that take time."""
    for name in judged.cell.operators:
        after, free = None, _ready(judged.cell.operators[name])
        rows = judged.of_operator.get(name, [])
        ready = made_ready(judged.cell, name, [row.given for row in rows])
        for row, before in zip(rows, ready, strict=True):
            if before.seconds:
                yield name, _Preparation(row, before, free, after)
            if row.end > free:
                after, free = row, row.end


def _needs(name: str, before: _Preparation) -> dict[str, object]:
    """What sentences about it have in common."""
    return {"operator": name, "what": told(before.ready), "task": before.row.task}


def told(ready: Ready) -> Said:
    """What somebody does directly before a task, in words."""
    walk, origin, place, change, tool = ready
    key = "walk.change" if walk and change else "walk" if walk else "change"
    values = {"walk": exact(walk), "origin": origin, "place": place}
    return said(key, **values, change=exact(change), tool=tool)


def _by_place(
    judged: Judged, kind: Literal["tool", "zone"]
) -> Iterator[tuple[str, list[tuple[Row, int]]]]:
    """Rows of positive length by the tool or zone that they need, and how many of it each takes."""
    rows: dict[str, list[tuple[Row, int]]] = {}
    for row in judged.rows:
        if row.start < row.end:
            takes = judged.cell.takes(kind, row.task, row.who)
            for name, count in Counter(takes.values()).items():
                rows.setdefault(name, []).append((row, count))
    yield from rows.items()


def _crowds(rows: Iterable[tuple[Row, int]], places: int) -> Iterator[Said]:
    """A sentence for each span of time in which more operators are there than there are places."""
    rows = list(rows)
    events = sorted(
        [(row.end, 0, row, count) for row, count in rows]
        + [(row.start, 1, row, count) for row, count in rows],
        key=lambda event: event[:2],
    )
    present: dict[int, Row] = {}
    used, since, most, crowd = 0, Decimal(0), 0, dict[str, None]()
    for time, starts, row, count in events:
        if starts:
            present[id(row)] = row
            used += count
            if used > places:
                since = since if crowd else time
                crowd.update(
                    dict.fromkeys(
                        [row.task] if crowd else [other.task for other in present.values()]
                    )
                )
                most = max(most, used)
        else:
            del present[id(row)]
            used -= count
            if crowd and used <= places:
                tasks = tuple(map(repr, crowd))
                yield said("crowd", most=most, since=since, until=time, tasks=tasks)
                most, crowd = 0, {}


def _human_tasks(judged: Judged) -> set[str]:
    humans = set(judged.cell.humans)
    return {row.task for row in judged.rows if row.who & humans}


def _breaks(cell: Cell) -> Iterator[tuple[str, list[tuple[Decimal, Decimal]]]]:
    for name, operator in cell.operators.items():
        if operator.breaks:
            yield name, sorted((exact(start), exact(end)) for start, end in operator.breaks)


def _ready(operator: Operator) -> Decimal:
    """When it has been set up, in one piece that no break falls into; 0 when it need not be."""
    need, begin = exact(operator.setup), Decimal(0)
    for start, end in sorted((exact(start), exact(end)) for start, end in operator.breaks):
        if not need or start - begin >= need:
            break
        begin = end
    return begin + need if need else Decimal(0)


def _overlapping(
    breaks: list[tuple[Decimal, Decimal]], start: Decimal, end: Decimal
) -> Iterator[tuple[Decimal, Decimal]]:
    """The breaks that share more than a moment with the span; breaks sorted and disjoint."""
    place = bisect_right(breaks, start, key=lambda pause: pause[1])
    while place < len(breaks) and breaks[place][0] < end:
        yield breaks[place]
        place += 1


def _row(cell: Cell, a: Assignment) -> Row:
    return Row(
        exact(a.start),
        exact(a.end),
        a.task,
        frozenset(a.operators) & cell.operators.keys(),
        mode_of(cell, a),
        a,
    )


def _is_finite(a: Assignment) -> bool:
    return all(isfinite(_number(time)) for time in (a.start, a.end))


def _number(value: object) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return nan


def _modes_of_group(cell: Cell, row: Row) -> list[Mode]:
    who = set(row.given.operators)
    return [mode for mode in cell.modes(row.task) if set(mode.operators) == who]


def _names_are_known(cell: Cell, row: Row) -> bool:
    return all(name in cell.operators for name in row.given.operators)


def _nearest(name: object, known: Iterable[str]) -> Said:
    known = list(known)
    near = get_close_matches(str(name), known, n=1)
    if near:
        return said("near", name=near[0])
    return said("known", names=", ".join(known[:12]) + (", ..." if len(known) > 12 else ""))


def only(places: int, what: str = "") -> str:
    """So few: 'is only 1', 'are only 2', of something."""
    return (
        f"is only 1 {what}".rstrip()
        if places == 1
        else f"are only {places} {what + 's' if what else ''}".rstrip()
    )


def sec(seconds: Decimal) -> str:
    """A time in a sentence."""
    return f"{num(seconds)} s"
