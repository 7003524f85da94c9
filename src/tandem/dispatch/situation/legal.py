"""What may begin now in a situation, how long it would take, and what stands against the rest. Pure
functions.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from decimal import Decimal

from tandem.cell.burdens import costs
from tandem.cell.parts import Mode, Wait
from tandem.dispatch.situation.model import Situation, Stock, exact, mode
from tandem.schedule.exposure import Limit
from tandem.schedule.queues import KINDS, places_of


def start_of_work(situation: Situation, task: str, operators: Iterable[str]) -> float:
    """When the task itself would start, were it begun now, s: now, or when the last of them is
    there, its tool in hand.
    """
    return exact(
        max(
            [
                situation.now,
                *(
                    since + time
                    for since, time in _preparations(situation, task, operators).values()
                ),
            ]
        )
    )


def seconds(situation: Situation, task: str, operators: tuple[str, ...]) -> float:
    """How long it would keep them from now on as stated, what is left of a walk or a changeover
    included: to do it, or to take it apart when it is wrong.
    """
    return exact(
        start_of_work(situation, task, operators)
        - situation.now
        + _stated(situation, task, mode(situation.cell, task, operators))
    )


def legal(situation: Situation) -> list[tuple[str, tuple[str, ...]]]:
    """What may begin now, as (task, operators), in the cell's order. For a task in
    `situation.wrong` it means taking it apart.

    Predecessors have ended (or, to take a task apart, nothing stands on it any more), its waits
    after other tasks have lasted as long as they must, its release has come, its tools are whole
    and its part there, all operators are there and at nothing, tools and zone have room, nobody is
    in the zone whom it keeps apart from them, no machine holds another part, no break falls into
    walk, changeover or stated time, and refusals, limits of people (as far as the least of what is
    left tells), `same_operator` and `stress_of_set` are kept. Deadlines, and what a wait may
    last at most, rule out nothing: late is better than never.
    """
    idle = frozenset(situation.idle)
    found: dict[tuple[str, tuple[str, ...]], None] = {}
    for task in situation.open:
        if is_ready(situation, task):
            for way in situation.facts.ways[task]:
                if idle.issuperset(way.operators) and not any(hindrances(situation, task, way)):
                    found[task, way.operators] = None
    return list(found)


def may_begin(situation: Situation, task: str, operators: Iterable[str]) -> bool:
    """Whether these operators may begin the task now: one entry of `legal`, the others left
    aside.
    """
    who = frozenset(operators)
    if task not in situation.open or not is_ready(situation, task):
        return False
    if not who.issubset(situation.idle):
        return False
    ways = (way for way in situation.facts.ways[task] if who == frozenset(way.operators))
    return any(not any(hindrances(situation, task, way)) for way in ways)


def is_ready(situation: Situation, task: str) -> bool:
    """What must come before has come: what the task stands on is in place, and nothing above it is
    in hand or wrong (begun before its turn).

    Where the task is wrong: all that stands on it is off.
    """
    above = situation.facts.above[task]
    if any(name in above for place in (situation.running, situation.wrong) for name in place):
        return False
    if task in situation.wrong:
        return not any(name in above for name in situation.done)
    return all(first in situation.done for first in situation.cell.tasks[task].predecessors)


def waited_from(situation: Situation, wait: Wait) -> float | None:
    """The moment from which the wait counts, s; None while it has not come."""
    name, running = wait.after, situation.running.get(wait.after)
    if wait.between == "end-start":
        work = situation.done.get(name) or (None if running else situation.wrong.get(name))
        return None if work is None else work.end
    at = running or situation.done.get(name) or situation.wrong.get(name)
    if at is None or (running is not None and running.undoing):
        return None
    # what was left of a changeover came before the task itself
    return exact(at.start + at.stated - mode(situation.cell, name, at.operators).time)


def hindrances(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    """What else stands against the task being begun now in this way, in sentences; none when
    nothing does.
    """
    for rule in (
        _release,
        _waits,
        _stock,
        _refusals,
        _times_off,
        _room,
        _apart,
        _parts_held,
        _limits,
        _teams,
        _listed_sets,
    ):
        yield from rule(situation, task, way)


def next_change(situation: Situation) -> float | None:
    """When the clock alone may make something legal, s: a release, the end of a wait, of a break,
    of a refusal. None when it never will.
    """
    cell = situation.cell
    times = [cell.tasks[task].release for task in situation.open]
    times += [
        exact(moment + wait.at_least)
        for task in situation.open
        for wait in cell.tasks[task].wait
        if (moment := waited_from(situation, wait)) is not None
    ]
    times += [back for operator in cell.operators.values() for _, back, _ in operator.times_off]
    times += [until for until in situation.refused.values() if until is not None]
    return min((time for time in times if time > situation.now), default=None)


def _stated(situation: Situation, task: str, way: Mode) -> float:
    return way.time * situation.taking_apart if task in situation.wrong else way.time


def _preparations(
    situation: Situation, task: str, operators: Iterable[str]
) -> dict[str, tuple[float, float]]:
    """Operator -> since when they can have been getting ready for the task, and how long that takes
    (s): walking there, and taking up their tool. Only who needs time for it.
    """
    cell, operators = situation.cell, tuple(operators)
    if not cell.tools and not cell.walk:
        return {}
    tools, place = cell.tools_for(task, operators), cell.tasks[task].place
    found = {}
    for who in operators:
        time, tool = 0.0, tools.get(who, "")
        if tool in cell.tools and situation.in_hand.get(who, tool) != tool:
            time = cell.tools[tool].changeover.get(who, 0.0)
        if place is not None and who in cell.walking:
            time += cell.walking[who].get((situation.stands.get(who, place), place), 0.0)
        if time:
            over = [off.end for off in cell.operators[who].times_off if off.end <= situation.now]
            found[who] = (max([situation.since.get(who, 0.0), *over]), exact(time))
    return found


def _release(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    release = situation.cell.tasks[task].release
    if situation.now < release:
        yield f"task {task!r} is released at {situation.on_clock(release):g} s"


def _waits(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    """What is taken apart waits for nothing."""
    for wait in situation.cell.tasks[task].wait if task not in situation.wrong else ():
        moment = waited_from(situation, wait)
        if moment is None:
            # that it has not ended is said by `is_ready`
            if wait.between == "start-start":
                yield f"task {task!r} waits for the start of task {wait.after!r}"
        elif situation.now < exact(moment + wait.at_least):
            over = situation.on_clock(exact(moment + wait.at_least))
            said = "ended" if wait.between == "end-start" else "started"
            yield (
                f"task {task!r} waits until {over:g} s, {wait.at_least:g} s after task"
                f" {wait.after!r} {said}"
            )


def lacks(situation: Situation, task: str, operators: Iterable[str]) -> list[tuple[Stock, str]]:
    """What they need for the task and is broken or missing. Taking it apart needs the tools
    only.
    """
    tools = situation.cell.tools_for(task, operators).values()
    needs: list[tuple[Stock, str | None]] = [("tool", tool) for tool in dict.fromkeys(tools)]
    if task not in situation.wrong:
        needs += [("part", situation.cell.tasks[task].part), ("task", task)]
    return [(kind, name) for kind, name in needs if name and (kind, name) in situation.stock]


def _stock(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    if situation.stock:
        for kind, name in lacks(situation, task, way.operators):
            yield (
                f"what task {name!r} needs is missing"
                if kind == "task"
                else f"{kind} {name!r} is {'broken' if kind == 'tool' else 'missing'}"
            )


def _refusals(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    for who in way.operators:
        if situation.is_refused(who, task):
            until = situation.refused[who, task]
            yield f"{who!r} does not want task {task!r}" + (
                "" if until is None else f" before {situation.on_clock(until):g} s"
            )


def _times_off(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    if not any(situation.cell.operators[who].times_off for who in way.operators):
        return
    start, before = (
        start_of_work(situation, task, way.operators),
        _preparations(situation, task, way.operators),
    )
    end = exact(start + _stated(situation, task, way))
    for who in way.operators:
        begin = exact(start - before.get(who, (0.0, 0.0))[1])
        for off in situation.cell.operators[who].times_off:
            if off.start < end and begin < off.end:
                told = off._replace(
                    start=situation.on_clock(off.start), end=situation.on_clock(off.end)
                )
                yield f"{who!r} {told}"


def _room(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    cell = situation.cell
    for kind in KINDS:
        takes = cell.takes(kind, task, way.operators)
        for name, count in Counter(takes.values()).items() if takes else ():
            places = places_of(cell, kind, name)
            taken = sum(
                used == name
                for other, at in situation.running.items()
                for used in cell.takes(kind, other, at.operators).values()
            )
            if taken + count > places:
                yield (
                    f"{kind} {name!r} is taken"
                    if taken
                    else f"{kind} {name!r} has room for {places} only"
                )


def _apart(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    cell, name = situation.cell, situation.cell.tasks[task].zone
    apart = cell.zones[name].apart if name is not None and name in cell.zones else ()
    kinds = {cell.operators[who].kind for who in way.operators if apart}
    for other, at in situation.running.items() if kinds.intersection(apart) else ():
        for who in at.operators if cell.tasks[other].zone == name else ():
            kind = cell.operators[who].kind
            if kind in apart and not kinds.intersection(apart) <= {kind}:
                yield f"zone {name!r} keeps {' and '.join(apart)} apart, and {who!r} is in it"


def _parts_held(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    """Of machines that hold a part, and of those that are to take up one."""
    for held in _holding(situation):
        machine, first, last, within = held
        takes_another = any(task == its_first for _, its_first, *_ in _rivals(situation, held))
        if (machine in way.operators and task not in within) or takes_another:
            yield f"{machine!r} holds the part of task {first!r} until task {last!r} is done"
    if task in situation.wrong:
        return
    for held in situation.facts.holds:
        machine, first, last, _ = held
        if task != first:
            continue
        at = next((n for n, at in situation.running.items() if machine in at.operators), None)
        if at is not None:
            yield f"{machine!r} is to hold the part and is at task {at!r}"
        begun = _begun(situation)
        for name in sorted(_ahead(situation, held) - begun):
            yield (
                f"{machine!r} is to hold the part until task {last!r} is done, and must do task"
                f" {name!r} before"
            )
        if any(its_first == first for _, its_first, *_ in _rivals(situation, held)):
            yield f"{machine!r} cannot hold two parts"


Held = tuple[str, str, str, frozenset[str]]


def _holding(situation: Situation) -> list[Held]:
    """The holds that are open and bar something: not two of a machine at once, and none behind
    which a task that should lie before it must be done again, which only mistakes can bring about.
    """
    over, begun = situation.done.keys() | situation.wrong.keys(), _begun(situation)
    opened = [held for held in situation.facts.holds if held[1] in begun and held[2] not in over]
    return [
        held
        for held in opened
        if not any(other in opened for other in _rivals(situation, held))
        and not any(
            name in situation.wrong or name not in begun for name in _ahead(situation, held)
        )
    ]


def _begun(situation: Situation) -> set[str]:
    return {*situation.done, *situation.wrong, *situation.running}


def _rivals(situation: Situation, held: Held) -> Iterator[Held]:
    """The holds that the machine cannot have at the same time as this one."""
    machine, first, last, within = held
    for other in situation.facts.holds:
        nested = {first, last} <= other[3] or {other[1], other[2]} <= within
        if other != held and other[0] == machine and not nested:
            yield other


def _ahead(situation: Situation, held: Held) -> set[str]:
    """The tasks that must have begun before the hold: its last one waits for them, and only the
    machine can do them.
    """
    machine, _, last, within = held
    before = situation.facts.before[last]
    ahead = {
        name
        for name in before - within
        if all(machine in way.operators for way in situation.cell.modes(name))
    }
    return ahead | {its[2] for its in _rivals(situation, held) if its[1] in before}


def _limits(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    facts = situation.facts
    mine = [n for n, limit in enumerate(facts.limits) if limit.who in way.operators]
    if not mine or task in situation.wrong:
        return  # what has to come off does so, and what mistakes bring on top does not count
    stands = [
        (name, frozenset(at.operators))
        for place in (situation.wrong, situation.done, situation.running)
        for name, at in place.items()
    ]
    left = [other for other in situation.open if other != task and other not in situation.wrong]
    for number in mine:
        limit, dues = facts.limits[number], facts.dues[number]
        has = sum((dues[name][1][who] for name, who in stands), Decimal(0))
        ahead = sum((dues[other][0] for other in left), Decimal(0))
        if has + dues[task][1][frozenset(way.operators)] + ahead > limit.room:
            yield _over(situation, limit, task, way, has + ahead)


def _over(situation: Situation, limit: Limit, task: str, way: Mode, others: Decimal) -> str:
    """Why the limit keeps the person from the task; `others` is taken or to be taken besides."""
    who, measure, most = limit.who, limit.measure, f"{float(limit.most):g}"
    cell = situation.cell
    if measure.what == "peak":
        value = costs(cell, measure, task, way).get(who or "", Decimal(0))
        if value > limit.most:
            return f"{who!r} would have {float(value):g} of {measure.name}, the limit is {most}"
        return f"{who!r} cannot keep the limit of {most} on {measure.name} in what is left"
    total = others + limit.due(cell, task, way).get(who or "", Decimal(0))
    return (
        f"{who!r} would come to {float(total):.6g} of {measure.name} with what is left, the limit"
        f" is {most}"
    )


def _teams(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    for other in situation.facts.team[task]:
        at = situation.running.get(other) or situation.done.get(other) or situation.wrong.get(other)
        if at is not None and set(at.operators) != set(way.operators):
            yield f"{' and '.join(at.operators)} must do task {task!r}, having done task {other!r}"


def _listed_sets(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    if situation.facts.sets is None:
        return
    begun = {
        name: at.operators
        for place in (situation.wrong, situation.done, situation.running)
        for name, at in place.items()
    }
    humans = set(situation.cell.humans)
    by_humans = {name for name, group in begun.items() if humans.intersection(group)}
    possible = [tasks for tasks in situation.facts.sets if not (tasks ^ by_humans) & begun.keys()]
    if not any((task in tasks) == bool(humans.intersection(way.operators)) for tasks in possible):
        yield (
            f"`stress_of_set` lists no set that holds what was done and task {task!r} by"
            f" {' and '.join(way.operators)}"
        )
