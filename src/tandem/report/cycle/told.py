"""What is said of a front of cycle times, whatever the form: the summary, how far a point is
proven, what a planner plans with.
"""

from __future__ import annotations

from collections.abc import Sequence

from tandem.cell.model import Cell
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.plan.result import Status
from tandem.report.language import Words
from tandem.report.sources import assumptions
from tandem.schedule.steady import rounds


def crew(cell: Cell, t: Words) -> list[str]:
    """How many humans, robots and machines there are, those that there are."""
    return [t.count(kind, len(names)) for kind, names in cell.crew.items()]


def listed(parts: Sequence[str], t: Words) -> str:
    """`one`, `one and two`, `one, two and three`."""
    if len(parts) < 2:
        return "".join(parts)
    return t("and", first=", ".join(parts[:-1]), last=parts[-1])


def limits(front: CycleFront, t: Words, *, within: bool = False) -> list[str]:
    """What was asked for; `within`: as it stands behind that word."""
    asked = front.question
    return [
        t(f"cycle.{'within' if within else 'limit'}.{key}", limit=words_of(limit))
        for key, limit, words_of in (
            ("takt", asked.takt, t.seconds),
            ("in_process", asked.max_in_process, t.number),
            ("stress", asked.max_stress, t.number),
        )
        if limit is not None
    ]


def mix(front: CycleFront, t: Words) -> str:
    """What a cycle makes, where that is not one product of the cell."""
    return listed([t("cycle.mix", n=count, name=name) for name, count in front.mix], t)


def values(front: CycleFront, result: CycleResult, t: Words) -> dict[str, str]:
    """The numbers of a point, as sentences take them."""
    return {
        "mix": mix(front, t),
        "cycle_time": t.seconds(result.cycle_time),
        "stress": t.number(result.stress),
        "makespan": t.seconds(result.makespan),
        "in_process": str(result.in_process),
        "per_hour": t.number(per_hour(front, result)),
    }


def per_hour(front: CycleFront, result: CycleResult) -> float:
    """Products in an hour, to a tenth."""
    return round(result.per_hour * front.products, 1)


def cost(front: CycleFront, result: CycleResult) -> float | None:
    """Of one product; None when the cell states no cost."""
    return None if result.cost is None else round(result.cost / front.products, 4)


def status(result: CycleResult, t: Words) -> str:
    """Proven, or the gap and the bounds."""
    if result.status == Status.OPTIMAL:
        return t("front.proven")
    return t(
        "cycle.gap",
        gap=t.share(result.gap),
        low_cycle_time=t.seconds(result.bound.cycle_time),
        low_stress=t.number(result.bound.stress),
    )


def in_process(result: CycleResult, t: Words) -> str:
    """How many products are in the station at most, and where fewer may do, the bound."""
    fewest = min(result.bound.in_process, result.in_process)
    shown = t.number(result.in_process)
    return shown if fewest == result.in_process else f"{shown} (>= {t.number(fewest)})"


def idle(result: CycleResult, t: Words) -> list[str]:
    """Every operator's idle share of the cycle."""
    turned, shown = rounds(result.cell, result.periodic), looks(result.cell)
    return [f"{shown[name].label} {t.share(own.share(own.idle))}" for name, own in turned.items()]


def which(front: CycleFront, result: CycleResult, t: Words) -> str:
    """Which of makespan and cycle time a planner needs."""
    return t("cycle.which.mix" if front.mix else "cycle.which", **values(front, result, t))


def more(front: CycleFront, result: CycleResult, t: Words) -> str:
    """What a point means for the station."""
    return t("cycle.more.mix" if front.mix else "cycle.more", **values(front, result, t))


def title(front: CycleFront, place: int, t: Words, *, knee: bool = False) -> str:
    """What a point is called: its number and values; place counted from 0."""
    result = front[place]
    key = "cycle.point.knee" if knee and len(front) > 2 and result is front.knee else "cycle.point"
    return t(key, n=place + 1, **values(front, result, t))


def summary(
    front: CycleFront, t: Words, point: int | None = None, stale: bool = False
) -> list[str]:
    """What a reader must know, in a few sentences; `point` was chosen, `stale` as in `write`."""
    cell = front.cell
    first = [
        t(
            "cycle.summary.mix" if front.mix else "cycle.summary.cell",
            mix=mix(front, t),
            tasks=t.count("task", len(cell.tasks)),
            operators=listed(crew(cell, t), t),
        )
    ]
    if asked := limits(front, t):
        first.append(t("cycle.summary.asked", limits=listed(asked, t)))
    warned = [t("summary.stale")] if stale else []
    if not len(front):
        return [*warned, " ".join(first), t("cycle.summary.none")]
    if len(front) == 1:
        first.append(t("cycle.summary.one", **values(front, front[0], t)))
    else:
        ends = {
            f"{end}_{key}": value
            for end, result in (("first", front[0]), ("last", front[len(front) - 1]))
            for key, value in values(front, result, t).items()
        }
        first.append(t("cycle.summary.many", n=len(front), **ends))
        first.append(
            t("cycle.summary.knee", n=front.knee_place + 1, **values(front, front.knee, t))
        )
    proof = "open" if not front.complete else "proven" if front.question.is_front else "answer"
    sentences = [" ".join(first), t(f"cycle.summary.{proof}")]
    sentences += [t("summary.interrupted")] if front.interrupted else []
    chosen = front.shown(point)
    if chosen is not front.knee:
        sentences.append(t("cycle.summary.shown", n=point, **values(front, chosen, t)))
    return [*warned, *sentences, which(front, chosen, t)]


def assumed(front: CycleFront, t: Words) -> list[str]:
    """What was modelled and how far it is proven, in sentences."""
    return [t("cycle.assume"), t("cycle.assume.lasting"), *assumptions(front, t)]
