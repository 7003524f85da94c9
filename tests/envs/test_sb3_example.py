"""A foreign learner on our station, as a client would use it: the example of sb3-contrib's
MaskablePPO.
"""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from tandem.files.load import load

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def test_maskable_ppo_takes_its_first_steps():
    """One rollout and one update: too little to learn, enough to see that the two fit together."""
    pytest.importorskip("sb3_contrib", reason="pip install 'tandem[sb3]' to run it")
    learn = runpy.run_path(str(EXAMPLES / "sb3_maskable_ppo.py"))["learn"]
    found = learn(load(EXAMPLES / "thesis.yaml"), steps=1_024, target=23.0, seed=0)
    assert found.makespan >= 23  # endless where it still waits for ever
    assert found.steps == 1_000


@pytest.mark.slow
@pytest.mark.parametrize("by", ["ticks", "decisions"])
def test_maskable_ppo_learns_the_thesis_example(by):
    """23 s, the least makespan, after at most 31,000 steps with masks on the joint action."""
    pytest.importorskip("sb3_contrib", reason="pip install 'tandem[sb3]' to run it")
    learn = runpy.run_path(str(EXAMPLES / "sb3_maskable_ppo.py"))["learn"]
    found = learn(load(EXAMPLES / "thesis.yaml"), by=by, steps=31_000, target=23.0, seed=0)
    assert found.makespan == 23
    assert found.stress in (7, 17)
    assert found.gantt.count("|") == 7
