"""`tandem plan --explain-bound`: the chain of proofs behind each point of a front, from sums that
anyone can check to where CP-SAT took over, and what the dynamic program confirmed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.explain.language import Words, listed, words
from tandem.plan.bounds import (
    chain_bound,
    load_bound,
    longest_chain,
    own_loads,
    own_work,
    reckoned,
)
from tandem.plan.confirm import MOST_STATES, MOST_TASKS, Confirmable
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.provers import Prover, Step
from tandem.plan.result import Front, Outcome, Result
from tandem.schedule.measures import exact


@dataclass(frozen=True)
class Reckoned:
    """The bounds that need no search; seconds, and the cell's measure of stress.

    Attributes:
      chain: tasks that must follow one another -> seconds of each in its quickest way.
      begin: seconds before which the first of them cannot start.
      chain_s: how long they take at least, waits included.
      load: operator -> tasks that only they can do or take part in, and by when those are done at
        the soonest, what must lie before and behind them included.
      shared_s: the work of all tasks, shared out at its best as if it could be split.
      stress: every task done by whoever it strains least.
    """

    chain: dict[str, float]
    begin: float
    chain_s: float
    load: dict[str, tuple[tuple[str, ...], float]]
    shared_s: float
    stress: float

    @classmethod
    def of(cls, cell: Cell) -> Reckoned:
        """Of this cell."""
        instance = Instance.of(cell)
        layout = Layout.of(instance)
        names, seconds = instance.tasks, instance.seconds
        chain = longest_chain(layout)
        return cls(
            {names[task]: seconds(layout.quickest[task]) for task in chain},
            seconds(layout.head[chain[0]]) if chain else 0.0,
            seconds(chain_bound(layout)),
            {
                operator: (tuple(names[task] for task in mine), seconds(ticks))
                for operator, mine, ticks in zip(
                    instance.operators, own_work(layout), own_loads(layout), strict=True
                )
                if mine
            },
            seconds(load_bound(layout)),
            reckoned(layout).stress,
        )

    def sentences(self, t: Words) -> list[str]:
        """One for each bound."""
        parts = " + ".join(t.number(seconds) for seconds in self.chain.values())
        waits = exact(self.chain_s) - exact(self.begin) - sum(map(exact, self.chain.values()))
        begin = t("floor.from", seconds=t.seconds(self.begin)) if self.begin else ""
        lines = [
            t(
                "bounds.chain",
                least=t.seconds(self.chain_s),
                names=listed(t, list(self.chain)),
                parts=parts,
                begin=begin,
                waits=t("bounds.waits", seconds=t.seconds(float(waits))) if waits else "",
            )
        ]
        for operator, (tasks, seconds) in self.load.items():
            names = listed(t, list(tasks))
            lines.append(t("bounds.load", least=t.seconds(seconds), who=operator, names=names))
        return [
            *lines,
            t("bounds.shared", least=t.seconds(self.shared_s)),
            t("bounds.stress", least=t.number(self.stress)),
        ]

    def to_dict(self) -> dict[str, Any]:
        """The `reckoned` of a document."""
        load = {
            operator: {"tasks": list(tasks), "makespan": plain(seconds)}
            for operator, (tasks, seconds) in self.load.items()
        }
        chain = {"tasks": plain(self.chain), "begin": plain(self.begin)}
        return {
            str(Prover.CHAIN): {**chain, "makespan": plain(self.chain_s)},
            str(Prover.LOAD): load,
            str(Prover.SHARED): {"makespan": plain(self.shared_s)},
            str(Prover.LEAST_STRESS): {"stress": plain(self.stress)},
        }


@dataclass(frozen=True)
class ProofChain:
    """Who proved what of a front: the bounds that need no search, and what each search added."""

    front: Front
    reckoned: Reckoned

    @classmethod
    def of(cls, front: Front) -> ProofChain:
        """Of this front, whose results still know their steps."""
        return cls(front, Reckoned.of(front.cell))

    def sentences(self, language: str = "en") -> list[str]:
        """What can be reckoned, then each point, then the second opinion."""
        t = words(language)
        lines = [t("bounds.head"), *(f"  {line}" for line in self.reckoned.sentences(t))]
        for place, result in enumerate(self.front, 1):
            lines += _of_point(place, result, t)
        return [*lines, self._second_opinion(t)]

    def _second_opinion(self, t: Words) -> str:
        front = self.front
        if front.confirmation is not None:
            key = {
                Outcome.AGREES: "agrees",
                Outcome.DISAGREES: "disagrees",
                Outcome.OPEN: "open",
            }[front.confirmation.outcome]
            return t(f"bounds.{key}", states=t.number(front.confirmation.states))
        if not front.complete:
            return t("bounds.incomplete")
        if front.method == "exhaustive":
            return t("bounds.exhaustive")
        if front.question.minimize not in Confirmable:
            return t("bounds.not_asked")
        if len(front.cell.tasks) > MOST_TASKS:
            return t("bounds.large", tasks=len(front.cell.tasks), most=MOST_TASKS)
        return t("bounds.left_out")

    def to_dict(self, language: str = "en") -> dict[str, Any]:
        """The `bounds` of a result document; its sentences in this language."""
        return {
            "reckoned": self.reckoned.to_dict(),
            "points": [
                {
                    "makespan": _steps(result.bound.of_makespan),
                    "stress": _steps(result.bound.of_stress),
                }
                for result in self.front
            ],
            "most_states": MOST_STATES,
            "sentences": self.sentences(language),
        }


def _of_point(place: int, result: Result, t: Words) -> list[str]:
    lines = [
        t(
            "bounds.point",
            n=place,
            makespan=t.seconds(result.makespan),
            stress=t.number(result.stress),
        )
    ]
    rows = (
        ("makespan", result.bound.of_makespan, result.makespan, t.seconds),
        ("gentler", result.bound.of_stress, result.stress, t.number),
    )
    for key, steps, value, shown in rows:
        said = ", ".join(
            t("bounds.step", value=shown(step.value), by=prover(step.by, t)) for step in steps
        )
        proven = bool(steps) and steps[-1].value >= value
        end = t("bounds.proven") if proven else t("bounds.gap", found=shown(value))
        lines.append("  " + t(f"bounds.{key}", steps=said or t("bounds.nothing"), end=end))
    return lines


def prover(by: Prover, t: Words) -> str:
    """Who proved, in words."""
    return t(f"prover.{by.name.lower()}")


def _steps(steps: tuple[Step, ...]) -> list[dict[str, Any]]:
    return [{"by": str(step.by), "value": plain(step.value)} for step in steps]
