"""Many episodes at once under a decider in Python: the world moves them all together in JAX, the
decider is asked for each distinct situation once.

A decider's answer depends on what it sees alone, so episodes that look alike get the same answer.
Where times are certain, a thousand episodes meet a few hundred situations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tandem.dispatch.deciders.policy import Decision, Policy
from tandem.dispatch.evaluation.observed import Observer
from tandem.dispatch.evaluation.ticking import by_hand, compiled, rows
from tandem.world.arrays import NEVER, Arrays, Names
from tandem.world.episode import Shift
from tandem.world.people import Person
from tandem.world.randomness import Draw, Scenario, scenarios

FEW = 12
"""So many episodes are played in NumPy, one after the other: quicker than compiling."""
LIMIT = 1_000
"""Steps after which an episode counts as not finished."""


@dataclass(frozen=True)
class Outcome:
    """What came of `E` episodes.

    Attributes:
      makespan: `[E]` seconds; `stress`: `[E]`, the cell's measure; of an episode that did not
        finish, what it had come to.
      changes: `[E]`, how often a human was asked for another task although the one before was still
        open.
      done: `[E]` bool, all was done.
      latency_ms: of each decision that was really made.
    """

    makespan: np.ndarray[Any, Any]
    stress: np.ndarray[Any, Any]
    changes: np.ndarray[Any, Any]
    done: np.ndarray[Any, Any]
    latency_ms: np.ndarray[Any, Any]


@dataclass(frozen=True)
class EpisodeBatch:
    """Where episodes are played: a cell, its chance, and the chances drawn.

    Attributes:
      scenarios: with a leading axis `E`. `people`: `E` persons.
    """

    names: Names
    arrays: Arrays
    scenarios: Scenario
    people: Person
    taking_apart: float = 1.0

    @classmethod
    def of(
        cls, names: Names, arrays: Arrays, draw: Draw, people: Person, seed: int
    ) -> EpisodeBatch:
        """Draws the chances of as many episodes as there are people; the same seed gives the same
        ones, whoever decides.
        """
        import jax

        return cls(
            names,
            arrays,
            scenarios(jax.random.key(seed), draw, arrays, people.pace.shape[0]),
            people,
            draw.chance.undo,
        )

    def some(self, first: int, count: int) -> EpisodeBatch:
        """So many of the episodes, from that one on."""
        return replace(
            self,
            scenarios=rows(self.scenarios, count, first),
            people=rows(self.people, count, first),
        )

    def play(
        self,
        policy: Policy,
        count: int | None = None,
        *,
        between: Callable[[], None] = lambda: None,
    ) -> Outcome:
        """Plays all episodes under the decider, or the first `count` of them: the others stand
        still, so that nothing is compiled anew.

        `between`: called after each decision, when nobody waits.
        """
        count = len(self.people.pace) if count is None else min(count, len(self.people.pace))
        stage = self if count > FEW else self.some(0, count)
        return _Play(stage, policy, count, between).run()


@dataclass
class _Play:
    stage: EpisodeBatch
    policy: Policy
    count: int
    between: Callable[[], None]
    observer: Observer = field(init=False)
    known: dict[bytes, Decision] = field(default_factory=dict)
    latency_ms: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.observer = Observer(self.stage.names, self.stage.arrays, self.stage.taking_apart)

    def run(self) -> Outcome:
        stage, names = self.stage, self.stage.names
        # compiling takes seconds, which only many episodes win back
        begin, tick, end = compiled() if len(stage.people.pace) > FEW else by_hand()
        episodes, operators = len(stage.people.pace), len(names.operators)
        shift, over, off = begin(stage.arrays, stage.people)
        asked = np.full((episodes, operators), -1, np.int32)
        changes = np.zeros(episodes, np.int32)
        until = np.full(episodes, NEVER, np.int32)
        for _ in range(LIMIT):
            seen = _Seen.of(shift, asked, off)
            over = np.asarray(over)[: self.count]
            if over.all():
                break
            # time runs on, or stands still, in all episodes at once; where nobody's turn it is,
            # nothing is asked
            ways = np.full(episodes, -1, np.int32)
            turns = np.asarray(shift.turn)
            for number in np.flatnonzero((turns[: self.count] >= 0) & ~over):
                decision = self._decision(seen, int(number))
                turn = int(turns[number])
                ways[number] = self._way(decision, turn, seen.mask[number])
                # a decider may want to look again without an event; always later, or time would
                # stand still
                until[number] = (
                    NEVER
                    if decision.look_again is None
                    else max(names.ticks(decision.look_again), int(seen.clock[number]) + 1)
                )
                changes[number] += _announce(names, decision, asked[number], seen.open[number])
            shift, over, off = tick(stage.arrays, stage.scenarios, stage.people, shift, ways, until)
        return self._outcome(end(stage.arrays, shift), changes)

    def _decision(self, seen: _Seen, number: int) -> Decision:
        key = seen.keys[number].tobytes()
        known = self.known.get(key)
        if known is None:
            situation = self.observer.situation(seen.row(number))
            known = self.known[key] = self.policy.decide(situation)
            self.latency_ms.append(known.latency_ms)
            self.between()
        return known

    def _way(self, decision: Decision, turn: int, mask: Any) -> int:
        """What whose turn it is begins, by the decision; -1 for waiting."""
        names = self.stage.names
        who = names.operators[turn]
        for task, operators in (*decision.asks, *decision.starts):
            if who in operators and (way := names.way(task, operators)) >= 0:
                return way
        if who in decision.announced:
            task = decision.announced[who]
            mine = [
                way
                for way, (name, mode) in enumerate(names.ways)
                if name == task and who in mode.operators and mask[way]
            ]
            return min(mine, key=lambda way: len(names.ways[way][1].operators), default=-1)
        return -1

    def _outcome(self, told: tuple[Any, Any, Any], changes: Any) -> Outcome:
        names, mine = self.stage.names, slice(self.count)
        makespan, stress, done = (np.asarray(part)[mine] for part in told)
        return Outcome(
            makespan / names.per_second,
            stress / names.per_stress,
            changes[mine],
            done,
            np.array(self.latency_ms),
        )


@dataclass(frozen=True)
class _Seen:
    """What can be seen of all episodes, as NumPy arrays with a leading axis `E`."""

    fields: dict[str, Any]
    mask: Any
    keys: Any

    @classmethod
    def of(cls, shift: Shift, asked: Any, off: Any) -> _Seen:
        state = shift.state
        names = (
            "clock",
            "way",
            "start_at",
            "end_at",
            "away_until",
            "in_hand",
            "stands",
            "load",
            "refused",
            "undoing",
        )
        fields = {name: np.asarray(getattr(state, name)) for name in names}
        clock = fields["clock"][:, None]
        running = (fields["way"] >= 0) & (fields["end_at"] > clock)
        # how long it will still take is not to be seen
        fields["end_at"] = np.where(running, NEVER, fields["end_at"])
        fields["away_until"] = np.where(fields["away_until"] > clock, NEVER, 0)
        fields |= {"off": np.asarray(off), "asked": asked.copy()}
        episodes = len(fields["clock"])
        columns = [part.reshape(episodes, -1).astype(np.int32) for part in fields.values()]
        return cls(
            fields, np.asarray(shift.mask), np.ascontiguousarray(np.concatenate(columns, axis=1))
        )

    @property
    def clock(self) -> Any:
        return self.fields["clock"]

    @property
    def open(self) -> Any:
        """`[E, T]` bool, tasks that have not begun, or must come off."""
        off = self.fields["off"]
        return (self.fields["way"] < 0) | off if off.shape[1] else self.fields["way"] < 0

    def row(self, number: int) -> dict[str, Any]:
        return {name: part[number].tolist() for name, part in self.fields.items()}


def _announce(names: Names, decision: Decision, asked: Any, still_open: Any) -> int:
    """Writes down what was announced; gives how many humans are asked for another task although the
    one before is open.
    """
    changes = 0
    for human, task in decision.announced.items():
        operator, number = names.operators.index(human), names.tasks.index(task)
        changes += asked[operator] not in (-1, number) and bool(still_open[asked[operator]])
        asked[operator] = number
    return changes
