"""What is said of a plan that was carried over into a changed cell: of the old plan, of the limits,
and of what changes.
"""

from __future__ import annotations

from collections.abc import Iterator

from tandem.plan.replanned import Replan, Replanned
from tandem.plan.result import Result
from tandem.report.language import Words
from tandem.schedule.changes import Changed, Changes
from tandem.schedule.measures import exact


def about(found: Replanned, old: Result, t: Words) -> Iterator[str]:
    """The old plan, the new optimum and the limits that follow from it, and what may not move."""
    yield t("replan.old", **_worth(old, t))
    yield _about_the_optimum(found, t)
    if found.kept:
        whys = dict.fromkeys(why for _, why in found.kept)
        groups = (
            f"{t('replan.kept.' + why)} {', '.join(task for task, own in found.kept if own == why)}"
            for why in whys
        )
        yield t("replan.kept", tasks="; ".join(groups))


def about_the_plan(found: Replanned, t: Words) -> Iterator[str]:
    """The one new plan, and task by task what it changes."""
    proof = t("replan.proven") if found.complete else _open(found, t)
    yield t("replan.new", **_worth(found[0], t), proof=proof)
    yield ""
    yield counted(found.changes, t)
    yield from (f"  {told(changed, t)}" for changed in found.changes.changed)


def rows_of_the_front(found: Replanned, t: Words) -> list[tuple[str, ...]]:
    """A row for each point of the front of changes and makespan, the first being the header."""
    columns = ("changed", "operator", "order", "start", "makespan", "stress", "status", "plan")
    rows = [tuple(t(f"replan.column.{column}") for column in columns)]
    for result in reversed(found.results):
        assert isinstance(result, Replan)
        counts = result.changes.counts
        rows.append(
            (
                str(sum(counts)),
                *map(str, counts),
                t.seconds(result.makespan),
                t.number(result.stress),
                t("replan.status.proven" if result.status == "optimal" else "replan.status.open"),
                result.schedule.digest,
            )
        )
    return rows


def _worth(result: Result, t: Words) -> dict[str, str]:
    return {
        "digest": result.schedule.digest,
        "makespan": t.seconds(result.makespan),
        "stress": t.number(result.stress),
    }


def _open(found: Replanned, t: Words) -> str:
    return t(
        "replan.open",
        **{what: found.at_least.get(what, 0) for what in ("operator", "order", "start")},
    )


def _about_the_optimum(found: Replanned, t: Words) -> str:
    optimum, limits = found.optimum, found.question
    said = t("replan.optimum", makespan=t.seconds(optimum.makespan))
    if not optimum.proven:
        said += t("replan.optimum.open", bound=t.seconds(optimum.bound))
    if optimum.stress is not None:
        said += t("replan.optimum.stress", stress=t.number(optimum.stress))
        if optimum.reachable is None:
            said += t("replan.optimum.unknown")
        elif not optimum.reachable:
            said += t("replan.optimum.unreachable")
    allowed = [
        *(
            [t("terminal.limit.makespan", limit=t.seconds(limits.max_makespan))]
            if limits.max_makespan is not None
            else []
        ),
        *(
            [t("terminal.limit.stress", limit=t.number(limits.max_stress))]
            if limits.max_stress is not None
            else []
        ),
    ]
    if allowed:
        both = allowed[0] if len(allowed) == 1 else t("and", first=allowed[0], last=allowed[1])
        said += t("replan.allowed", percent=t.number(found.allow), limits=both)
    return f"{said}."


def counted(changes: Changes, t: Words) -> str:
    """How many tasks change, and how."""
    others, order, moves = changes.counts
    said = [
        t.count("replan.count.operator", others),
        t.count("replan.count.order", order),
        t.count("replan.count.start", moves, tolerance=t.seconds(changes.tolerance)),
        t("replan.count.same", n=changes.same),
        *([t("replan.count.new", tasks=", ".join(changes.new))] if changes.new else []),
        *([t("replan.count.gone", tasks=", ".join(changes.gone))] if changes.gone else []),
    ]
    return f"{', '.join(said)}."


def told(changed: Changed, t: Words) -> str:
    """One task: what of it changes, who does it, and when it starts."""
    who = " + ".join(changed.after.operators)
    if changed.what == "operator":
        who = f"{' + '.join(changed.before.operators)} -> {who}"
    start, moved = changed.after.start, exact(changed.after.start) - exact(changed.before.start)
    when = t("replan.start.same", start=t.seconds(start))
    if moved:
        when = t(
            "replan.start.moved",
            before=t.seconds(changed.before.start),
            after=t.seconds(start),
            by=t.signed(float(moved)),
        )
    what = t(f"replan.what.{changed.what}")
    return t("replan.task", task=changed.task, what=what, who=who, when=when)
