"""The thesis's figures as it has them, and the best rule beside its table."""

from __future__ import annotations

import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

from tandem.lab.kinat2023 import experiment
from tandem.lab.kinat2023.figures import (
    decisions_in_force,
    published,
    sliding_mean,
    training,
)
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.runs import FURTHER, VARIANTS
from tandem.learn.baseline import best_rule
from tandem.schedule.model import Assignment, Schedule


def test_the_decisions_in_force_follow_the_schedule():
    schedule = Schedule(
        (
            Assignment(0, 9, "1", ("robot",)),
            Assignment(9, 16, "2", ("robot",)),
            Assignment(20, 22, "7", ("robot",)),
            Assignment(6, 23, "3", ("human",)),
        )
    )
    robot, human = (
        decisions_in_force(thesis_cell(), schedule, name) for name in ("robot", "human")
    )
    assert robot == ([0.0, 9, 16, 20, 22, 23], [1, 2, 0, 7, 0, 0])
    assert human == ([0.0, 6, 23], [0, 3, 0])


def test_figures_6_3_to_6_8_have_both_step_curves_above_the_chart():
    axes = published(1).axes
    assert [ax.get_ylabel() for ax in axes[:2]] == ["$d_R(t)$, robot", "$d_H(t)$, human"]
    assert all(set(ax.lines[0].get_ydata()) <= set(range(8)) for ax in axes[:2])
    assert {ax.lines[0].get_drawstyle() for ax in axes[:2]} == {"steps-post"}


def test_figure_6_2_shows_each_episode_its_mean_and_the_critic_for_both_agents():
    run = {
        "variant": "thesis",
        "factor": 1,
        "seed": 0,
        "every_episode": {
            "returns": [[-100 * k, -50] for k in range(40, 0, -1)],
            "first_value": [[0, 0]] * 40,
        },
    }
    axes = training([run, run]).axes
    assert len(axes) == 4
    episodes, mean, critic = axes[0].lines[:3]
    assert list(episodes.get_ydata())[:2] == [-4000, -3900]
    assert mean.get_ydata()[39] == pytest.approx(-100 * sum(range(1, 31)) / 30)
    assert set(critic.get_ydata()) == {0}
    assert sliding_mean([1, 2, 3], 2) == [1, 1.5, 2.5]


def test_the_table_has_the_best_rule_and_best_of_n_and_says_what_is_dominated():
    text = experiment.table(experiment.stored())
    assert "| best rule |" in text
    assert "24/3 (weighted); best-of-n 24/3" in text
    assert "Published at factor 0: makespan-optimal, stress +10 (23/7 exists)." in text
    assert experiment.rule_beside("table_5_2", 1).startswith("24/3")


def test_the_best_rule_can_be_asked_among_some():
    rule = best_rule(thesis_cell(), lambda makespan, _: makespan, among=("best-of-n",))
    assert rule is not None
    assert (rule.name, rule.result.makespan) == ("best-of-n", 23)


def test_variants_by_name_are_recipes_of_the_thesis():
    assert {"thesis", "thesis, toolbox defaults"} <= set(VARIANTS)
    assert not set(VARIANTS) & set(FURTHER)
    assert FURTHER["thesis, bounds 3600 and 100"].sees == "bounded"
