"""`learned` takes what any algorithm of the product learned, on a PC without JAX, and says no to
the rest in one sentence.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from tests.dispatch.test_floor import ROUGH, driven
from tests.learn.short_runs import VALUED, run_once

import tandem
from tandem.cell.model import Cell
from tandem.cli.root import run as command
from tandem.dispatch.deciders.learned import learned
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.journal import Journal
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.model import Situation
from tandem.errors import CellError, UsageError
from tandem.lab.yu2020.board import random_board
from tandem.learn.algorithm import TrainingOrder
from tandem.learn.ppo.config import Config, Stage
from tandem.learn.ppo.recipes import Recipe
from tandem.learn.training.algorithms import algorithm
from tandem.learn.training.recipes import RECIPES
from tandem.learn.training.runs import RunFolder
from tandem.schedule.model import Assignment, Schedule
from tandem.world.randomness import OFF

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

ROOT = Path(__file__).resolve().parents[2]
CELL = ROOT / "examples" / "thesis.yaml"
THESIS = tandem.load(CELL)
PPO = Config(
    stages=(Stage(steps=2048, learning_rate=2e-3),),
    environments=32,
    horizon=16,
    minibatch=256,
    epochs=2,
    hidden=(8,),
)
TINY: dict[str, Any] = {
    "tandem": Recipe(PPO),
    "response": Recipe(PPO, people="pace:0.5..3+random:0.2"),
}
SIZELESS = ["alphazero", "dqn"]
"""Networks that read cells of any size."""
TRAINED = [*TINY, *SIZELESS]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory, shared_folder: Path) -> dict[str, Path]:
    """A short training of each kind on the thesis's cell: two seeds."""
    from tandem.learn.training.trainer import train

    folders = {name: run_once(shared_folder, name)[0] for name in SIZELESS}
    for name, recipe in TINY.items():
        folders[name] = tmp_path_factory.mktemp("learned") / "run"
        train(
            THESIS,
            recipe_name=name,
            own_recipe=recipe,
            stress_factor=1.0,
            seeds=(3, 4),
            folder=folders[name],
        )
    return folders


@dataclass(frozen=True)
class Ended:
    """A shift that has ended: what was done, and who decided."""

    done: Schedule
    deciders: set[str]
    makespan: float
    stress: float


def shift_of(
    cell: Cell,
    policy: Path,
    people: str = "compliant",
    chance: Any = OFF,
    seed: int = 0,
    by: str = "learned",
) -> Ended:
    """The whole shift on a simulated floor, as `tandem dispatch --simulate` runs it."""
    settings = Settings(by, options=Options(budget_ms=10_000, learned=str(policy)))
    shift = Shift.open(cell, Journal(), settings)
    said = driven(shift, SimulatedFloor(cell, people, chance, seed))
    assert all(document["accepted"] for document in said if document["type"] == "answer")
    situation = shift.situation
    assert situation.is_over
    assert replay(cell, shift.journal).differences == (), "a replay decides the same"
    work = [
        Assignment(task=one.task, operators=one.operators, start=one.start, end=one.end)
        for one in situation.done.values()
    ]
    *decided, last = (document["by"] for document in said if document["type"] == "decision")
    assert last == "shift", "which says that all is done"
    deciders = set(decided)
    return Ended(Schedule(work), deciders, situation.now, situation.stress)


def slower(cell: Cell, factor: float) -> Cell:
    """The cell whose humans need so many times the stated times, alone."""
    document = cell.to_dict()
    humans = set(cell.humans)
    for task in document["tasks"].values():
        task["time"] = {
            who: time * factor if who in humans else time for who, time in task["time"].items()
        }
    return Cell.model_validate(document)


@pytest.mark.parametrize("name", TRAINED)
@pytest.mark.parametrize("pace", [1.0, 1.5])
def test_whatever_was_learned_steers_a_whole_shift_that_keeps_to_the_cell(
    name: str, pace: float, runs: dict[str, Path]
) -> None:
    ended = shift_of(THESIS, runs[name], f"pace:{pace:g}")
    assert ended.deciders == {"learned"}
    assert tandem.faults(slower(THESIS, pace), ended.done) == []


@pytest.mark.parametrize("name", TRAINED)
def test_live_it_does_what_it_did_in_its_training(name: str, runs: dict[str, Path]) -> None:
    """NumPy at the station and JAX in the training choose alike: the greedy pair of either seed
    comes out again.
    """
    run = RunFolder(runs[name])
    for row in run.result()["seeds"]:
        ended = shift_of(THESIS, run.policy(row["seed"]))
        assert (ended.makespan, ended.stress) == (
            row["greedy"]["makespan"],
            row["greedy"]["stress"],
        )


@pytest.mark.parametrize("name", TRAINED)
@pytest.mark.parametrize("seed", range(3))
def test_mistakes_absences_and_refusals_leave_it_deciding(
    name: str, seed: int, runs: dict[str, Path]
) -> None:
    ended = shift_of(THESIS, runs[name], "forgetful:0.3+refusing:0.1+pace:1.5", ROUGH, seed)
    assert ended.deciders == {"learned"}
    assert {work.task for work in ended.done} == set(THESIS.tasks)


def mode_of(cell: Cell, work: Assignment) -> int:
    """Which of its task's modes the work was."""
    return [frozenset(mode.operators) for mode in cell.modes(work.task)].index(
        frozenset(work.operators)
    )


@pytest.mark.parametrize("name", SIZELESS)
@pytest.mark.parametrize("file", ["alternator", "crew", "gearbox", "line-of-four"])
def test_a_network_that_knows_no_sizes_steers_cells_that_it_was_not_trained_on(
    name: str, file: str, runs: dict[str, Path]
) -> None:
    cell = tandem.load(ROOT / "examples" / f"{file}.yaml")
    ended = shift_of(cell, runs[name])
    assert ended.deciders == {"learned"}
    took = {work: cell.modes(work.task)[mode_of(cell, work)].time for work in ended.done}
    # a shift counts the changeover in
    begun = Schedule(
        [replace(work, start=round(work.end - time, 6)) for work, time in took.items()]
    )
    assert tandem.faults(cell, begun) == []


def test_what_was_learned_without_waiting_waits_only_where_there_is_nothing_to_do(
    tmp_path: Path,
) -> None:
    trainee = algorithm(TrainingOrder(THESIS, replace(VALUED, waiting=False), "dqn"))
    trainee.save_policy(trainee.begin(), 0, tmp_path / "policy-0.safetensors")
    ended = shift_of(THESIS, tmp_path / "policy-0.safetensors")
    assert tandem.faults(THESIS, ended.done) == []
    assert ended.deciders == {"learned"}


def test_a_network_of_a_fixed_size_is_refused_on_another_cell(runs: dict[str, Path]) -> None:
    gearbox = tandem.load(ROOT / "examples" / "gearbox.yaml")
    for name in TINY:
        with pytest.raises(UsageError, match="Train one on this cell"):
            learned(gearbox, SECONDS, Options(learned=str(runs[name])))


@pytest.mark.parametrize("name", ["thesis", "yu2020"])
def test_a_policy_of_the_laboratory_is_refused_in_a_sentence_that_says_what_to_do(
    name: str, tmp_path: Path
) -> None:
    cell = THESIS if name == "thesis" else random_board(4, 4, 2, 3, 3, 5, seed=1).to_cell()
    trainee, file = (
        algorithm(TrainingOrder(cell, RECIPES[name], name)),
        tmp_path / "policy-0.safetensors",
    )
    trainee.save_policy(trainee.begin(), 0, file)
    with pytest.raises(
        UsageError,
        match=(
            rf"trained by the recipe '{name}', whose world knows no events\. Train one for dispatch"
            r" with: tandem train CELL"
        ),
    ):
        learned(cell, SECONDS, Options(learned=str(file)))


def test_a_network_with_notes_that_make_no_sense_is_refused(
    runs: dict[str, Path], tmp_path: Path
) -> None:
    from tandem.learn.alphazero.network import Scorer
    from tandem.learn.alphazero.trained import Trained

    trained = Trained.load(RunFolder(runs["alphazero"]).policy(3), Scorer)
    file = Trained(
        trained.network, trained.parameters, {**trained.notes, "stress_factor": -1.0}
    ).save(tmp_path / "notes.safetensors")
    with pytest.raises(CellError, match="notes: stress_factor"):
        learned(THESIS, SECONDS, Options(learned=str(file)))


@pytest.mark.parametrize("name", TRAINED)
def test_the_station_needs_no_jax(name: str, runs: dict[str, Path]) -> None:
    """With JAX barred from the process, the same shift is dispatched to its end."""
    asked = [
        "dispatch",
        str(CELL),
        "--policy",
        "learned",
        "--learned",
        str(runs[name]),
        "--simulate",
        "pace:1.5",
        "--json",
    ]
    program = (
        "import sys; sys.modules['jax'] = None; from tandem.cli.root import run;"
        f" sys.exit(run({asked!r}))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr
    summary = json.loads(ended.stdout.splitlines()[-1])
    assert (summary["over"], summary["failed"]) == (True, 0)


@pytest.mark.parametrize("name", TRAINED)
def test_the_judge_takes_it_alone_and_in_the_chain(
    name: str, runs: dict[str, Path], capfd: pytest.CaptureFixture[str]
) -> None:
    asked = [
        "simulate",
        str(CELL),
        "--policy",
        "learned,auto",
        "--learned",
        str(runs[name]),
        "--people",
        "pace:1.5",
        "--episodes",
        "4",
        "--json",
        "-q",
    ]
    assert command(asked) == 0
    told = json.loads(capfd.readouterr().out)
    alone, chain = told["policies"]
    assert told["left_out"] == []
    assert alone["makespan"]["mean"] == chain["makespan"]["mean"] >= told["optimum"]
    assert shift_of(THESIS, runs[name], by="auto").deciders == {"auto: learned"}


def test_of_a_run_the_seed_that_did_best_is_taken_and_named(
    runs: dict[str, Path], capfd: pytest.CaptureFixture[str]
) -> None:
    run = RunFolder(runs["dqn"])
    paid = {
        row["seed"]: 10 * row["greedy"]["makespan"] + row["greedy"]["stress"]
        for row in run.result()["seeds"]
    }
    assert len(set(paid.values())) == 2, "two seeds that differ, or this says nothing"
    best = min(paid, key=lambda seed: paid[seed])
    assert run.best_seed() == best
    assert learned(THESIS, SECONDS, Options(learned=str(run.path))).decide(
        Situation.of(THESIS)
    ) == learned(THESIS, SECONDS, Options(learned=str(run.policy(best)))).decide(
        Situation.of(THESIS)
    )
    assert (
        command(
            [
                "dispatch",
                str(CELL),
                "--policy",
                "learned",
                "--learned",
                str(run.path),
                "--simulate",
                "compliant",
                "--json",
            ]
        )
        == 0
    )
    assert f"seed {best}, the best of 2 by the run's own evaluation" in capfd.readouterr().err


def test_beside_its_people_a_best_response_is_judged_by_them(runs: dict[str, Path]) -> None:
    run = RunFolder(runs["response"])
    beside = {
        row["seed"]: 10 * row["people_makespan"] + row["people_stress"]
        for row in run.result()["seeds"]
    }
    assert run.best_seed() == min(beside, key=lambda seed: beside[seed])


def test_while_a_training_goes_on_the_first_seed_is_taken(
    runs: dict[str, Path], tmp_path: Path
) -> None:
    for seed in (3, 4):
        (tmp_path / f"policy-{seed}.safetensors").write_bytes(
            RunFolder(runs["tandem"]).policy(seed).read_bytes()
        )
    assert RunFolder(tmp_path).best_seed() == 3
    assert "seed 3, the first of 2, while the training goes on" in RunFolder(tmp_path).chosen()
