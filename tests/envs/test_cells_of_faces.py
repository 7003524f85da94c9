"""Faces over several cells, cells that a reset names, and what is paid: numbers and functions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test

import tandem
import tandem.envs
from tandem.cell.model import Cell
from tandem.envs import parallel_env
from tandem.envs.cells import Room
from tandem.envs.rewards import Happening
from tandem.errors import UsageError
from tandem.files.generators import layered

ROOT = Path(__file__).resolve().parents[2]
NAME = "tandem/RobotBesideHuman-v0"
CELLS = [layered(4, 1, 1, seed=1), layered(7, 2, 1, seed=2), layered(5, 1, 2, seed=3)]
THESIS = ROOT / "examples" / "thesis.yaml"


def drawn(rng: np.random.Generator) -> Cell:
    return layered(int(rng.integers(3, 8)), 1, 1, seed=int(rng.integers(1000)))


def played(env: Any, **reset: Any) -> tuple[float, dict[str, Any], str]:
    """What the first legal way always comes to: what was paid, the last info, the cell's name."""
    seen, info = env.reset(**reset)
    ended, paid = False, 0.0
    while not ended:
        assert env.observation_space.contains(seen)
        seen, reward, ended, cut, info = env.step(int(np.flatnonzero(seen["action_mask"])[-1]))
        assert not cut
        paid += reward
    return paid, info, env.unwrapped.game.cell.name


def test_episodes_are_played_on_every_cell_of_a_list_and_the_seed_says_which() -> None:
    env = gymnasium.make(NAME, cell=CELLS)
    names = [played(env, seed=seed)[2] for seed in range(12)]
    assert set(names) == {cell.name for cell in CELLS}
    assert names == [played(env, seed=seed)[2] for seed in range(12)]


def test_a_folder_and_a_generator_are_cells_too(tmp_path: Path) -> None:
    from tandem.files.yaml_writer import to_yaml

    for number, cell in enumerate(CELLS):
        (tmp_path / f"{number}.yaml").write_text(to_yaml(cell), "utf-8")
    (tmp_path / "notes.txt").write_text("no cell")
    assert len(gymnasium.make(NAME, cell=tmp_path).unwrapped.cells.known) == 3  # type: ignore[attr-defined]
    room = {"tasks": 8, "ways": 16, "robots": 1, "humans": 1}
    env = gymnasium.make(NAME, cell=drawn, room=room)
    assert len({played(env, seed=seed)[2] for seed in range(6)}) > 1


def test_padded_faces_pass_the_official_suites() -> None:
    check_env(gymnasium.make(NAME, cell=CELLS).unwrapped, skip_render_check=True)
    env = parallel_env("events", CELLS)
    assert env.possible_agents == ["robot_0", "robot_1", "human_0", "human_1"]
    parallel_api_test(env, num_cycles=60)


def test_only_who_is_there_is_an_agent_of_the_episode() -> None:
    env = parallel_env("events", CELLS)
    env.reset(seed=0, options={"cell": CELLS[0]})
    assert env.agents == ["robot_0", "human_0"]
    env.reset(seed=0, options={"cell": CELLS[1]})
    assert len(env.agents) == 3


@pytest.mark.parametrize("cell", CELLS, ids=lambda cell: str(len(cell.tasks)))
def test_padding_changes_nothing_of_what_happens(cell: Cell) -> None:
    """The same actions, by their numbers, come to the same end."""
    alone = played(gymnasium.make(NAME, cell=cell, person="random:0.5"), seed=5)
    padded = gymnasium.make(NAME, cell=CELLS, person="random:0.5")
    assert played(padded, seed=5, options={"cell": cell})[0] == alone[0]


def test_what_is_seen_stands_at_its_place_in_the_padded_observation() -> None:
    env = gymnasium.make(NAME, cell=CELLS)
    seen, _ = env.reset(seed=0, options={"cell": CELLS[0]})
    view = env.unwrapped.view  # type: ignore[attr-defined]
    room, own, plain = view.room, view.own, view.game.observe(view.game.turn)
    assert seen["observation"][: own.tasks].tolist() == plain[: own.tasks].tolist()
    assert not seen["observation"][own.tasks : room.tasks].any()
    at = 8 * room.tasks + 6 * room.operators + room.ways
    assert seen["observation"][at] == plain[-1], "the clock"
    ticks = view.game.arrays.way_ticks
    assert np.allclose(seen["observation"][at + 1 : at + 1 + own.ways], ticks / ticks.mean())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cell": layered(8, 1, 1, seed=0), "room": Room(4, 8, 1, 1)}, "8 tasks where there is"),
        ({"cell": drawn}, "say how large they may become"),
        ({"cell": []}, "no cell is given"),
        ({"cell": CELLS, "room": {"tasks": -1, "ways": 1, "robots": 1, "humans": 1}}, "tasks=-1"),
        ({"reward": {"secnd": 1}}, "'secnd'.*'second'"),
        ({"reward": {"second": "much"}}, "second is 'much'"),
        ({"reward": "nowhere:pay"}, "nowhere:pay: cannot be loaded"),
        ({"reward": "pay"}, "there is none of that name"),
        ({"reward": "math:pi"}, "no reward"),
        ({"reward": {"second": -1}, "stress_factor": 2}, "part of the default"),
    ],
)
def test_wrong_cells_and_wrong_rewards_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        gymnasium.make(NAME, **{"cell": THESIS, **options})


def test_a_cell_of_another_size_needs_room() -> None:
    env = gymnasium.make(NAME, cell=CELLS[0])
    with pytest.raises(UsageError, match="Make the environment with room"):
        env.reset(options={"cell": CELLS[1]})
    roomy = gymnasium.make(NAME, cell=CELLS[0], room=Room(9, 30, 2, 2))
    assert played(roomy, seed=0, options={"cell": CELLS[1]})[2] == CELLS[1].name


def pay(happening: Happening) -> float:
    """A hundred at the end, minus the seconds in which somebody had no work."""
    return 100.0 * happening.done - happening.idle


@pytest.mark.parametrize("face", ["gymnasium", "pettingzoo"])
def test_rewards_are_numbers_functions_or_named(face: str) -> None:
    def comes_to(**options: Any) -> tuple[float, dict[str, Any]]:
        if face == "gymnasium":
            paid, info, _ = played(gymnasium.make(NAME, cell=THESIS, **options), seed=0)
            return paid, info
        env = parallel_env("events", THESIS, **options)
        seen, infos = env.reset(seed=0)
        paid = 0.0
        while env.agents:
            actions = {a: int(np.flatnonzero(seen[a]["action_mask"])[-1]) for a in env.agents}
            seen, rewards, _, _, infos = env.step(actions)
            paid += rewards["robot_0"]
        return paid, infos["robot_0"]

    paid, info = comes_to(stress_factor=2)
    assert paid == -info["time"] - 2 * info["stress"]
    assert comes_to(reward={"second": -1, "stress": -2})[0] == paid
    assert comes_to(reward={"task": 1})[0] == len(tandem.load(THESIS).tasks)
    named = comes_to(reward=f"{__name__}:pay")[0]
    assert named == comes_to(reward=pay)[0]
    assert named == pytest.approx(comes_to(reward={"done": 100, "idle": -1})[0])
    with pytest.raises(UsageError, match="gave None"):
        comes_to(reward=lambda happening: None)


def test_the_thesis_face_has_the_thesis_cell_by_default_and_takes_another() -> None:
    env = gymnasium.make("tandem/Thesis-v0")
    env.reset(seed=0)
    assert env.unwrapped.game.cell == tandem.load(THESIS)  # type: ignore[attr-defined]
    slower = env.unwrapped.game.cell.replace(name="another")  # type: ignore[attr-defined]
    env.reset(options={"cell": slower})
    assert env.unwrapped.game.cell.name == "another"  # type: ignore[attr-defined]
    with pytest.raises(UsageError, match="4 tasks"):
        env.reset(options={"cell": CELLS[0]})
    assert parallel_env("thesis").game.cell == tandem.load(THESIS)
