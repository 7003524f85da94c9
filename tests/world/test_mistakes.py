"""What goes wrong is put right: from every wrong state the assembly is completed, and the best
repair takes what value iteration says.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.world.arrays import NEVER, Arrays, Names
from tandem.world.episode import Shift, expected_ends, play_many
from tandem.world.population import crowd
from tandem.world.randomness import Chance, Draw
from tandem.world.state import (
    State,
    advance,
    assign,
    is_done,
    legal,
    legal_of,
    may_wait,
    mounted,
    out_of_order,
    reset,
    to_undo,
    turn,
    wait,
)

TIME = {"a": (3, 4), "b": (5, 3), "c": (4, 2)}
"""Seconds of robot and human; c comes after a."""
UNDO = 0.5


def small() -> Cell:
    return cell_of(
        {
            "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tasks": {
                name: {
                    "time": {"robot": float(robot), "human": float(human)},
                    "after": ["a"] if name == "c" else [],
                }
                for name, (robot, human) in TIME.items()
            },
        }
    )


@cache
def world(per_second: int = 2) -> tuple[Names, Arrays]:
    names = Names.of(small(), per_second=per_second)
    return names, names.arrays(undo=UNDO)


def test_what_stands_on_a_mistake_comes_off_first() -> None:
    names, arrays = world()
    state = assign(
        arrays, reset(arrays), np.int32(names.way("a", ["robot"])), noticed=np.int32(100)
    )
    for _ in range(2):
        state = advance(arrays, state)
        if len(np.flatnonzero(legal(arrays, state))):
            break
    state = assign(arrays, state, np.int32(names.way("c", ["human"])))
    state = assign(arrays, state, np.int32(names.way("b", ["robot"])))
    while not to_undo(arrays, state).any():
        state = advance(arrays, state)
    assert to_undo(arrays, state).tolist() == [
        True,
        False,
        True,
    ], "a was done wrongly, c stands on it, b does not"
    assert {names.ways[way][0] for way in np.flatnonzero(legal(arrays, state))} == {"c"}
    state = advance(arrays, assign(arrays, state, np.int32(names.way("c", ["human"]))))
    assert {names.ways[way][0] for way in np.flatnonzero(legal(arrays, state))} == {"a"}
    assert not is_done(state)


def test_a_hidden_mistake_is_noticed_when_all_stands() -> None:
    names, arrays = world()
    state = reset(arrays)
    for task in ("a", "c", "b"):
        state = advance(
            arrays,
            assign(
                arrays,
                state,
                np.int32(names.way(task, ["human"])),
                noticed=np.int32(10_000) if task == "b" else None,
            ),
        )
    assert mounted(state).all()
    assert not is_done(state)
    assert to_undo(arrays, state).tolist() == [False, True, False]


def reachable(arrays: Arrays) -> Iterator[State]:
    """Every situation that decisions, waiting and mistakes of both kinds, noticed at once or later,
    can lead to; the clock set to 0.
    """
    start = reset(arrays)
    seen, open_states = set(), [start]
    while open_states:
        state = open_states.pop()
        if (key := key_of(state)) in seen:
            continue
        seen.add(key)
        yield state
        mask = legal(arrays, state)
        who = turn(arrays, mask)
        if who < 0:
            open_states += [] if is_done(state) else [from_now(advance(arrays, state))]
            continue
        for way in np.flatnonzero(legal_of(arrays, mask | out_of_order(arrays, state), who)):
            when = (
                [0, 3]
                if not mask[way]
                else (
                    [None]
                    if to_undo(arrays, state)[arrays.way_task[way]] or not arrays.human[who]
                    else [None, 0, 3]
                )
            )
            open_states += [
                assign(
                    arrays, state, np.int32(way), noticed=None if ticks is None else np.int32(ticks)
                )
                for ticks in when
            ]
        if may_wait(arrays, state, mask, who):
            open_states.append(wait(state, who))


def key_of(state: State) -> bytes:
    return b"".join(np.ascontiguousarray(part).tobytes() for part in state[1:-1])


def from_now(state: State) -> State:
    def since(ticks: np.ndarray) -> np.ndarray:
        return np.where(ticks == NEVER, NEVER, np.maximum(ticks - state.clock, 0)).astype(np.int32)

    moved = {key: since(getattr(state, key)) for key in ("end_at", "free_at", "bad_at")}
    return state._replace(
        clock=np.zeros((), np.int32),
        start_at=state.start_at * 0,
        load=state.load * 0,
        tries=state.tries * 0,
        **moved,
    )


def test_from_every_wrong_state_the_assembly_is_completed() -> None:
    _, arrays = world(per_second=2)
    states = list(reachable(arrays))
    wrong = [state for state in states if to_undo(arrays, state).any()]
    assert len(wrong) > 200
    completed: set[bytes] = set()
    for state in wrong:
        path = []
        for _ in range(60):
            path.append(key_of(state))
            if path[-1] in completed or is_done(state):
                completed.update(path)
                break
            mask = legal(arrays, state)
            state = (
                from_now(advance(arrays, state))
                if turn(arrays, mask) < 0
                else assign(arrays, state, np.int32(np.flatnonzero(mask)[-1]))
            )
        assert path[0] in completed


OPEN, RIGHT, WRONG, DOING, UNDOING = range(5)
"""What value iteration knows of a task; who is at it stands beside."""


class Repair:
    """Value iteration for the small cell, in plain Python, apart from the world: states are what is
    known at a decision.

    A state: per task its status, who is at it (0 robot, 1 human, -1 nobody) and the seconds
    (doubled) that are left; who has let its turn pass. The human decides first. A human's work goes
    wrong with probability p, seen at its end; anyone may take it apart in half the time.
    """

    def __init__(self, p: float):
        self.p, self.names = p, list(TIME)
        self.value: dict[tuple, float] = {}
        self.best: dict[tuple, int | None] = {}
        self.order: list[tuple] = []
        start = (tuple((OPEN, -1, 0) for _ in self.names), (False, False))
        self.explore(start)
        for _ in range(400):
            worst = 0.0
            for state in reversed(self.order):
                new, self.best[state] = self.backup(state)
                worst = max(worst, abs(new - self.value[state]))
                self.value[state] = new
            if worst < 1e-10:
                break
        self.start = self.value[start]

    def explore(self, start: tuple) -> None:
        todo = [start]
        while todo:
            state = todo.pop()
            if state in self.value:
                continue
            self.value[state] = 0.0
            self.order.append(state)
            todo += [after for _, _, afters in self.moves(state) for _, after in afters]

    def backup(self, state: tuple) -> tuple[float, int | None]:
        found = [
            (cost + sum(share * self.value[after] for share, after in afters), task)
            for cost, task, afters in self.moves(state)
        ]
        return min(found, key=lambda pair: pair[0]) if found else (0.0, None)

    def who(self, state: tuple) -> int | None:
        tasks, waits = state
        for agent in (1, 0):
            if not waits[agent] and all(by != agent for _, by, _ in tasks) and self.legal(state):
                return agent
        return None

    def legal(self, state: tuple) -> list[int]:
        tasks, _ = state
        status = {name: tasks[place][0] for place, name in enumerate(self.names)}
        able = {
            "a": status["a"] == OPEN or (status["a"] == WRONG and status["c"] == OPEN),
            "b": status["b"] in (OPEN, WRONG),
        }
        able["c"] = status["c"] == WRONG or (status["c"] == OPEN and status["a"] == RIGHT)
        return [place for place, name in enumerate(self.names) if able[name]]

    def moves(self, state: tuple) -> list[tuple[float, int | None, list[tuple[float, tuple]]]]:
        """(seconds, task or None for waiting and for time running on, [(probability, state)])."""
        tasks, waits = state
        if all(status == RIGHT for status, _, _ in tasks):
            return []
        agent = self.who(state)
        if agent is None:
            return [self.run_on(state)]
        found = []
        for place in self.legal(state):
            status = tasks[place][0]
            # half seconds; half the time to take apart
            left = TIME[self.names[place]][agent] * (2 if status == OPEN else 1)
            begun = tuple(
                (DOING if status == OPEN else UNDOING, agent, left) if i == place else task
                for i, task in enumerate(tasks)
            )
            found.append((0.0, place, [(1.0, (begun, waits))]))
        passed = tuple(waits[i] or i == agent for i in (0, 1))
        busy = any(by >= 0 for _, by, _ in tasks)
        if busy or self.who((tasks, passed)) is not None:
            found.append((0.0, None, [(1.0, (tasks, passed))]))
        return found

    def run_on(self, state: tuple) -> tuple[float, None, list[tuple[float, tuple]]]:
        tasks, _ = state
        step = min(left for _, by, left in tasks if by >= 0)
        afters = [(1.0, ())]
        for status, by, left in tasks:
            if by < 0:
                outcomes = [(1.0, (status, by, left))]
            elif left > step:
                outcomes = [(1.0, (status, by, left - step))]
            elif status == UNDOING:
                outcomes = [(1.0, (OPEN, -1, 0))]
            else:
                p = self.p if by == 1 else 0.0
                outcomes = [(1 - p, (RIGHT, -1, 0)), *([(p, (WRONG, -1, 0))] if p else [])]
            afters = [
                (share * chance, (*before, outcome))
                for share, before in afters
                for chance, outcome in outcomes
            ]
        return step / 2, None, [(share, (after, (False, False))) for share, after in afters]


def test_the_best_repair_takes_what_value_iteration_says() -> None:
    """The policy of a value iteration written apart from the world, played in it: its mean makespan
    is the value, within four standard errors.
    """
    p, episodes = 0.3, 8192
    plan = Repair(p)
    names, arrays = world(per_second=2)
    lefts = 2 * max(map(max, TIME.values())) + 1
    # Per task: open, right, wrong, doing or undoing by robot or human (two spare); ticks; turn.
    table = np.full((9**3 * lefts * 2,), -1, np.int32)
    code = {OPEN: 0, RIGHT: 1, WRONG: 2}
    for (tasks, waits), task in plan.best.items():
        who = plan.who((tasks, waits))
        if who is None or task is None:
            continue
        places = [
            code[status] if by < 0 else 3 + 2 * (status == UNDOING) + by for status, by, _ in tasks
        ]
        left = max(left for _, _, left in tasks)
        way = names.way(plan.names[task], [("robot", "human")[who]])
        table[((places[0] * 9 + places[1]) * 9 + places[2]) * lefts * 2 + left * 2 + who] = way

    def decide(arrays: Arrays, shift: Shift) -> jax.Array:
        state = shift.state
        running = (state.way >= 0) & ~mounted(state)
        by_human = jnp.any(
            (jnp.arange(6)[:, None] == state.way[None, :]) & arrays.way_uses[:, 1:], axis=0
        )
        status = jnp.where(to_undo(arrays, state), 2, jnp.where(mounted(state), 1, 0))
        status = jnp.where(running, 3 + 2 * state.undoing + by_human, status)
        left = jnp.max(jnp.where(running, expected_ends(arrays, state) - state.clock, 0))
        return jnp.asarray(table)[
            ((status[0] * 9 + status[1]) * 9 + status[2]) * lefts * 2 + left * 2 + (shift.turn == 1)
        ]

    people = crowd(f"forgetful:{p}", names, arrays).draw(np.random.default_rng(0), episodes)
    draw = Draw.of(names, arrays, Chance(undo=UNDO, wrong_order=0.0, later=0.0))
    played = play_many(jax.random.key(0), draw, arrays, people, decide)
    assert played.done.all()
    seconds = np.asarray(played.makespan) / 2
    assert plan.start > 6.0, "mistakes cost something"
    assert abs(seconds.mean() - plan.start) < 4 * seconds.std() / episodes**0.5
    assert int(played.shift.illegal.sum()) == 0
