"""Run folders and policies that are damaged, hostile or of another recipe: one message that names
the file, exit 3, nothing lost.

Every damage is done to a copy of a real run, and every command that reads the file is run on it.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.numpy import save
from tests.learn import tiny
from tests.learn.short_runs import run_once

import tandem
from tandem.cli.root import run
from tandem.learn.networks import init
from tandem.learn.policy import Policy
from tandem.learn.ppo import observation
from tandem.learn.training import trainer
from tandem.world.arrays import Names

CELL = str(tiny.CELL)
DEEP = b"[" * 100_000 + b"]" * 100_000


# --- the runs ---


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """PPO, stopped after 4 of its 12 intervals: it has both checkpoints, figures, policies, and
    goes on.
    """
    folder = tmp_path_factory.mktemp("ppo") / "run"

    def stop(progress: trainer.TrainingProgress) -> None:
        if progress.rows[0]["interval"] == 4:
            raise KeyboardInterrupt

    tiny.train(folder, on_progress=stop)
    return folder


@pytest.fixture(scope="module")
def turns(shared_folder: Path) -> Path:
    """Deep Q-learning, trained for a moment: its policies hold another kind of network."""
    return run_once(shared_folder, "dqn")[0]


@pytest.fixture(scope="module")
def response(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The policy of a best response with drawn weights."""
    cell = tandem.load(CELL)
    arrays, rng = Names.of(cell).arrays(), np.random.default_rng(3)
    network = init(
        lambda shape: rng.uniform(-1, 1, shape).astype(np.float32),
        (observation.observation_size(arrays), 8, len(arrays.way_ticks) + 1),
    )
    actor = {
        layer: {part: array[None] for part, array in parts.items()}
        for layer, parts in network.items()
    }
    notes = {"kind": "response", "digest": cell.digest, "cell": cell.name}
    return Policy(("decider_0",), actor, "tanh", True, False, notes).save(
        tmp_path_factory.mktemp("response") / "policy-0.safetensors"
    )


# --- the damages ---

Damage = Callable[[Path], None]


@dataclass(frozen=True)
class Case:
    """What is done to one file."""

    name: str
    damage: Damage


def written(data: bytes) -> Damage:
    return lambda file: file.write_bytes(data)


def cut(share: float) -> Damage:
    return lambda file: file.write_bytes(file.read_bytes()[: int(len(file.read_bytes()) * share)])


def folder_instead(file: Path) -> None:
    file.unlink()
    file.mkdir()


ANY_FILE = [
    Case("missing", Path.unlink),
    Case("empty", written(b"")),
    Case("cut off early", cut(0.1)),
    Case("cut off late", cut(0.9)),
    Case("zeros", lambda file: file.write_bytes(bytes(len(file.read_bytes())))),
    Case("noise", written(np.random.default_rng(0).bytes(5000))),
    Case("a folder", folder_instead),
    Case("not UTF-8", lambda file: file.write_bytes(b"\xff\xfe" + file.read_bytes())),
    Case("deep", written(DEEP)),
    Case("null", written(b"null")),
    Case("a list", written(b"[]")),
    Case("a number of 9,999 digits", written(b"9" * 9999)),
]


def with_json(change: Callable[[Any], Any]) -> Damage:
    """A document changed; `nan` is written as JSON of Python has it."""

    def damage(file: Path) -> None:
        file.write_text(json.dumps(change(json.loads(file.read_text()))))

    return damage


def places(document: Any, way: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The way to every value of a document."""
    if way:
        yield way
    for key, value in (
        document.items()
        if isinstance(document, dict)
        else enumerate(document)
        if isinstance(document, list)
        else ()
    ):
        yield from places(value, (*way, key))


def put(way: tuple[Any, ...], value: Any) -> Callable[[Any], Any]:
    def change(document: Any) -> Any:
        part = document
        for key in way[:-1]:
            part = part[key]
        part[way[-1]] = value
        return document

    return change


def without(key: str) -> Callable[[Any], Any]:
    return lambda document: {name: value for name, value in document.items() if name != key}


def with_tensors(change: Callable[[dict[str, Any], dict[str, Any]], Any]) -> Damage:
    """A safetensors file with other arrays or another document: `change` gets both, and changes
    them.
    """

    def damage(file: Path) -> None:
        arrays, document = opened(file)
        change(arrays, document)
        rewrite(file, arrays, json.dumps(document))

    return damage


def with_text(text: str) -> Damage:
    """A safetensors file with the same arrays and that text for its document."""
    return lambda file: rewrite(file, opened(file)[0], text)


def opened(file: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    with safe_open(str(file), "numpy") as whole:
        arrays = {name: whole.get_tensor(name) for name in whole.keys()}  # noqa: SIM118
        return arrays, json.loads(whole.metadata()["tandem"])


def rewrite(file: Path, arrays: dict[str, Any], text: str) -> None:
    file.write_bytes(
        save(
            {name: np.ascontiguousarray(array) for name, array in arrays.items()},
            metadata={"tandem": text},
        )
    )


def last_layer(change: Callable[[np.ndarray], np.ndarray]) -> Damage:
    return with_tensors(
        lambda arrays, _: arrays.update(
            {f"1/{part}": change(arrays[f"1/{part}"]) for part in ("weight", "bias")}
        )
    )


def two_agents(arrays: dict[str, Any], document: dict[str, Any]) -> None:
    document["agents"] = ["a", "b"]
    arrays.update({name: np.concatenate([array, array]) for name, array in arrays.items()})


def without_layer_0(arrays: dict[str, Any], _: dict[str, Any]) -> None:
    for part in ("weight", "bias"):
        del arrays[f"0/{part}"]


def each_array(change: Callable[[np.ndarray], np.ndarray]) -> Damage:
    return with_tensors(
        lambda arrays, _: arrays.update({name: change(array) for name, array in arrays.items()})
    )


def first_array(change: Callable[[np.ndarray], np.ndarray]) -> Damage:
    def damage(arrays: dict[str, Any], _: dict[str, Any]) -> None:
        name = max(arrays, key=lambda one: (arrays[one].dtype.kind == "f", arrays[one].size))
        arrays[name] = change(arrays[name])

    return with_tensors(damage)


def header(text: bytes, size: int | None = None) -> Damage:
    return written((len(text) if size is None else size).to_bytes(8, "little") + text)


def about(change: Callable[[dict[str, Any]], Any]) -> Damage:
    return with_tensors(lambda _, document: change(document))


ANY_TENSORS = [
    *ANY_FILE,
    Case("header of a terabyte", header(b"{}", 2**40)),
    Case("header that is no JSON", header(b"{not json}")),
    Case("deep header", header(b'{"__metadata__": ' + DEEP + b"}")),
    Case("header of nothing", header(b"{}")),
    Case("no document", header(b'{"__metadata__": {"other": "1"}}')),
    Case("arrays that lie outside",
    header(b'{"a": {"dtype": "F32", "shape": [4], "data_offsets": [0, 16]}}')),
    Case("arrays without a size",
    header(b'{"a": {"dtype": "F32", "shape": [9999999999, 9999999999], "data_offsets": [0, 0]}}')),
    Case("numbers of an unknown kind",
    header(b'{"a": {"dtype": "F8_E4M3", "shape": [0], "data_offsets": [0, 0]}}')),
    Case("deep document", with_text(DEEP.decode())),
    Case("document that is no JSON", with_text("{")),
    Case("document of null", with_text("null")),
    Case("document with nothing", with_text("{}")),
    Case("another key", about(lambda document: document.update(more=1))),
    Case("no arrays", with_tensors(lambda arrays, _: arrays.clear())),
    Case("an array too many", with_tensors(lambda arrays, _: arrays.update(more=np.zeros(3,
    np.float32)))),
    Case("an array under no name", with_tensors(lambda arrays, _: arrays.update({"": np.zeros(3,
    np.float32)}))),
    Case("an array too few", with_tensors(lambda arrays, _: arrays.pop(min(arrays)))),
    Case("arrays renamed", with_tensors(lambda arrays,
    _: [arrays.update({f"{name}/x/y": arrays.pop(name)}) for name in list(arrays)])),
    Case("axes swapped", first_array(lambda array: np.swapaxes(array, -1, -2))),
    Case("flat", first_array(np.ravel)),
    Case("single number", first_array(lambda array: np.float32(1).reshape(()))),
    Case("empty array", first_array(lambda array: array[..., :0])),
    Case("double", first_array(lambda array: array.astype(np.float64))),
    Case("half", first_array(lambda array: array.astype(np.float16))),
    Case("whole numbers", first_array(lambda array: array.astype(np.int32))),
    Case("booleans", first_array(lambda array: array > 0)),
    Case("nan", first_array(lambda array: array * np.float32("nan"))),
]  # fmt: skip


def said(arguments: list[str], capfd: pytest.CaptureFixture[str]) -> tuple[int, str]:
    code = run(arguments)
    return code, capfd.readouterr().err


def contents(folder: Path) -> dict[str, str]:
    files = [file for file in folder.rglob("*") if file.is_file()]
    return {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
    }


def refused(
    arguments: list[str], file: Path, folder: Path, capfd: pytest.CaptureFixture[str], code: int = 3
) -> str:
    """Asserts that the command ends with one message about the file, and leaves everything as it
    is.
    """
    before = contents(folder)
    got, err = said(arguments, capfd)
    assert got == code, err
    assert "bug" not in err
    assert "Traceback" not in err
    assert err.count("tandem:") == 1
    assert file.name in err
    assert len(err) < 5000
    assert contents(folder) == before
    return err


def ids(cases: list[Case]) -> Any:
    return pytest.mark.parametrize("case", cases, ids=lambda case: case.name)


# --- run.json ---


def test_whatever_value_of_run_json_is_wrong_is_named(stopped: Path, tmp_path: Path, capfd):
    folder = tmp_path / "run"
    shutil.copytree(stopped, folder)
    file = folder / "run.json"
    document = json.loads(file.read_text())
    ways = [way for way in places(document) if way[0] != "versions" and len(way) < 5]
    assert len(ways) > 50
    for way in ways:
        for wrong in ({"x": 1}, [[]], float("nan")):
            file.write_text(json.dumps(put(way, wrong)(json.loads(json.dumps(document)))))
            err = refused(["train", "--resume", str(folder), "-q"], file, folder, capfd)
            keys = [str(key) for key in way if isinstance(key, str)]
            assert any(key in err for key in keys), (way, wrong, err)


RUN_JSON = [
    *ANY_FILE,
    *(Case(f"without {key}", with_json(without(key))) for key in ("cell", "recipe", "settings",
    "seeds", "stress_factor", "front_limit")),
    Case("another key", with_json(lambda document: document | {"sedes": [1]})),
    Case("no seeds", with_json(put(("seeds",), []))),
    Case("a seed twice", with_json(put(("seeds",), [3, 3]))),
    Case("a seed below 0", with_json(put(("seeds",), [-1]))),
    Case("a seed of 30 digits", with_json(put(("seeds",), [10**30]))),
    Case("no cell", with_json(put(("cell",), {}))),
    Case("a cell that does not hold", with_json(put(("cell", "tasks", "1", "after"), ["99"]))),
    Case("an unknown algorithm", with_json(put(("algorithm",), "pop"))),
    Case("another algorithm", with_json(put(("algorithm",), "dqn"))),
    Case("another algorithm that shares some settings", with_json(put(("algorithm",), "response"))),
    Case("a setting that there is not", with_json(put(("settings", "config", "layers"), 3))),
    Case("stress below 0", with_json(put(("stress_factor",), -1))),
    Case("no time for the front", with_json(put(("front_limit",), 0))),
]  # fmt: skip


@ids(RUN_JSON)
def test_a_damaged_run_json_stops_the_training(stopped: Path, tmp_path: Path, capfd, case: Case):
    shutil.copytree(stopped, tmp_path / "run")
    case.damage(tmp_path / "run" / "run.json")
    refused(
        ["train", "--resume", str(tmp_path / "run"), "-q"],
        tmp_path / "run" / "run.json",
        tmp_path,
        capfd,
    )


@ids(ANY_FILE)
def test_a_damaged_run_json_stops_the_evaluation(
    stopped: Path, turns: Path, tmp_path: Path, capfd, case: Case
):
    for kind, run_folder in (("ppo", stopped), ("dqn", turns)):
        shutil.copytree(run_folder, tmp_path / kind)
        case.damage(tmp_path / kind / "run.json")
        refused(["evaluate", str(tmp_path / kind)], tmp_path / kind / "run.json", tmp_path, capfd)


# --- metrics.jsonl ---

LINE = b'{"interval": 1, "seed": 3, "steps": 128}\n'
METRICS = [
    *(case for case in ANY_FILE if case.name in ("a folder", "not UTF-8")),
    Case("noise", written(b"\x00\xff\xfe\n" + LINE)),
    Case("null in a line", lambda file: file.write_bytes(b"null\n" + file.read_bytes())),
    Case("a list in a line", lambda file: file.write_bytes(b"[]\n" + file.read_bytes())),
    Case("deep in a line", lambda file: file.write_bytes(DEEP + b"\n" + file.read_bytes())),
    Case("digits in a line",
    lambda file: file.write_bytes(b"9" * 9999 + b"\n" + file.read_bytes())),
    Case("an empty line", lambda file: file.write_bytes(b"\n" + file.read_bytes())),
    Case("no interval", written(b'{"seed": 3}\n')),
    Case("no seed", written(b'{"interval": 1}\n')),
    Case("an interval of text", written(b'{"interval": "1", "seed": 3}\n')),
    Case("an interval that is none", written(b'{"interval": NaN, "seed": 3}\n')),
    Case("an interval below 1", written(b'{"interval": -1, "seed": 3}\n')),
    Case("text for a figure", written(b'{"interval": 1, "seed": 3, "steps": "many"}\n')),
    Case("a table for a figure", written(b'{"interval": 1, "seed": 3, "steps": {}}\n')),
    Case("other figures in the second line",
    written(LINE + b'{"interval": 1, "seed": 4, "stairs": 128}\n')),
    Case("cut off in the middle",
    lambda file: file.write_bytes(file.read_bytes()[:200] + b"\n" + file.read_bytes())),
]  # fmt: skip


@ids(METRICS)
def test_figures_that_cannot_be_read_are_told_by_line_and_never_dropped(
    stopped: Path, tmp_path: Path, capfd, case: Case
):
    shutil.copytree(stopped, tmp_path / "run")
    file = tmp_path / "run" / "metrics.jsonl"
    case.damage(file)
    err = refused(["train", "--resume", str(tmp_path / "run"), "-q"], file, tmp_path, capfd)
    assert "line" in err or file.is_dir()
    refused(
        ["evaluate", str(tmp_path / "run"), "--curves", str(tmp_path / "c.svg"), "--episodes", "2"],
        file,
        tmp_path,
        capfd,
    )


def test_curves_of_no_figures_are_refused(stopped: Path, tmp_path: Path, capfd):
    shutil.copytree(stopped, tmp_path / "run")
    (tmp_path / "run" / "metrics.jsonl").write_text("")
    code, err = said(
        ["evaluate", str(tmp_path / "run"), "--curves", str(tmp_path / "c.svg"), "--episodes", "2"],
        capfd,
    )
    assert (code, "has no figures yet" in err) == (2, True)


# --- checkpoints ---

CHECKPOINT = [
    *ANY_TENSORS,
    Case("a negative interval", about(lambda document: document.update(interval=-1))),
    Case("an interval of text", about(lambda document: document.update(interval="4"))),
    Case("half an interval", about(lambda document: document.update(interval=1.5))),
    Case("an interval without end", about(lambda document: document.update(interval=10**400))),
    Case("no interval", about(lambda document: document.pop("interval"))),
    Case("time that is none", about(lambda document: document.update(cpu_s=float("nan")))),
    Case("time of null", about(lambda document: document.update(cpu_s=None))),
    Case("every axis reversed", each_array(lambda array: array.T)),
]


@ids(CHECKPOINT)
def test_a_damaged_checkpoint_without_one_before_stops_the_training(
    stopped: Path, tmp_path: Path, capfd, case: Case
):
    shutil.copytree(stopped, tmp_path / "run")
    (tmp_path / "run" / "checkpoint-before.safetensors").unlink()
    file = tmp_path / "run" / "checkpoint.safetensors"
    case.damage(file)
    refused(["train", "--resume", str(tmp_path / "run"), "-q"], file, tmp_path, capfd)


@ids(
    [
        case
        for case in CHECKPOINT
        if case.name
        in (
            "missing",
            "cut off late",
            "axes swapped",
            "nan",
            "no interval",
            "deep document",
        )
    ]
)
def test_a_good_older_checkpoint_is_used_and_that_is_said(
    stopped: Path, tmp_path: Path, capfd, case: Case
):
    folder = tmp_path / "run"
    shutil.copytree(stopped, folder)
    case.damage(folder / "checkpoint.safetensors")
    damaged = (folder / "checkpoint.safetensors").read_bytes() if case.name != "missing" else None
    code, err = said(["train", "--resume", str(folder), "-q", "--json"], capfd)
    assert code == 0
    assert err.count("tandem:") == 1
    assert "checkpoint.safetensors" in err
    assert "goes on from checkpoint-before.safetensors, an interval earlier" in err
    assert json.loads((folder / "result.json").read_text())["seeds"][0]["steps"] == 12 * 128
    assert [row["interval"] for row in trainer.RunFolder(folder).rows()[::2]] == list(range(1, 13))
    if damaged is not None:
        assert (folder / "checkpoint-damaged.safetensors").read_bytes() == damaged


def test_a_checkpoint_of_another_recipe_is_refused_and_says_which_arrays(
    stopped: Path, turns: Path, tmp_path: Path, capfd
):
    folder = tmp_path / "run"
    shutil.copytree(stopped, folder)
    for name in ("checkpoint", "checkpoint-before"):
        shutil.copy(turns / "checkpoint.safetensors", folder / f"{name}.safetensors")
    err = refused(
        ["train", "--resume", str(folder), "-q"], folder / "checkpoint.safetensors", tmp_path, capfd
    )
    assert "does not fit this training: it has no " in err


# --- policies ---

SHAPES = [
    Case("another format", about(lambda document: document.update(format="tandem policy 2"))),
    Case("a format of numbers", about(lambda document: document.update(format=1))),
    Case("an infinite weight", first_array(lambda array: array * np.float32("inf"))),
    Case("every axis reversed", each_array(lambda array: array.T)),
]
POLICY = [
    *ANY_TENSORS,
    *SHAPES,
    *(
        Case(f"{key}: {wrong!r}", about(lambda document, key=key,
        wrong=wrong: document.update({key: wrong})))
        for key, wrongs in {
            "agents": (None, [], ["robot_0"], ["a", "b", "c"], [1, 2], "robot_0", {}),
            "activation": ("swish", None, 1, []),
            "masked": ("yes", 1, None, []),
            "shared": (True, "no", 0, None),
            "notes": (None, [], "x"),
        }.items()
        for wrong in wrongs
    ),
    *(
        Case(f"notes.{key}: {wrong!r}", about(lambda document, key=key,
        wrong=wrong: document["notes"].update({key: wrong})))
        for key, wrongs in {
            "pace": ("foo", 3, None),
            "sees": ("mine", [], {}),
            "rewards": ("none", 0),
            "stress_factor": ("1", -1, None, float("nan"), float("inf")),
            "seed": ("3", -1, 1.5),
            "cell": (7, []),
            "recipe": (None, {}),
        }.items()
        for wrong in wrongs
    ),
    *(Case(f"no note of {key}", about(lambda document,
    key=key: document["notes"].pop(key))) for key in ("pace", "sees", "rewards")),
    Case("one layer less", with_tensors(without_layer_0)),
    Case("one action less", last_layer(lambda array: array[..., :-1])),
    Case("sees one number less", with_tensors(lambda arrays,
    _: arrays.update({"0/weight": arrays["0/weight"][:, 1:]}))),
    Case("a third agent", each_array(lambda array: np.concatenate([array, array[:1]]))),
]  # fmt: skip


@ids(POLICY)
def test_a_damaged_policy_is_not_played(stopped: Path, tmp_path: Path, capfd, case: Case):
    shutil.copytree(stopped, tmp_path / "run")
    file = tmp_path / "run" / "policy-3.safetensors"
    case.damage(file)
    # whoever names a seed that is not there is told which ones are
    code = 2 if case.name == "missing" else 3
    arguments = ["evaluate", str(tmp_path / "run"), "--seed", "3", "--episodes", "2"]
    if code == 2:
        assert said(arguments, capfd)[0] == 2
    else:
        refused(arguments, file, tmp_path, capfd)


NETWORK = [
    *(case for case in ANY_TENSORS if case.name != "missing"),
    *SHAPES,
    *(
        Case(
            f"{key}: {wrong!r}",
            about(lambda document, key=key, wrong=wrong: document.update({key: wrong})),
        )
        for key, wrongs in {
            "network": ("scorer", "yu", "mlp", None, []),
            "sizes": (
                {},
                None,
                [],
                {"units": 9, "agents": 2},
                {"units": -1},
                {"units": 10**12},
                {"units": "8"},
                {"agents": 10**9},
                {"layers": 2},
            ),
            "notes": (None, []),
        }.items()
        for wrong in wrongs
    ),
]


@ids(NETWORK)
def test_a_damaged_network_is_not_played(turns: Path, tmp_path: Path, capfd, case: Case):
    if case.name == "an infinite weight":
        pytest.skip("a network of turns may hold what it likes best")
    shutil.copytree(turns, tmp_path / "run")
    file = tmp_path / "run" / "policy-3.safetensors"
    case.damage(file)
    asked = ["evaluate", str(tmp_path / "run"), "--seed", "3", "--episodes", "2"]
    refused(asked, file, tmp_path, capfd)


LEARNED = [
    *ANY_TENSORS,
    *SHAPES,
    Case("a second agent", with_tensors(two_agents)),
    Case("a shared one", about(lambda document: document.update(shared=True))),
    Case("a kind of numbers", about(lambda document: document["notes"].update(kind=7))),
    Case("a digest of numbers", about(lambda document: document["notes"].update(digest=7))),
    Case("one way less", last_layer(lambda array: array[..., :-1])),
    Case("sees one number less", with_tensors(lambda arrays,
    _: arrays.update({"0/weight": arrays["0/weight"][:, 1:]}))),
]  # fmt: skip


@ids(LEARNED)
def test_a_damaged_response_decides_nothing(
    response: Path, tmp_path: Path, capfd, monkeypatch, case: Case
):
    file = tmp_path / "policy-0.safetensors"
    shutil.copy(response, file)
    case.damage(file)
    if case.name == "a folder":
        pytest.skip("a folder is a run")
    for command in (
        ["dispatch", CELL, "--policy", "learned"],
        ["simulate", CELL, "--policy", "learned", "--episodes", "2", "-q"],
    ):
        refused([*command, "--learned", str(file)], file, tmp_path, capfd)


def test_other_files_beside_the_policies_are_not_taken_for_them(stopped: Path, tmp_path: Path):
    shutil.copytree(stopped, tmp_path / "run")
    for name in ("policy-best.safetensors", "policy-.safetensors", "policy-3 (copy).safetensors"):
        (tmp_path / "run" / name).write_bytes(b"")
    assert trainer.RunFolder(tmp_path / "run").seeds == [3, 4]


def test_what_a_run_wrote_is_read_without_a_word(stopped: Path, turns: Path, capfd):
    for folder in (stopped, turns):
        code, err = said(["evaluate", str(folder), "--episodes", "2", "--json"], capfd)
        assert (code, err) == (0, "")


def test_a_stage_of_another_length_goes_on_where_it_was(stopped: Path, tmp_path: Path):
    """A run that says another budget than it was begun with is a run, too: nothing but the
    settings' form is checked.
    """
    folder = tmp_path / "run"
    shutil.copytree(stopped, folder)
    with_json(put(("settings", "config", "stages", 1, "steps"), 128))(folder / "run.json")
    assert trainer.resume(folder)["seeds"][0]["steps"] == 7 * 128
