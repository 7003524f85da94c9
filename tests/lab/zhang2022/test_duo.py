"""Robot and human side by side: what they may choose, what it costs, what may happen, and what is
exact about it. In NumPy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.files.validate import cell_of
from tandem.lab.zhang2022 import (
    Kind,
    choices,
    duo,
    happen,
    is_done,
    narrow,
    observe,
    possible,
    reset,
    setting,
    step,
)
from tandem.lab.zhang2022.change import Change
from tandem.lab.zhang2022.setting import HUMAN, RECOVERY, ROBOT
from tandem.lab.zhang2022.world import chance, cost, now, observation_size, tired
from tandem.lab.zhang2022.yardstick import (
    as_stress,
    best_of_rest,
    exact_front,
    matching,
    rest,
)
from tandem.learn.baseline import best_rule
from tandem.schedule.checker import faults
from tandem.schedule.measures import difficulty, makespan
from tandem.world import state as events
from tandem.world.arrays import NEVER

CALM = Change(np.int32(NEVER), np.float32(0), np.float32(0))

SMALL = {
    "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
    "tools": {
        "press": {"changeover": {"robot": 3, "human": 1}},
        "driver": {"changeover": {"robot": 2}},
    },
    "tasks": {
        "a": {
            "time": {"robot": 5, "human": 4},
            "difficulty": {"robot": 1, "human": 3},
            "tool": "press",
        },
        "b": {
            "time": {"robot": 6, "human": 5},
            "difficulty": {"robot": 1, "human": 2},
            "tool": "driver",
        },
        "c": {
            "time": {"human": 9},
            "together": [{"operators": ["robot", "human"], "time": 4}],
            "difficulty": {"robot": 1, "human": 4},
            "after": ["a"],
        },
        "d": {
            "time": {"robot": 7, "human": 7},
            "difficulty": {"robot": 2, "human": 2},
            "after": ["a", "b"],
            "tool": "press",
        },
    },
}


@pytest.fixture(scope="module")
def small() -> Cell:
    return cell_of(SMALL)


@pytest.fixture(scope="module")
def alternator() -> Cell:
    return tandem.load("examples/alternator.yaml")


@dataclass
class Game:
    """One assembly in NumPy."""

    cell: Cell
    change: Change = CALM
    numbers: Any = field(default_factory=setting)

    def __post_init__(self) -> None:
        self.data, self.names = duo(self.cell)
        self.state = reset(self.data, np.ones(len(self.cell.tasks), np.float32), self.change)
        self.seconds, self.difficulty, self.tired = 0.0, 0.0, 0.0

    @property
    def pairs(self) -> list[tuple[int, int]]:
        legal = choices(self.data, self.state)
        rows = [
            (int(human), narrow(self.data, self.state, legal, np.int32(human)))
            for human in np.flatnonzero(legal[HUMAN])
        ]
        return [(int(robot), human) for human, row in rows for robot in np.flatnonzero(row)]

    def way(self, agent: int, choice: int) -> int:
        return int(np.argmax(self.data.pick[agent, choice])) if choice else -1

    def choice(self, agent: int, way: int) -> int:
        return int(np.argmax(self.data.pick[agent, :, way]))

    def play(self, pair: tuple[int, int]) -> None:
        self.state, paid = step(self.data, self.numbers, self.state, np.array(pair, np.int32))
        self.seconds += float(paid.seconds)
        self.difficulty += float(paid.difficulty.sum())
        self.tired += float(paid.fatigue)

    def at_random(self, seed: int) -> None:
        draw = np.random.default_rng(seed)
        while not is_done(self.state):
            self.play(self.pairs[draw.integers(len(self.pairs))])

    @property
    def schedule(self) -> Any:
        return self.names.schedule(
            self.state.assembly.way, self.state.assembly.start_at, self.state.assembly.end_at
        )


@pytest.mark.parametrize("seed", range(8))
def test_whatever_is_allowed_makes_a_sound_schedule_of_the_stated_cost(
    alternator: Cell, seed: int
) -> None:
    game = Game(alternator)
    game.at_random(seed)
    assert faults(alternator, game.schedule) == []
    assert makespan(game.schedule) == pytest.approx(game.seconds, abs=1e-3)
    assert difficulty(alternator, game.schedule) == game.difficulty


@pytest.mark.parametrize("seed", range(3))
def test_the_allowed_pairs_are_those_of_the_event_world_one_after_the_other(
    alternator: Cell, seed: int
) -> None:
    """The human's operation begins; what is then legal for the robot alone is its row."""
    game, draw = Game(alternator), np.random.default_rng(seed)
    while not is_done(game.state):
        arrays, assembly = now(game.data, game.state), game.state.assembly
        ways, expected = events.legal(arrays, assembly), set()
        running = events.next_event(arrays, assembly) < NEVER
        for human in range(game.data.pick.shape[1]):
            named = game.way(HUMAN, human)
            if human and not (game.data.pick[HUMAN, human] & ways).any():
                continue
            if human and game.data.joint[named]:
                expected.add((game.choice(ROBOT, named), human))
                continue
            after = events.legal(arrays, events.assign(arrays, assembly, np.int32(named)))
            alone = {
                game.choice(ROBOT, way)
                for way in np.flatnonzero(
                    after & ~game.data.joint & arrays.way_uses[:, game.data.row[ROBOT]]
                )
            }
            expected |= {(robot, human) for robot in alone}
            if human or running or not (alone or ways.any()):
                expected.add((0, human))
        assert set(game.pairs) == expected
        game.play(game.pairs[draw.integers(len(game.pairs))])


def test_a_joint_operation_needs_both_and_is_paid_by_both(small: Cell) -> None:
    game = Game(small)
    a = game.names.way("a", ["robot"])
    game.play((game.choice(ROBOT, a), 0))
    assert (game.seconds, game.difficulty) == (5, 1)
    together = game.names.way("c", ["robot", "human"])
    pair = game.choice(ROBOT, together), game.choice(HUMAN, together)
    assert pair in game.pairs
    assert [other for other in game.pairs if (other[0] == pair[0]) != (other[1] == pair[1])] == []
    game.play(pair)
    assert (game.seconds, game.difficulty) == (9, 6)


def test_the_longest_wait_is_as_long_as_something_goes_on(small: Cell) -> None:
    game = Game(small)
    assert (0, 0) not in game.pairs
    game.play(
        (
            game.choice(ROBOT, game.names.way("a", ["robot"])),
            game.choice(HUMAN, game.names.way("b", ["human"])),
        )
    )
    assert not is_done(game.state)
    game.at_random(0)
    assert game.pairs == [(0, 0)]


def test_a_change_of_tool_takes_its_time_unless_there_was_time_for_it(small: Cell) -> None:
    game = Game(small)
    press, driver = game.names.way("a", ["robot"]), game.names.way("b", ["robot"])
    game.play((game.choice(ROBOT, press), 0))
    game.play((game.choice(ROBOT, driver), 0))
    assert game.seconds == 5 + 2 + 6


def test_every_point_of_the_front_can_be_chosen_step_by_step(alternator: Cell) -> None:
    front = exact_front(alternator)
    assert front.complete
    assert front.points[0][0] == 123
    for result in front:
        game = Game(alternator)
        due = [(row.start, game.names.way(row.task, row.operators)) for row in result.schedule]
        began: set[int] = set()
        while not is_done(game.state):
            pair = _as_planned(game, [way for _, way in due if way not in began], result.schedule)
            began |= {game.way(agent, pair[agent]) for agent in (ROBOT, HUMAN) if pair[agent]}
            game.play(pair)
        assert (game.seconds, game.difficulty) == (
            pytest.approx(result.makespan, abs=1e-3),
            result.stress,
        )
        assert difficulty(alternator, result.schedule) == result.stress


def _as_planned(game: Game, left: list[int], schedule: Any) -> tuple[int, int]:
    """Each agent begins its next planned way as soon as it is allowed, but takes no tool that is
    planned for the other before; else waits.
    """
    planned = {game.names.way(row.task, row.operators): row.start for row in schedule}
    legal = events.legal(now(game.data, game.state), game.state.assembly)
    tool = {way: game.cell.tasks[task].tool for way, (task, _) in enumerate(game.names.ways)}
    pair = [0, 0]
    for agent in (HUMAN, ROBOT):
        mine = [way for way in left if game.data.arrays.way_uses[way, game.data.row[agent]]]
        if (
            mine
            and legal[mine[0]]
            and not any(
                tool[way] == tool[mine[0]] is not None and planned[way] < planned[mine[0]]
                for way in left
            )
        ):
            pair[agent] = game.choice(agent, mine[0])
            left = [way for way in left if way != mine[0] or game.data.joint[way]]
    if (
        pair[ROBOT]
        and game.data.joint[game.way(ROBOT, pair[ROBOT])]
        and game.way(HUMAN, pair[HUMAN]) != game.way(ROBOT, pair[ROBOT])
    ):
        pair[ROBOT] = 0
    if (
        pair[HUMAN]
        and game.data.joint[game.way(HUMAN, pair[HUMAN])]
        and game.way(ROBOT, pair[ROBOT]) != game.way(HUMAN, pair[HUMAN])
    ):
        pair[HUMAN] = 0
    return pair[0], pair[1]


def test_the_planners_stress_of_the_variant_is_the_difficulty(small: Cell) -> None:
    variant = as_stress(small)
    assert variant.humans == ("robot", "human")
    for result in exact_front(small):
        assert difficulty(small, result.schedule) == result.stress
    assert sum(variant.modes("c")[1].stress.values()) == 5


def test_a_cell_without_difficulty_counts_its_stress() -> None:
    assert exact_front(tandem.load("examples/thesis.yaml")).points == [(23, 7), (24, 3), (34, 2)]


@pytest.mark.parametrize("seed", range(4))
def test_paid_and_the_best_of_the_rest_never_fall_below_the_optimum_and_meet_it_at_the_start(
    small: Cell, seed: int
) -> None:
    optimum = min(t + d for t, d in exact_front(small).points)
    game, draw, lowest = Game(small), np.random.default_rng(seed), []
    while True:
        left = best_of_rest(small, game.names, game.state.assembly, game.state.happened, 1, 1)
        assert left is not None
        lowest.append(game.seconds + game.difficulty + left)
        if is_done(game.state):
            break
        game.play(game.pairs[draw.integers(len(game.pairs))])
    assert lowest[0] == pytest.approx(optimum)
    assert all(later >= earlier - 1e-6 for earlier, later in pairwise(lowest))
    assert lowest[-1] == pytest.approx(game.seconds + game.difficulty)


# --- Changes ---


def changing(cell: Cell, at: int, kind: float, which: float, **numbers: float) -> Game:
    game = Game(cell, Change(np.int32(at), np.float32(kind), np.float32(which)), setting(**numbers))
    game.change = game.change._replace(at=np.int32(game.names.ticks(at)))
    game.state = game.state._replace(change=game.change)
    return game


@pytest.mark.parametrize("seed", range(12))
def test_after_a_change_everything_can_still_be_done(alternator: Cell, seed: int) -> None:
    draw = np.random.default_rng(seed)
    game = changing(alternator, int(draw.integers(5, 110)), draw.random(), draw.random())
    game.at_random(seed)
    assert game.state.happened.kind != Kind.NOTHING
    assert np.all(game.state.assembly.way >= 0)


def test_a_lost_ability_is_one_that_the_human_has_too(small: Cell) -> None:
    game = Game(small)
    ability, redo, missing = possible(game.data, game.state.assembly)
    assert ability.tolist() == [
        True,
        True,
        True,
    ], "press, driver, and the joint way of c, which the human can do alone"
    assert not redo.any()
    assert missing.tolist() == [True, True]
    after, happened = happen(
        game.data,
        game.state.assembly,
        Change(np.int32(1), np.float32(0.1), np.float32(0.0)),
        np.int32(9),
    )
    assert happened.kind == Kind.ABILITY_LOST
    lost = [
        f"{task} by {' and '.join(mode.operators)}"
        for way, (task, mode) in enumerate(game.names.ways)
        if after.refused[way]
    ]
    assert lost == ["a by robot", "d by robot"]


def test_a_part_is_redone_only_while_nothing_stands_on_it(small: Cell) -> None:
    game = changing(small, 8, 0.5, 0.0)
    game.play(
        (
            game.choice(ROBOT, game.names.way("a", ["robot"])),
            game.choice(HUMAN, game.names.way("b", ["human"])),
        )
    )
    assert (game.seconds, game.state.happened.kind) == (5, Kind.NOTHING)
    game.play((0, game.choice(HUMAN, game.names.way("c", ["human"]))))
    assert game.state.happened.kind == Kind.PART_REDONE
    assert game.state.assembly.way[1] == -1, "b is open again; a is not, because c has begun"
    game.at_random(1)
    assert game.difficulty >= 3 + 2 + 4


def test_a_missing_tool_comes_back(small: Cell) -> None:
    game = changing(small, 1, 0.9, 0.0, search=20)
    game.play((0, game.choice(HUMAN, game.names.way("b", ["human"]))))
    assert game.state.happened.kind == Kind.TOOL_MISSING
    assert game.state.happened.back_at.tolist() == [21_000, 0]
    assert game.state.assembly.clock == 21_000, "nobody can do anything before"
    assert (
        best_of_rest(small, game.names, game.state.assembly, game.state.happened, 1, 1) or 0
    ) > 0
    game.at_random(0)
    assert min(game.state.assembly.start_at[[0, 3]]) == 21_000
    assert best_of_rest(small, game.names, game.state.assembly, game.state.happened, 1, 1) == 0


def test_the_rest_is_a_cell_with_what_is_in_hand_and_what_was_lost(small: Cell) -> None:
    game = Game(small)
    arrays, assembly = game.data.arrays, game.state.assembly
    for task, who in (("a", "robot"), ("b", "human")):
        assembly = events.assign(arrays, assembly, np.int32(game.names.way(task, [who])))
    assembly = events.advance(arrays, assembly, np.int32(game.names.ticks(2)))
    assembly, happened = happen(
        game.data, assembly, Change(np.int32(0), np.float32(0), np.float32(0)), np.int32(0)
    )
    assert happened.kind == Kind.ABILITY_LOST
    left, before = rest(small, game.names, assembly, happened)
    assert left is not None
    assert before == 3, "the longest changeover"
    assert left.tasks["a"].time == {"robot": 3}, "in hand: it goes on for three seconds more"
    assert (left.tasks["a"].release, left.tasks["a"].deadline, left.tasks["a"].difficulty) == (
        3,
        6,
        {},
    )
    assert left.tasks["d"].time == {"human": 7}
    assert left.operators["robot"].tool == "press"


# --- Cost, fatigue, what is seen ---


def test_fatigue_grows_towards_one_and_fades() -> None:
    rate = np.float32(0.1)
    assert tired(np.float32(0), rate, np.float32(1), np.float32(10)) == pytest.approx(
        1 - math.exp(-1)
    )
    assert tired(np.float32(0.5), rate, np.float32(1), np.float32(10)) == pytest.approx(
        0.5 + 0.5 * (1 - math.exp(-1))
    )
    assert tired(np.float32(0.5), np.float32(0), np.float32(0.2), np.float32(5)) == pytest.approx(
        0.5 * math.exp(-1)
    )


def test_only_the_humans_own_work_tires_and_rest_recovers(small: Cell) -> None:
    game = Game(small)
    game.play((game.choice(ROBOT, game.names.way("a", ["robot"])), 0))
    assert game.state.fatigue == 0
    game.play((0, game.choice(HUMAN, game.names.way("c", ["human"]))))
    assert game.state.fatigue == pytest.approx(1 - math.exp(-0.15 * 9 / 60), rel=1e-4), (
        "the hardest operation"
    )
    before = float(game.state.fatigue)
    game.play((game.choice(ROBOT, game.names.way("b", ["robot"])), 0))
    assert game.state.fatigue == pytest.approx(before * math.exp(-RECOVERY * 6 / 60), rel=1e-4)


def test_a_tired_human_is_slower_when_the_setting_says_so(small: Cell) -> None:
    quick, slow = Game(small), Game(small, numbers=setting(slows=5.0, tires=20.0))
    for game in (quick, slow):
        game.play((0, game.choice(HUMAN, game.names.way("a", ["human"]))))
        game.play((0, game.choice(HUMAN, game.names.way("c", ["human"]))))
    assert quick.seconds == 13
    assert slow.seconds > 19


def test_both_pay_half_of_the_time_and_each_its_own_difficulty(small: Cell) -> None:
    data, _ = duo(small)
    state = reset(data, np.ones(4, np.float32), CALM)
    numbers = setting(time=2, difficulty=10)
    game = Game(small)
    pair = (
        game.choice(ROBOT, game.names.way("a", ["robot"])),
        game.choice(HUMAN, game.names.way("b", ["human"])),
    )
    _, paid = step(data, numbers, state, np.array(pair, np.int32))
    assert cost(numbers, paid).tolist() == [5 + 10, 5 + 20]


def test_real_times_have_the_mean_and_spread_that_were_asked_for(alternator: Cell) -> None:
    data, _ = duo(alternator)
    draw = np.random.default_rng(0)
    numbers = {
        "normal": draw.standard_normal((4000, 16)),
        "uniform": np.array([0.4, 0.5, 0.1, 0.2]),
    }
    pace, change = chance(numbers, data, setting(spread=0.3, change=0.5, early=0.2, late=0.6))
    assert pace.mean() == pytest.approx(1, abs=0.01)
    assert pace.std() == pytest.approx(0.3, abs=0.01)
    assert change.at * data.tick == pytest.approx(0.4 * float(data.work), abs=1e-3)
    assert chance(numbers, data, setting(change=0.3))[1].at == NEVER


def test_the_agents_see_the_bill_of_materials_and_not_the_future(small: Cell) -> None:
    game, late = Game(small), Game(small)
    late.state = late.state._replace(pace=np.full(4, 3.0, np.float32))
    pair = (
        game.choice(ROBOT, game.names.way("b", ["robot"])),
        game.choice(HUMAN, game.names.way("a", ["human"])),
    )
    seen = observe(game.data, game.state)
    assert seen.shape == (observation_size(game.data),)
    assert seen[:4].tolist() == [0, 0, 0, 0]
    game.play(pair)
    assert observe(game.data, game.state)[:8].tolist() == [
        1,
        0,
        0,
        0,
        0,
        1,
        0,
        0,
    ], "a done, b in hand"
    late.play(pair)
    assert late.state.assembly.clock == late.names.ticks(12), (
        "a took 12 s instead of 4; only then can somebody begin"
    )
    a = late.names.way("a", ["human"])
    under_way = events.advance(
        game.data.arrays,
        events.assign(game.data.arrays, Game(small).state.assembly, np.int32(a), np.int32(12_000)),
        np.int32(6000),
    )
    seen = observe(game.data, late.state._replace(assembly=under_way))
    assert seen[4:13].tolist() == [
        1,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
    ], "in hand; by its nominal time nothing is left of it"
    early = events.advance(
        game.data.arrays,
        events.assign(game.data.arrays, Game(small).state.assembly, np.int32(a), np.int32(12_000)),
        np.int32(1000),
    )
    assert observe(game.data, late.state._replace(assembly=early))[8] == pytest.approx(3 / 9)


# --- Words ---


def test_what_cannot_be_expressed_is_named_all_at_once() -> None:
    cell = cell_of(
        {
            "operators": {
                "ann": {"kind": "human", "stress_limit": 9},
                "bob": {"kind": "human"},
                "saw": {"kind": "machine"},
            },
            "tasks": {
                "x": {"time": {"ann": 3, "bob": 4}, "deadline": 50},
                "y": {"time": {"ann": 3}, "wait": {"after": "x", "at_least": 5}},
            },
            "zones": {"bench": {"apart": ["human", "robot"]}},
            "stress_of_set": {"x": 1},
        }
    )
    with pytest.raises(CellError) as error:
        duo(cell)
    for words in (
        "0 robots, 2 humans and 1 machine",
        "no zone that keeps kinds apart",
        "stress_of_set",
        "stress_limit",
        "leave the deadline out",
        "leave the wait out",
    ):
        assert words in str(error.value)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"tool": {"ann": "driver"}}, "these two agents know no tools per operator or group"),
        (
            {"together": [{"operators": ["ann", "bob"], "time": 2, "tool": "driver"}]},
            "these two agents know no tools per operator or group",
        ),
        ({"place": "bench"}, "know no ways to walk"),
    ],
)
def test_own_tools_and_ways_are_refused(more: dict[str, Any], words: str) -> None:
    cell = cell_of(
        {
            "operators": {"ann": {"kind": "human", "place": "shelf"}, "bob": {"kind": "robot"}},
            "tasks": {"x": {"time": {"ann": 3, "bob": 4}, **more}},
            "walk": {"ann": {"bench-shelf": 3}} if "place" in more else {},
        }
    )
    with pytest.raises(CellError, match=words):
        duo(cell)


def test_a_setting_checks_itself() -> None:
    with pytest.raises(UsageError, match=r"unit 0(.|\n)*change 2(.|\n)*early 3.*late 1"):
        setting(unit=0, change=2, early=3, late=1)
    with pytest.raises(UsageError, match="one of them must cost something"):
        setting(time=0, difficulty=0)


def test_the_matching_point_and_the_best_rule(small: Cell) -> None:
    points = exact_front(small).points
    assert matching(points, 1, 0) == points[0]
    assert matching(points, 0, 1) == points[-1]
    best = best_rule(as_stress(small), lambda makespan, difficulty: makespan + difficulty)
    assert best is not None
    assert best.result.makespan + best.result.stress >= min(map(sum, points))
