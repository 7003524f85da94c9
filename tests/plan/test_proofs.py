"""Which models the prover asks: whoever uses us loses no proof that a plain model gives."""

from __future__ import annotations

from functools import partial

import pytest
from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.plan import cpsat, proving
from tandem.plan.door import Door
from tandem.plan.goal import Effort, Goal
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.methods import plan
from tandem.plan.portfolio import Portfolio
from tandem.plan.question import Question
from tandem.plan.result import Status
from tandem.plan.starts import list_schedule

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


def race_for(cell: Cell) -> Portfolio:
    """A race of two workers for the least makespan that has not begun."""
    instance = Instance.of(cell)
    effort = Effort(until=None, seed=0, workers=2)
    door = Door(cell, instance, Question())
    return Portfolio(door, Layout.of(instance), Goal(1, 0), effort, None, 0)


def shop_of(tasks: int, who: int) -> Cell:
    """So many tasks of ten jobs on ten machines, each on so many of them."""
    machines = [f"m{number}" for number in range(10)]
    times = [
        {machines[(3 * step + step // 10 + other) % 10]: 5 + step % 7 for other in range(who)}
        for step in range(tasks)
    ]
    return cell_of(
        {
            "operators": {name: {"kind": "machine"} for name in machines},
            "tasks": {
                str(step): {"time": time, "after": [str(step - 10)] if step >= 10 else []}
                for step, time in enumerate(times)
            },
        }
    )


@pytest.mark.parametrize(
    ("tasks", "who", "by"),
    [
        (160, 1, "search"),
        (160, 2, None),
        (140, 2, "_prove_later"),
        (290, 1, "search"),
        (300, 1, None),
    ],
)
def test_job_shops_are_proven_whole_up_to_more_tasks(tasks, who, by):
    """Where each task is on one machine all cores search with CP-SAT, on either of two one does."""
    jobs = [job.func for job in race_for(shop_of(tasks, who)).jobs() if isinstance(job, partial)]
    names = {job.__name__ for job in jobs}
    assert names & {"search", "_prove_later"} == ({by} if by else set())


def test_a_job_shop_is_proven_by_all_cores_as_by_one():
    shop = shop_of(60, 1)
    (together,) = plan(shop, minimize="makespan", workers=2, time_limit=120)
    (alone,) = plan(shop, minimize="makespan", workers=1, time_limit=120)
    assert together.status == alone.status == Status.OPTIMAL
    assert together.makespan == alone.makespan


@pytest.mark.parametrize("workers", [1, 2])
def test_a_lone_prover_that_was_overtaken_is_patient_for_seconds_of_its_core(workers, monkeypatch):
    """On a busy machine ten seconds of the clock may be one of its core: a proof would be begun
    again before it can end. The threads of several workers are not known, so the clock counts.
    """
    clock = {"monotonic": 0.0, "thread_time": 0.0}
    for name in clock:
        monkeypatch.setattr(proving, name, partial(clock.__getitem__, name))
    race = race_for(layered(8, 1, 1, seed=0))
    race.take_in(race.door.admit(list_schedule(race.layout, [0] * 8)))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = workers
    plan = cpsat.formulate(race.instance, race.instance.horizon)
    watcher = proving._Watcher(race, solver, plan, race.value + 1, 10.0)
    for name in ("monotonic", "thread_time"):
        clock[name] = 11.0
        watcher.on_bound(0.0)
        assert watcher.outdated == (workers > 1 or name == "thread_time")
