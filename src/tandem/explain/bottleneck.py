"""Why no schedule is quicker: the chain, the load or the smallest group of tasks that alone takes
so long, found and confirmed by planning.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from time import monotonic
from typing import Any, Literal

from tandem.cell.model import Cell, plain
from tandem.cell.written import number
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.plan import exact
from tandem.plan.instance import Instance
from tandem.plan.method import Progress
from tandem.plan.question import Question
from tandem.plan.result import Result, Status
from tandem.schedule.critical import critical_path
from tandem.schedule.model import Schedule

Kind = Literal["chain", "load", "group", "open"]
EACH_S = 4.0
"""Seconds for one question "can these tasks alone be done sooner?"."""
MOST_WITHOUT = 12
"""So many members of a group are left out one by one to say what that would give."""


@dataclass(frozen=True)
class Bottleneck:
    """What keeps the makespan up.

    Attributes:
      makespan: the least of all schedules with at most `max_stress`, seconds.
      proven: no schedule is quicker.
      bound: no schedule is quicker than this, seconds; the makespan when proven.
      max_stress: the cap; None without one.
      kind: "chain" for tasks that must follow one another; "load" for tasks that only `operators`
        can do; "group" for tasks that alone, whoever does them, already take so long; "open" when
        the makespan is not proven, so that nothing is known to hold it up.
      tasks: the chain in its order, or the members in the cell's order.
      operators: of a load.
      least: task -> seconds at least, for a chain or a load.
      rest: for a load, seconds that must pass before its first task, and after its last.
      smallest: no member of the group can be missed.
      needs_order: of a group, whether it takes so long only because some of its tasks wait for
        others.
      without: member of a group -> the least makespan of the others, each found by planning them
        alone.
      schedule: the quickest one found.
    """

    cell: Cell
    makespan: float
    proven: bool
    bound: float
    max_stress: float | None
    kind: Kind
    schedule: Schedule
    tasks: tuple[str, ...] = ()
    operators: tuple[str, ...] = ()
    least: dict[str, float] = field(default_factory=dict)
    rest: tuple[float, float] = (0.0, 0.0)
    smallest: bool = False
    needs_order: bool | None = None
    without: dict[str, float] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        return {
            "makespan": plain(self.makespan),
            "proven": self.proven,
            "bound": plain(self.bound),
            "max_stress": plain(self.max_stress),
            "kind": self.kind,
            "tasks": list(self.tasks),
            "operators": list(self.operators),
            "least": plain(self.least),
            "rest": plain(self.rest),
            "smallest": self.smallest,
            "needs_order": self.needs_order,
            "without": plain(self.without),
            "sentences": sentences(self),
        }


def floor(
    cell: Cell,
    quickest: Result,
    *,
    max_stress: float | None = None,
    time_limit: float = 10.0,
    seed: int = 0,
    workers: int = 1,
) -> Bottleneck:
    """Why no schedule with at most `max_stress` is quicker than `quickest`, which must be the
    quickest of them.

    A chain and a load are sums that anyone can check. A group is found by leaving out tasks as long
    as the rest cannot be done sooner (a deletion filter: Chinneck and Dravnieks 1991, ORSA Journal
    on Computing 3(2), 157-168); each step plans the rest anew.
    """
    until = monotonic() + time_limit
    found = Bottleneck(
        cell,
        quickest.makespan,
        quickest.status is Status.OPTIMAL,
        quickest.bound.makespan,
        max_stress,
        "open",
        quickest.schedule,
    )
    if not found.proven:
        return found
    instance = Instance.of(cell)
    target = round(quickest.makespan * instance.per_second)
    return (
        _chain(found, instance, target)
        or _load(found, instance, target)
        or _group(found, instance, target, until, seed, workers)
    )


def _with(found: Bottleneck, **changes: Any) -> Bottleneck:
    return Bottleneck(
        **{**{name: getattr(found, name) for name in Bottleneck.__dataclass_fields__}, **changes}
    )


# --- sums that anyone can check -------------------------------------------------------------------


def _chain(found: Bottleneck, instance: Instance, target: int) -> Bottleneck | None:
    """Tasks that must follow one another and together take the whole makespan, even when each is
    done in its quickest way.
    """
    ends = [
        task
        for task in range(len(instance.tasks))
        if instance.head[task] + instance.tail[task] == target
    ]
    if not ends:
        return None
    first = min(ends, key=lambda task: instance.head[task])
    if instance.head[first] != instance.release[first]:
        return None
    chain = [first]
    while later := [
        task
        for task in instance.behind[chain[-1]]
        if _quickest(instance, chain[-1]) + instance.tail[task] == instance.tail[chain[-1]]
    ]:
        chain.append(min(later))
    least = {instance.tasks[task]: instance.seconds(_quickest(instance, task)) for task in chain}
    before = instance.seconds(instance.release[first])
    return _with(
        found, kind="chain", tasks=tuple(least), least=least, rest=(before, 0.0), smallest=True
    )


def _load(found: Bottleneck, instance: Instance, target: int) -> Bottleneck | None:
    """Tasks that one operator cannot hand over and that, with what must come before and after, take
    the whole makespan.
    """
    for who, name in enumerate(instance.operators):
        own = [
            task
            for task, ways in enumerate(instance.ways)
            if all(who in way.operators for way in ways)
        ]
        own.sort(key=lambda task: instance.head[task])
        # a task that can begin early only lowers the bound: try the sets without the earliest
        for start in range(len(own)):
            members = own[start:]
            tails = sorted(
                members, key=lambda task: instance.tail[task] - _quickest(instance, task)
            )
            for drop in range(len(tails)):
                kept = tails[drop:]
                before = min(instance.head[task] for task in kept)
                after = min(instance.tail[task] - _quickest(instance, task) for task in kept)
                if before + sum(_quickest(instance, task) for task in kept) + after == target:
                    least = {
                        instance.tasks[task]: instance.seconds(_quickest(instance, task))
                        for task in sorted(kept)
                    }
                    rest = (instance.seconds(before), instance.seconds(after))
                    return _with(
                        found,
                        kind="load",
                        tasks=tuple(least),
                        operators=(name,),
                        least=least,
                        rest=rest,
                        smallest=True,
                    )
    return None


def _quickest(instance: Instance, task: int) -> int:
    return min(way.ticks for way in instance.ways[task])


# --- the smallest group ---------------------------------------------------------------------------


def _group(
    found: Bottleneck, instance: Instance, target: int, until: float, seed: int, workers: int
) -> Bottleneck:
    """The smallest group that leaving out tasks leads to: first large pieces of the rest, then one
    by one.
    """
    cell, limit = found.cell, instance.seconds(target - 1)
    in_time = True

    def holds(tasks: Sequence[str], ordered: bool = True) -> bool:
        """These tasks alone cannot be done sooner; False too when time did not suffice to prove
        it.
        """
        nonlocal in_time
        left = until - monotonic()
        if left <= 0:
            in_time = False
            return False
        answer = _sooner(
            part(cell, tasks, ordered),
            limit,
            found.max_stress if cell.stress_of_set is None else None,
            min(left, EACH_S),
            seed,
            workers,
        )
        in_time &= answer is not None
        return answer is False

    kept = list(cell.tasks)
    size = max(len(kept) // 4, 1)
    while True:
        at = 0
        while at < len(kept):
            rest = kept[:at] + kept[at + size :]
            if rest and holds(rest):
                kept = rest
            else:
                at += size
        if size == 1:
            break
        size = max(size // 4, 1)
    smallest = in_time
    needs_order = (
        not holds(kept, ordered=False) if any(cell.tasks[task].after for task in kept) else False
    )
    without = _without(found, kept, until, seed, workers) if len(kept) <= MOST_WITHOUT else {}
    return _with(
        found,
        kind="group",
        tasks=tuple(kept),
        smallest=smallest,
        needs_order=needs_order if in_time else None,
        without=without,
    )


def _without(
    found: Bottleneck, kept: list[str], until: float, seed: int, workers: int
) -> dict[str, float]:
    shorter = {}
    for task in kept:
        rest = [other for other in kept if other != task]
        left = until - monotonic()
        if not rest or left <= 0:
            continue
        try:
            cap = found.max_stress if found.cell.stress_of_set is None else None
            question = Question("makespan", max_stress=cap)
            result = exact.solve(
                part(found.cell, rest),
                question,
                time_limit=min(left, EACH_S),
                seed=seed,
                workers=workers,
            )[0]
        except (InfeasibleError, NothingFoundError):
            continue
        if result.status is Status.OPTIMAL:
            shorter[task] = result.makespan
    return shorter


def part(cell: Cell, tasks: Iterable[str], ordered: bool = True) -> Cell:
    """The cell with these tasks only: whoever waited for a task that is left out waits for what
    that one waited for.

    No schedule of the whole cell is quicker than the quickest of a part. A table of stress by sets
    is left out with the others.
    """
    kept = set(tasks)
    before: dict[str, tuple[str, ...]] = {}

    def ahead(name: str) -> tuple[str, ...]:
        """The kept tasks nearest ahead of a task."""
        if name not in before:
            found = [
                other
                for first in cell.tasks[name].after
                for other in ((first,) if first in kept else ahead(first))
            ]
            before[name] = tuple(dict.fromkeys(found))
        return before[name]

    rows = {
        name: task.model_copy(update={"after": ahead(name) if ordered else ()})
        for name, task in cell.tasks.items()
        if name in kept
    }
    pairs = tuple(pair for pair in cell.same_operator if set(pair) <= kept)
    return cell.replace(
        tasks=rows,
        same_operator=pairs,
        stress_of_set=None if len(rows) < len(cell.tasks) else cell.stress_of_set,
    )


def _sooner(
    cell: Cell, limit: float, max_stress: float | None, seconds: float, seed: int, workers: int
) -> bool | None:
    """Whether some schedule ends by the limit; None when time did not suffice to tell."""
    found = False

    def enough(progress: Progress) -> None:
        nonlocal found
        if any(result.makespan <= limit for result in progress.found):
            found = True
            raise KeyboardInterrupt

    try:
        question = Question("makespan", max_makespan=max(limit, 0.0), max_stress=max_stress)
        exact.solve(
            cell, question, time_limit=seconds, seed=seed, workers=workers, on_solution=enough
        )
    except InfeasibleError:
        return False
    except (NothingFoundError, CellError):
        return True if found else None
    return True


# --- in words -------------------------------------------------------------------------------------


def sentences(found: Bottleneck) -> list[str]:
    """The floor as a person would explain it."""
    cap = (
        "" if found.max_stress is None else f" with a stress of at most {number(found.max_stress)}"
    )
    if found.kind == "open":
        return [
            f"{number(found.makespan)} s is the quickest found{cap}. What is proven so far is that"
            f" nothing takes less than {number(found.bound)} s."
        ]
    head = f"{number(found.makespan)} s is the floor{cap}"
    names = listed(found.tasks)
    if found.kind == "chain":
        parts = " + ".join(f"{number(seconds)}" for seconds in found.least.values())
        begin = f" from {number(found.rest[0])} s on" if found.rest[0] else ""
        whole = (
            f"{names} must follow one another{begin} and take {parts} s even when each is done in"
            " its quickest way"
        )
        if len(found.tasks) == 1:
            whole = f"{names} alone takes {parts} s{begin} in its quickest way"
        return [f"{head}: {whole}."]
    if found.kind == "load":
        who, total = found.operators[0], sum(found.least.values())
        ahead = f"not before {number(found.rest[0])} s, " if found.rest[0] else ""
        behind = f", and {number(found.rest[1])} s must follow" if found.rest[1] else ""
        return [
            f"{head}: only {who} can take part in {names}, {ahead}at least {number(total)} s of"
            f" work{behind}."
        ]
    return [f"{head}: {stretches(found.cell, found.schedule)}.", *_group_sentences(found, names)]


def _group_sentences(found: Bottleneck, names: str) -> list[str]:
    if len(found.tasks) < len(found.cell.tasks):
        missing = [task for task in found.cell.tasks if task not in found.tasks]
        which = names if len(missing) > 3 else f"all tasks but {listed(missing, '')}"
        said = [
            f"No other way is quicker, because {which} alone need"
            f" it{'' if found.smallest else ' (fewer may, time was short)'}."
        ]
    else:
        said = [
            (
                "No other way is quicker; every task has its share in it."
                if found.smallest
                else "No other way is quicker."
            )
        ]
    if found.needs_order is False:
        said.append(
            "They would take as long if they could be done in any order: it is the work itself that"
            " cannot be shared out better."
        )
    shorter = [f"{task}: {number(seconds)} s" for task, seconds in found.without.items()]
    if shorter:
        said.append(f"Without one of them the others could be done sooner ({', '.join(shorter)}).")
    return said


def stretches(cell: Cell, schedule: Schedule) -> str:
    """The critical path as stretches of work: "1, 2 and 4 keep robot busy until 18 s, then 6 keeps
    human busy until 21 s".
    """
    path = critical_path(cell, schedule)
    runs = [
        (who, list(links))
        for who, links in groupby(path, key=lambda link: link.assignment.operators)
    ]
    said = []
    for who, links in runs:
        names = listed([link.assignment.task for link in links], "")
        verb = "keep" if len(links) > 1 else "keeps"
        said.append(
            f"{names} {verb} {' and '.join(who)} busy until {number(links[-1].assignment.end)} s"
        )
    begin = path[0].assignment.start if path else 0.0
    after = f"from {number(begin)} s on " if begin else ""
    return f"{after}task{'s' if path and len(runs[0][1]) > 1 else ''} " + ", then ".join(said)


def listed(names: Sequence[str], word: str = "tasks") -> str:
    """ "tasks 1, 2 and 4", "task 1"; four and more numbers in a row as "1 to 16"."""
    runs = _runs(names)
    text = runs[0] if len(runs) == 1 else f"{', '.join(runs[:-1])} and {runs[-1]}"
    return f"{word.removesuffix('s') if len(names) == 1 else word} {text}".strip()


def _runs(names: Sequence[str]) -> list[str]:
    runs: list[list[str]] = []
    for name in names:
        if (
            runs
            and name.isdecimal()
            and runs[-1][-1].isdecimal()
            and int(name) == int(runs[-1][-1]) + 1
        ):
            runs[-1].append(name)
        else:
            runs.append([name])
    return [text for run in runs for text in ([f"{run[0]} to {run[-1]}"] if len(run) > 3 else run)]
