"""A simulated floor: people, robots and chance that drive a shift by its own events, so that
everything can be tried without hardware.

The floor knows what nobody is told: how slow people are, what goes wrong, when somebody leaves. It
hears orders and announcements, and reports what happens. The same seed gives the same floor: told
the same, it reports the same, so that a shift that was cut off is picked up where it stopped.

A product is an episode of the world. The people are the same at all products, with what they have
got used to and how tired they are; who is away when a product begins is back then (ASSUMPTION).
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.journal import Entry
from tandem.dispatch.shift.documents import event_of, told
from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.model import Product, Situation, exact
from tandem.dispatch.situation.transitions import after, ordered
from tandem.errors import UsageError
from tandem.world import state as world
from tandem.world.arrays import NEVER, Arrays, Names
from tandem.world.episode import begin, decide, is_over
from tandem.world.people import Person, crew
from tandem.world.population import crowd
from tandem.world.randomness import OFF, Chance, Draw, away_until, next_absence, scenario

ROUNDS = 10
"""After so many rounds in which everybody was asked and nothing began or is to come, the floor
stands still for good.
"""


class SimulatedFloor:
    """A floor under way; its clock is the world's (`tandem.world.episode`), in ticks of the
    product.
    """

    def __init__(
        self,
        cell: Cell,
        people: str,
        chance: Chance = OFF,
        seed: int = 0,
        variants: Mapping[str, Cell] | None = None,
    ) -> None:
        """Draws who works today, and what will happen.

        Args:
          people: who, such as "compliant", "random:0.5" or "pace:2"; see `tandem.world.behaviour`.
          chance: what may happen besides.
          variants: cells of products that differ, by name.

        Raises:
          UsageError, CellError: `people` is wrong, or a cell is too large to be simulated.
        """
        self.spec, self.chance, self.seed = people, chance, seed
        self.stations: dict[str | None, tuple[Names, Arrays]] = {None: self._station(cell)}
        self.stations |= {name: self._station(one) for name, one in (variants or {}).items()}
        self.names, self.arrays = self.stations[None]
        self.pending: deque[Event] = deque()
        self.count, self.began, self.number = 0, 0.0, 1
        self._begin(Product(1))

    def _station(self, cell: Cell) -> tuple[Names, Arrays]:
        names = Names.of(cell)
        may_err = crowd(self.spec, names, names.arrays()).makes_mistakes
        return names, names.arrays(undo=self.chance.undo if may_err else None)

    def _begin(self, product: Product) -> None:
        """The product's own chance, and the same people."""
        self.names, self.arrays = self.stations[product.variant]
        rng = np.random.default_rng(self.seed)
        someone = crowd(self.spec, self.names, self.arrays).draw(rng, 1)
        if product.number > 1:
            rng = np.random.default_rng((self.seed, product.number))
        draw = Draw.of(self.names, self.arrays, self.chance)
        self.people = crew(self.arrays, Person(*(value[0] for value in someone)))
        self.scenario = scenario(draw, self.arrays, rng.random(draw.numbers, np.float32))
        self.episode = begin(self.arrays, self.people)

    def _next_product(self, situation: Situation, product: Product) -> None:
        """The shift has gone on to another product."""
        before = self.episode
        self._begin(product)
        self.episode = self.episode._replace(fatigue=before.fatigue, begun=before.begun)
        refused = np.array(
            [
                any((who, task) in situation.refused for who in way.operators)
                for task, way in self.names.ways
            ]
        )
        reset = self.episode.state
        state = reset._replace(
            refused=refused,
            in_hand=self._numbers(situation.in_hand, self.names.tools, reset.in_hand),
            stands=self._numbers(situation.stands, self.names.places, reset.stands),
        )
        self.episode = self.episode._replace(state=state)
        mask = world.legal(self.arrays, self.episode.state)
        self.episode = self.episode._replace(mask=mask, turn=world.turn(self.arrays, mask))
        self.began, self.number = situation.began, product.number
        self.pending.extend(
            Event(kind, self.now, operators=(who,))
            for kind, away in (("back", situation.absent), ("repaired", situation.failed))
            for who in sorted(away)
        )

    def _numbers(self, named: Mapping[str, str], names: Sequence[str], reset: Any) -> Any:
        """`[O]` int32, what each operator holds, or where it stands, as the world numbers it; as at
        the reset where the world does not know that name.
        """
        number = {name: place for place, name in enumerate(names)}
        return np.array(
            [
                number.get(named.get(who, ""), nothing)
                for who, nothing in zip(self.names.operators, reset.tolist(), strict=True)
            ],
            reset.dtype,
        ).reshape(reset.shape)

    def next(self, situation: Situation, look_again: float | None = None) -> Event | None:
        """What happens next, when this is what was told; None when nothing will happen any more.

        Args:
          look_again: when to report that time has passed, should nothing else happen before, s of
            the shift's clock.
        """
        if situation.product is None:
            return None
        if situation.product.number != self.number:
            self._next_product(situation, situation.product)
        standstill = 0
        while standstill < ROUNDS:
            while self.pending:
                event = self.pending.popleft()
                if event.kind != "wrong" or event.task in situation.done:
                    self.count += 1
                    return replace(event, id=f"sim-{self.count}")
            if is_over(self.arrays, self.episode):
                return None
            if self.episode.turn >= 0:
                self._somebody_decides(situation)
            else:
                standstill = 0 if self._time_runs_on(look_again) else standstill + 1
        return None

    def catch_up(self, situation: Situation, entries: Iterable[Entry]) -> None:
        """Lives through what the journal holds.

        Args:
          situation: the start of the shift.

        Raises:
          UsageError: other things happened there than would happen here: it is the journal of
            another floor.
        """
        look_again: float | None = None
        for entry in entries:
            if entry.event is not None:
                event = event_of(entry.event)
                if event != self.next(situation, look_again):
                    raise UsageError(
                        f"entry {entry.number} of the journal is not what happens on this simulated"
                        " floor. Simulate the people, chance and seed that it was begun with, or"
                        " name another journal."
                    )
                situation = after(situation, event)
            if entry.decision is not None:
                situation = ordered(situation, told(entry.decision), entry.number)
                look_again = entry.decision["look_again"]

    @property
    def now(self) -> float:
        """The shift's clock, s."""
        return exact(self.began + self.names.seconds(int(self.episode.state.clock)))

    def _somebody_decides(self, situation: Situation) -> None:
        """Whose turn it is hears what it was told, and begins something, refuses or waits."""
        before = self.episode
        who = self.names.operators[int(before.turn)]
        self.episode = decide(
            self.arrays,
            self.scenario,
            self.people,
            before,
            np.int32(self._way_told(situation, who)),
        )
        state = self.episode.state
        for index in np.flatnonzero(state.start_at != before.state.start_at):
            task, way = self.names.ways[int(state.way[index])]
            self.pending.append(Event("started", self.now, task, way.operators))
            self._is_noticed_when_out_of_turn(int(index))
        if (state.refused & ~before.state.refused).any():
            self.pending.append(Event("refused", self.now, situation.announced[who], (who,)))

    def _way_told(self, situation: Situation, who: str) -> int:
        """The way that the operator was told to begin, -1 when it was told to wait or cannot do as
        it was told.
        """
        mine = [
            (number, *self.names.ways[number])
            for number in np.flatnonzero(
                world.legal_of(self.arrays, self.episode.mask, self.episode.turn)
            )
        ]
        asked = situation.announced.get(who)
        orders = {
            task: order.operators
            for task, order in situation.orders.items()
            if who in order.operators
        }
        fitting = [
            (orders.get(task) != way.operators, way.time, number)
            for number, task, way in mine
            if (orders.get(task) == way.operators) or (task == asked and task not in orders)
        ]
        return int(min(fitting)[2]) if fitting else -1

    def _is_noticed_when_out_of_turn(self, index: int) -> None:
        """What is begun before its turn is known to be wrong when it ends: the shift has been told
        what it stands on.
        """
        state = self.episode.state
        if (
            state.bad_at.shape[0]
            and not state.undoing[index]
            and (self.arrays.needs[index] & ~world.mounted(state)).any()
        ):
            bad_at = state.bad_at.copy()
            bad_at[index] = state.end_at[index]
            self.episode = self.episode._replace(state=state._replace(bad_at=bad_at))

    def _time_runs_on(self, look_again: float | None) -> bool:
        """Time runs to what happens next, or to where somebody wanted to look again; False when it
        stands still.

        Where nothing would happen any more because somebody refused, they are asked again, as in
        the world's own episodes.
        """
        before = self.episode.state
        asked_again = int(world.next_event(self.arrays, before)) == NEVER and not before.waits.any()
        until = (
            next_absence(self.scenario, before.clock)
            if self.scenario.away_from.shape[0]
            else np.int32(NEVER)
        )
        if look_again is not None:
            until = np.int32(
                min(
                    int(until),
                    max(
                        int(before.clock) + 1,
                        math.ceil(exact(look_again - self.began) * self.names.per_second),
                    ),
                )
            )
        state = world.advance(self.arrays, before, until)
        if self.scenario.away_from.shape[0]:
            state = state._replace(away_until=away_until(self.scenario, state.clock))
        state = state._replace(refused=before.refused & (not asked_again))
        mask = world.legal(self.arrays, state)
        self.episode = self.episode._replace(
            state=state, mask=mask, turn=world.turn(self.arrays, mask)
        )
        self.pending.extend(self._reported(before, state))
        if not self.pending and state.clock > before.clock:
            self.pending.append(Event("tick", self.now))
        return bool(state.clock > before.clock)

    def _reported(self, before: world.State, state: world.State) -> Iterable[Event]:
        """What the floor sees of the time that has passed: work that ended, mistakes, who left and
        who came.
        """
        now, tasks = self.now, self.names.tasks
        for index in np.flatnonzero(
            (before.way >= 0) & (before.end_at > before.clock) & (before.end_at <= state.clock)
        ):
            undone = before.undoing.shape[0] and before.undoing[index]
            yield Event("undone" if undone else "done", now, tasks[index])
        if state.bad_at.shape[0]:
            yield from (
                Event("wrong", now, tasks[index])
                for index in np.flatnonzero(
                    (state.bad_at <= state.clock) & (before.bad_at > before.clock)
                )
            )
        for number, name in enumerate(self.names.operators):
            human = bool(self.arrays.human[number])
            was_away, is_away = (
                before.away_until[number] > before.clock,
                state.away_until[number] > state.clock,
            )
            if is_away and not was_away:
                yield Event("absent" if human else "failed", now, operators=(name,))
            elif was_away and not is_away:
                yield Event("back" if human else "repaired", now, operators=(name,))
