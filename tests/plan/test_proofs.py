"""Which models the prover asks: whoever uses us loses no proof that a plain model gives."""

from __future__ import annotations

from functools import partial

import pytest

from tandem.files.generators import layered
from tandem.plan import cpsat, proving
from tandem.plan.methods import plan

Asked = list[tuple[bool, bool, int]]
"""Of each model: has it the implied rows, is it told the incumbent, and by how many ticks may it
last beyond the horizon.
"""


@pytest.fixture
def asked(monkeypatch) -> Asked:
    """What is asked while the test runs."""
    found: Asked = []
    formulate = proving.formulate

    def noted(instance, upper, rules, *, own_ends):
        if rules is not cpsat.ALLOCATION:
            rows = set(cpsat.IMPLIED) <= set(rules)
            assert own_ends != rows  # the rows want sums, a plain model does without them
            decisions = formulate(instance, upper, rules, own_ends=own_ends)
            hint = decisions.hint
            found.append((rows, False, upper - instance.horizon))

            def told(place, starts):
                rows, _, upper = found[place]
                found[place] = (rows, True, upper)
                hint(starts)

            decisions.hint = partial(told, len(found) - 1)
            return decisions
        return formulate(instance, upper, rules, own_ends=own_ends)

    monkeypatch.setattr(proving, "formulate", noted)
    return found


@pytest.mark.parametrize("workers", [1, 2])
def test_a_plain_model_begins_with_the_incumbent_beside_the_rows_below_it(asked, workers):
    front = plan(layered(12, 2, 2, seed=3), minimize="makespan", workers=workers)
    assert front.complete
    rows = [(told, upper) for rows, told, upper in asked if rows]
    assert rows
    assert all(not told and upper < 0 for told, upper in rows)
    plain = [(told, upper) for rows, told, upper in asked if not rows]
    assert set(plain) <= {(True, 0)}


def test_both_models_have_their_turn_where_work_is_counted(asked):
    plan(layered(30, 3, 2, seed=0), minimize="makespan", work=0.5)
    assert {rows for rows, _, _ in asked} == {True, False}


def test_a_lone_worker_does_not_put_the_proof_off_until_nothing_gets_better(asked):
    plan(layered(40, 2, 2, seed=0), minimize="makespan", work=1)
    assert {rows for rows, _, _ in asked} == {True, False}


def test_no_model_is_asked_again_when_it_was_wrong(asked, monkeypatch):
    wrong = tuple(rule for rule in cpsat.RULES if rule is not cpsat.predecessors_end_first)
    monkeypatch.setattr(cpsat, "RULES", wrong)
    with pytest.warns(RuntimeWarning, match="the checker refused"):
        front = plan(layered(12, 2, 2, seed=3), minimize="makespan", workers=1, time_limit=60)
    assert not front.complete
    assert [rows for rows, _, _ in asked] in ([True], [True, False])
