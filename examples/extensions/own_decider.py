"""A decider of your own: whoever may begin something begins what has the most work behind it.

    tandem simulate examples/thesis.yaml --policy fixed,own_decider:make --people random:0.5
    tandem dispatch examples/thesis.yaml --policy own_decider:make --simulate pace:1.5
    python examples/extensions/own_decider.py

In the folder of this file, or with it on PYTHONPATH. Nothing of Tandem is changed.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import tandem
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.reply import begins
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.situation.legal import legal, seconds
from tandem.dispatch.situation.model import Situation


@dataclass(frozen=True)
class MostBehindFirst:
    """What has the most tasks waiting for it first, by whoever is quickest at it."""

    behind: dict[str, int]
    name: str = "most-behind-first"

    def decide(self, situation: Situation) -> Decision:
        """Called at every event; the same situation has to give the same decision."""
        order = sorted(
            legal(situation),  # what may begin now, as (task, operators)
            key=lambda start: (-self.behind[start[0]], seconds(situation, *start), start),
        )
        # of the order whatever is still possible beside what stands before it
        return begins(situation, order, by=self.name, because="the most work waits for it")


def make(cell: tandem.Cell, objective: Objective, options: Options) -> MostBehindFirst:
    """The task with the most behind it first: an example of a decider of one's own."""
    behind = dict.fromkeys(cell.tasks, 0)
    for task in cell.tasks:
        waiting = {task}
        while waiting:
            waiting = {other for other in cell.tasks if waiting & set(cell.tasks[other].after)}
            behind[task] += len(waiting)
    return MostBehindFirst(behind)


def main() -> None:
    """Judged beside somebody who does half of what is asked."""
    parser = argparse.ArgumentParser(description="A decider of one's own, judged.")
    parser.add_argument("--cell", default="examples/thesis.yaml")
    parser.add_argument("--people", default="random:0.5")
    parser.add_argument("--episodes", type=int, default=200)
    given = parser.parse_args()
    cell = tandem.load(given.cell)
    policies = ["fixed", make]
    for document in tandem.judge(cell, policies, given.people, given.episodes):
        for row in document["policies"]:
            print(f"{row['policy']}: {row['makespan']['mean']} s")


if __name__ == "__main__":
    main()
