"""Why no schedule is quicker: the chain, the load or the smallest group of tasks that alone takes
so long, found and confirmed by planning.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from time import monotonic
from typing import Any, Literal

from tandem.cell.model import Cell, plain
from tandem.cell.parts import Wait
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.explain.language import Words, listed, together, words
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
      waits: of a chain, task -> seconds at least that it waits after the one before it.
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
    waits: dict[str, float] = field(default_factory=dict)
    rest: tuple[float, float] = (0.0, 0.0)
    smallest: bool = False
    needs_order: bool | None = None
    without: dict[str, float] = field(default_factory=dict)

    def to_dict(self, language: str = "en") -> dict[str, Any]:
        """The `floor` of an explanation's document; its sentences in this language."""
        return {
            "makespan": plain(self.makespan),
            "proven": self.proven,
            "bound": plain(self.bound),
            "max_stress": plain(self.max_stress),
            "kind": self.kind,
            "tasks": list(self.tasks),
            "operators": list(self.operators),
            "least": plain(self.least),
            **({"waits": plain(self.waits)} if self.waits else {}),
            "rest": plain(self.rest),
            "smallest": self.smallest,
            "needs_order": self.needs_order,
            "without": plain(self.without),
            "sentences": sentences(self, language),
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
    chain, gaps = [first], {}
    while later := [
        (task, gap)
        for task, gap in _behind(instance, chain[-1])
        if _quickest(instance, chain[-1]) + gap + instance.tail[task] == instance.tail[chain[-1]]
    ]:
        task, gap = min(later)
        chain.append(task)
        if gap:
            gaps[instance.tasks[task]] = instance.seconds(gap)
    if instance.tail[chain[-1]] != _quickest(instance, chain[-1]):
        return None  # a wait between two starts, of which the times of the tasks say nothing
    least = {instance.tasks[task]: instance.seconds(_quickest(instance, task)) for task in chain}
    before = instance.seconds(instance.release[first])
    return _with(
        found,
        kind="chain",
        tasks=tuple(least),
        least=least,
        waits=gaps,
        rest=(before, 0.0),
        smallest=True,
    )


def _behind(instance: Instance, task: int) -> list[tuple[int, int]]:
    """The direct successors, and the ticks at least in between."""
    direct = [(after, 0) for after in instance.behind[task]]
    waits = instance.lags_from[task] if instance.has_lags else ()
    return [*direct, *((lag.task, lag.least) for lag in waits if not lag.from_start)]


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
            tails = sorted(members, key=lambda task: instance.rest[task])
            for drop in range(len(tails)):
                kept = tails[drop:]
                before = min(instance.head[task] for task in kept)
                after = min(instance.rest[task] for task in kept)
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
        not holds(kept, ordered=False)
        if any(cell.tasks[task].begun_first for task in kept)
        else False
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
    that one waited for; waits after it are left out.

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
                for first in cell.tasks[name].predecessors
                for other in ((first,) if first in kept else ahead(first))
            ]
            before[name] = tuple(dict.fromkeys(found))
        return before[name]

    def left(name: str) -> tuple[Wait, ...]:
        """The task's waits after kept tasks."""
        return tuple(wait for wait in cell.tasks[name].wait if wait.after in kept)

    rows = {
        name: task.model_copy(
            update={
                "after": ahead(name) if ordered else (),
                "wait": left(name) if ordered else (),
            }
        )
        for name, task in cell.tasks.items()
        if name in kept
    }
    pairs = tuple(pair for pair in cell.same_operator if set(pair) <= kept)
    operators = {
        who: operator.model_copy(
            update={"holds": tuple(h for h in operator.holds if ordered and set(h) <= kept)}
        )
        for who, operator in cell.operators.items()
    }
    return cell.replace(
        operators=operators,
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


def sentences(found: Bottleneck, language: str = "en") -> list[str]:
    """The floor as a person would explain it."""
    t = words(language)
    cap = "" if found.max_stress is None else t("floor.limit", limit=t.number(found.max_stress))
    quickest = t.seconds(found.makespan)
    if found.kind == "open":
        return [t("floor.open", quickest=quickest, cap=cap, bound=t.seconds(found.bound))]
    why = {"chain": _chain_words, "load": _load_words}.get(found.kind, _stretches)(found, t)
    head = t("floor.head", quickest=quickest, cap=cap, why=why)
    return [head, *(_group_sentences(found, t) if found.kind == "group" else [])]


def _chain_words(found: Bottleneck, t: Words) -> str:
    return t(
        "floor.chain" if len(found.tasks) > 1 else "floor.alone",
        names=listed(t, found.tasks),
        parts=" + ".join(_parts(found, t)),
        begin=t("floor.from", seconds=t.seconds(found.rest[0])) if found.rest[0] else "",
    )


def _parts(found: Bottleneck, t: Words) -> Iterator[str]:
    """The seconds of a chain, one after the other: each task's, and the waits before them."""
    for task, seconds in found.least.items():
        if task in found.waits:
            yield t("floor.wait", seconds=t.number(found.waits[task]))
        yield t.number(seconds)


def _load_words(found: Bottleneck, t: Words) -> str:
    ahead, behind = (
        t(f"floor.{key}", seconds=t.seconds(rest)) if rest else ""
        for key, rest in zip(("ahead", "behind"), found.rest, strict=True)
    )
    return t.count(
        "floor.load",
        len(found.tasks),
        who=found.operators[0],
        names=listed(t, found.tasks),
        ahead=ahead,
        total=t.seconds(sum(found.least.values())),
        behind=behind,
    )


def _group_sentences(found: Bottleneck, t: Words) -> list[str]:
    if len(found.tasks) < len(found.cell.tasks):
        missing = [task for task in found.cell.tasks if task not in found.tasks]
        few = len(missing) <= 3
        which = (
            t("floor.but", names=listed(t, missing, word=False)) if few else listed(t, found.tasks)
        )
        fewer = "" if found.smallest else t("floor.fewer")
        count = 2 if few else len(found.tasks)
        said = [t.count("floor.need", count, which=which, open=fewer)]
    else:
        said = [t("floor.every" if found.smallest else "floor.none")]
    if found.needs_order is False:
        said.append(t("floor.order"))
    sooner = ", ".join(f"{task}: {t.seconds(after)}" for task, after in found.without.items())
    return [*said, t("floor.without", sooner=sooner)] if sooner else said


def _stretches(found: Bottleneck, t: Words) -> str:
    """The critical path as stretches of work: "tasks 1, 2 and 4 keep robot busy until 18 s, then 6
    keeps human busy until 21 s".
    """
    path = critical_path(found.cell, found.schedule)
    runs = [
        (who, list(links))
        for who, links in groupby(path, key=lambda link: link.assignment.operators)
    ]
    said = [
        t.count(
            f"stretch.{'next' if place else 'first'}",
            len(links),
            names=listed(t, [link.assignment.task for link in links], word=False),
            who=together(t, who),
            end=t.seconds(links[-1].assignment.end),
        )
        for place, (who, links) in enumerate(runs)
    ]
    whole = t("stretch.then").join(said)
    begin = path[0].assignment.start if path else 0.0
    return t("stretch.from", begin=t.seconds(begin), stretches=whole) if begin else whole
