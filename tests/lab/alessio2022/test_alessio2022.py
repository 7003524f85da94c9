"""`tandem reproduce alessio2022`: the code of the long run at a size that fits here, its exact
parts, and what its stored result says.
"""

from __future__ import annotations

import json
import random

import numpy as np
import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

from tests.lab.changed_records import refuses_changed_records

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.dynamic_programming import minimax, values
from tandem.errors import CellError
from tandem.files.generators import layered
from tandem.lab.alessio2022 import cells as alessio_cells
from tandem.lab.alessio2022 import exact, experiment, grid_runs, layout, robots
from tandem.lab.alessio2022.cells import HOSTILE, as_state, nominal_robot, play, times, trade
from tandem.lab.alessio2022.grid_runs import ADVERSARIAL, DESCRIBED, PLAIN
from tandem.lab.kinat2023 import decisions
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.rewards import reward_set
from tandem.lab.kinat2023.station import station
from tandem.lab.kinat2023.world import HUMAN, ROBOT, reset
from tandem.lab.statistics import interval, larger, rank_sum
from tandem.plan.methods import plan


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("quick")
    return folder, experiment.reproduce(folder, quick=True)


@pytest.fixture(scope="module")
def long():
    return experiment.stored()


def test_a_changed_record_stops_the_reproduction(quick, tmp_path, capfd):
    refuses_changed_records(["reproduce", "alessio2022", "--quick"], quick[0], tmp_path, capfd)


def test_a_quick_run_is_kept_goes_on_and_says_that_it_is_one(quick):
    folder, document = quick
    assert json.loads((folder / "alessio2022.json").read_text()) == json.loads(json.dumps(document))
    assert experiment.reproduce(folder, quick=True) == document  # nothing is trained twice
    table = experiment.table(document)
    assert "quick run" in table
    assert all(name in table for name in (PLAIN, ADVERSARIAL))


def test_a_quick_run_draws_its_figures(quick, tmp_path):
    files = experiment.draw_figures(quick[1], tmp_path)
    assert {
        "blocked-crossing.svg",
        "film-crossing.svg",
        "success-crossing.svg",
        "price-of-robustness.png",
    } <= {file.name for file in files}
    assert all(file.stat().st_size > 2000 for file in files)


def test_a_learned_robot_is_never_better_than_the_exact_values(quick):
    document = quick[1]
    known = document["grids"][0]["exact"]
    for record in document["grids"][0]["records"]:
        assert record["greedy"]["worst"] is None or record["greedy"]["worst"] >= known["minimax"]
    for row in document["cells"]:
        assert all(
            pair[0] >= row["trade"][-1][1] and pair[1] >= row["trade"][0][0]
            for kind in ("untrained", "plain", "adversarial")
            for pair in row[kind]
        )


# --- What the long run says ---


def test_adversarial_training_beats_plain_training_against_the_adversary(long):
    """At least 10 seeds each; the difference is significant, and the p-value is that of the
    records.
    """
    grid = long["grids"][0]
    assert (grid["grid"], long["quick"], len(long["seeds"]) >= 10) == ("crossing", False, True)
    by_name = {
        name: [record for record in grid["records"] if record["training"] == name]
        for name in experiment.GRIDS["crossing"]
    }
    assert {len(own) for own in by_name.values()} == {len(long["seeds"])}
    rates = [
        [record["success"]["adversary"] for record in by_name[name]]
        for name in (ADVERSARIAL, PLAIN)
    ]
    assert larger(*rates) == pytest.approx(grid["tests"][0]["p"])
    assert grid["tests"][0]["p"] < 0.01


def test_the_stored_summary_and_exact_values_are_those_of_the_records_and_of_this_code(long):
    for grid in long["grids"]:
        drawn = layout(grid["grid"])
        assert list(drawn.rows) == grid["rows"]
        assert exact.minimax(drawn).moves == grid["exact"]["minimax"]
        assert experiment.summary(grid["records"]) == grid["summary"]


def test_a_robot_that_is_bounded_exactly_is_hardly_ever_spoiled_by_the_learned_adversary(long):
    """The learned best response is no stronger than the exact worst case. Draws leave a robot that
    is sure of itself some slips.
    """
    for record in long["grids"][0]["records"]:
        if record["greedy"]["worst"] is not None and record["training"] not in DESCRIBED:
            assert record["success"]["adversary"] > 0.5


def test_the_stored_games_show_the_claim(long):
    """Trained against an adversary the robot bars the wrong terminal state and reaches the right
    one; trained beside a random human it does not.
    """
    grid = long["grids"][0]
    drawn = layout(grid["grid"])
    for record in grid["records"]:
        last = [drawn.text[place] for place in record["greedy"]["pursued"][-1]]
        assert ("G" in last) == record["greedy"]["barred"]
    assert any(
        record["greedy"]["barred"]
        for record in grid["records"]
        if record["training"] == ADVERSARIAL
    )
    assert not any(
        record["greedy"]["barred"] for record in grid["records"] if record["training"] == PLAIN
    )


def test_stored_cells_are_those_of_this_code(long):
    cells = alessio_cells.cells()
    assert [row["cell"] for row in long["cells"]] == list(cells)
    for row in long["cells"]:
        assert row["digest"] == cells[row["cell"]].digest
        assert [list(point) for point in trade(cells[row["cell"]])] == row["trade"]


# --- The exact trade on cells ---


@pytest.mark.parametrize("seed", range(6))
def test_the_trade_begins_at_the_minimax_value_and_ends_at_the_planners_optimum(seed):
    """Three judges: dynamic programming over guarantees, minimax, and CP-SAT's least makespan."""
    cell = layered(5, seed=seed)
    points = trade(cell)
    assert points[0][0] == pytest.approx(minimax(cell))
    assert points[-1][1] == pytest.approx(plan(cell, time_limit=20, seed=0).points[0][0])
    assert points == sorted(points)
    assert [nominal for _, nominal in points] == sorted(
        (nominal for _, nominal in points), reverse=True
    )


def test_on_the_thesis_cell_one_robot_has_the_optimum_and_the_least_guarantee():
    """The claim that later papers leave open: bounded, and as quick as the optimiser."""
    assert trade(thesis_cell()) == [(47.0, 23.0)]
    assert times(thesis_cell(), nominal_robot(thesis_cell())) == (23.0, 47.0)


def test_a_guarantee_can_cost_nominal_time():
    assert trade(layered(5, seed=17)) == [(59.0, 36.0), (62.0, 35.0)]


@pytest.mark.parametrize("seed", range(4))
def test_no_human_makes_a_robot_later_than_it_guarantees(seed):
    """The guaranteed time is reached by the worst human and by no random one in many games, each
    played in the thesis's own world.
    """
    cell, draw = layered(5, seed=seed), np.random.default_rng(seed)
    nominal, guaranteed = times(cell, nominal_robot(cell))
    assert play(cell, nominal_robot(cell), hostile=False).makespan == pytest.approx(nominal)
    assert play(cell, nominal_robot(cell), hostile=True).makespan == pytest.approx(guaranteed)
    slowest = max(by_chance(cell, nominal_robot(cell), draw) for _ in range(40))
    assert slowest <= guaranteed + 1e-9


def by_chance(cell: Cell, robot, draw) -> float:
    """Seconds of a game in the thesis's world by decisions, with a human that takes any legal
    action and the robot asked as in the exact values.
    """
    data, rewards, moves = station(cell), reward_set("appendix"), values(cell, HOSTILE).moves
    state, clock, done = reset(data), 0, False
    while not done:
        mask = decisions.choices(data, state)
        human = int(draw.choice(np.flatnonzero(mask[HUMAN])))
        position = as_position(moves, data, state, human)
        # there and back
        assert np.array_equal(as_state(moves, data, position, 1)[0].time, state.time)
        ways = robot(position)
        action = np.array([moves.task[ways[0]] + 1 if ways else 0, human], np.int32)
        assert decisions.after_human(state, mask, np.int32(human))[action[ROBOT]]
        state, _, done, info = decisions.decide_step(data, rewards, state, action)
        clock += int(info.ticks)
    return clock


def as_position(moves, data, state, human):
    """The state of the thesis's world, with the task that the human has just named, as the exact
    values hold it before the robot's move.
    """
    position = moves.root()
    running = []
    for agent, bits in (
        (ROBOT, moves.instance.everybody & ~moves.instance.humans),
        (HUMAN, moves.instance.humans),
    ):
        task = int(state.doing[agent]) - 1
        if agent == HUMAN and human:
            task, left = human - 1, None
        else:
            left = int(state.time[agent, task]) * moves.instance.per_second if task >= 0 else 0
        if task >= 0:
            way = next(way for way in moves.ways[task] if moves.who[way] == bits)
            running.append((way, moves.ticks[way] if left is None else left))
    done = sum(1 << int(task) for task in np.flatnonzero(state.ended))
    return position._replace(done=done, running=tuple(sorted(running)))


def test_a_cell_that_the_station_cannot_hold_is_refused_by_name():
    cell = thesis_cell()
    late = cell.replace(
        tasks={
            **cell.tasks,
            "1": cell.tasks["1"].model_copy(update={"release": 5.0, "deadline": 60.0}),
        }
    )
    assert experiment.runs_on(layered(6, seed=0)).time.shape == (2, 6)
    with pytest.raises(CellError, match=r"knows no release(.|\n)*knows no deadline"):
        experiment.runs_on(late)


# --- Judging ---


def test_the_quickest_robot_is_judged_to_fail_and_the_crossing_one_not():
    drawn = layout("crossing")
    quick = grid_runs.judged(drawn, robots.quickest(drawn))
    assert (quick["nominal"], quick["worst"], quick["barred"]) == (15, None, False)

    def crosses(place, history):
        """Down, through the crossing to the right edge, and up."""
        row, column = divmod(place.robot, drawn.width)
        return 2 if column == 0 and row < 4 else 4 if column < 6 else 1

    safe = grid_runs.judged(drawn, crosses)
    assert (safe["nominal"], safe["worst"], safe["barred"]) == (23, 23, True)


def test_blocking_pays_on_some_random_grids_in_both_formulations():
    counts = grid_runs.formulations(12, first_seed=20)
    assert all(
        0 <= count["quickest_fails"] <= count["winnable"] <= count["drawn"] == 12
        for count in counts.values()
    )
    assert counts["closing paths"]["winnable"] > 0


def test_the_permutation_test_is_exact_and_symmetric():
    assert larger([3, 4], [1, 2]) == pytest.approx(1 / 6)
    assert larger([1, 2], [3, 4]) == 1
    assert larger([1.0] * 10, [0.0] * 10) == pytest.approx(1 / 184_756)
    assert larger([1.0] * 5, [1.0] * 5) == 1
    generator = random.Random(1)
    first, second = ([generator.random() for _ in range(9)] for _ in range(2))
    assert larger(first, second) + larger(second, first) == pytest.approx(1, abs=1e-3)


def test_large_samples_are_compared_by_drawn_splits():
    assert larger([1.0] * 12, [0.0] * 12) == pytest.approx(1 / 200_001)


def test_ranks_and_intervals():
    assert (rank_sum([1, 2], [1, 0]), rank_sum([1], [2])) == (0.875, 0.0)
    low, high = interval([0.0, 1.0] * 5)
    assert 0.1 <= low < 0.5 < high <= 0.9
    assert interval([0.3] * 4) == pytest.approx((0.3, 0.3))


def test_the_rules_robots_are_no_better_than_the_exact_ones():
    cell = alessio_cells.cells()["thesis"]
    name, (nominal, guaranteed) = alessio_cells.best_rule_robot(cell)
    assert name in alessio_cells.RULES
    assert (nominal, guaranteed) == (23, 47)
    assert times(cell, alessio_cells.rule_robot(cell, lambda ticks: -ticks))[0] >= 23
