"""What `--set` takes: every setting of every recipe is checked, and everything wrong is told at
once.
"""

from __future__ import annotations

import json
import typing
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import pytest

from tandem.cli.root import run
from tandem.errors import UsageError
from tandem.learn.forms import SettingsError
from tandem.learn.training.recipes import RECIPES, changed, kinds, recipe_from


def leaves(form: Any, value: Any, place: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Every setting that a recipe has: the way to it, its type, its value; those of the first
    stage, too.
    """
    hints = typing.get_type_hints(form)
    for field in fields(form):
        if not field.compare:
            continue  # what a recipe is, in words: no setting
        kind, own, name = hints[field.name], getattr(value, field.name), f"{place}{field.name}"
        if is_dataclass(own):
            yield from leaves(type(own), own, f"{name}.")
        elif isinstance(own, tuple) and own and is_dataclass(own[0]):
            yield name, kind, own
            yield from leaves(type(own[0]), own[0], f"{name}.0.")
        else:
            yield name, kind, own


SETTINGS = [
    pytest.param(recipe, *leaf, id=f"{recipe}-{leaf[0]}")
    for recipe, base in RECIPES.items()
    for leaf in leaves(type(base), base)
]


def wrong_for(kind: Any) -> list[str]:
    """Values that no setting of that type can have."""
    text = str(kind).replace("typing.Optional[int]", "int | None")
    text = text.replace("typing.Optional[float]", "float | None")
    wrong = ["{}", '{"a": 1}', "NaN", "Infinity", "-Infinity"]
    if "str" not in text and "Literal" not in text:
        wrong += ["foo", "", '"1"']
    if "None" not in text and "Optional" not in text:
        wrong.append("null")
    if "tuple" not in text:
        wrong += ["[]", "[1]", *["[" * 5000] * ("str" not in text)]
    else:
        wrong += ["3", "[]", '["a"]', "[[1]]", "[null]", "[0]", "[-1, 2]"]
    if "bool" not in text:
        wrong += ["true", "false"]
    if text.startswith("<class 'int'>") or "int | None" in text:
        wrong += ["1.5", "1e300", "-1", str(10**30), "9" * 5000]
    if "Literal" in text:
        wrong += ["foo", "3"]
    if text == "<class 'bool'>":
        wrong += ["0", "1", "yes"]
    if text == "<class 'str'>":
        wrong += ["3", "[]"]
    if text == "<class 'float'>":
        wrong += ["-1e300"]
    return wrong


@pytest.mark.parametrize(("name", "setting", "kind", "value"), SETTINGS)
def test_no_setting_of_any_recipe_takes_a_value_that_it_cannot_have(name, setting, kind, value):
    for wrong in wrong_for(kind):
        if setting.endswith(".idle") and wrong == "-1e300":
            continue  # what idling costs may be any number
        with pytest.raises(UsageError) as caught:
            changed(RECIPES[name], [f"{setting}={wrong}"])
        assert all(line.startswith(("--set ",)) for line in str(caught.value).splitlines())
        assert setting.rsplit(".", 1)[-1] in str(caught.value)
        assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(("name", "setting", "kind", "value"), SETTINGS)
def test_every_setting_takes_the_value_that_it_has(name, setting, kind, value):
    del kind
    plain = RECIPES[name].to_dict()
    for key in setting.split("."):
        plain = plain[int(key) if key.isdecimal() else key]
    assert changed(RECIPES[name], [f"{setting}={json.dumps(plain)}"]) == RECIPES[name], value


@pytest.mark.parametrize("name", RECIPES)
def test_what_a_recipe_writes_down_is_read_back(name):
    base = RECIPES[name]
    assert recipe_from(base.algorithm, json.loads(json.dumps(base.to_dict()))) == base
    assert type(base) is kinds()[base.algorithm]


def test_a_setting_in_a_stage_is_reached_by_its_place():
    stages = changed(RECIPES["tandem"], ["config.stages.1.entropy=0.25"]).config.stages
    assert [stage.entropy for stage in stages] == [0.1, 0.25, 0.003]


STAGE = '{"steps": 64, "entropie": 1}'
TOLD = [
    (
        "station",
        "sees=mine",
        "--set sees 'mine': choose 'thesis' or 'scaled' or 'bounded' or 'normalised'.",
    ),
    ("station", "pace=foo", "--set pace 'foo': choose 'ticks' or 'decisions'."),
    (
        "station",
        "rewards=table-5-2",
        "--set rewards 'table-5-2': Did you mean 'table_5_2'? choose ",
    ),
    (
        "tandem",
        f"config.stages=[{STAGE}]",
        "--set config.stages.0.entropie: there is no such setting. Did you mean 'entropy'?",
    ),
    (
        "tandem",
        "config.stages=[{}]",
        "--set config.stages.0.episodes and steps: says neither, so it would never end.",
    ),
    ("tandem", "config.stages=[3]", "--set config.stages.0 3: must be a table of settings."),
    (
        "station",
        "config.stages.3.entropy=1",
        "config.stages.3.entropy=1: the recipe has no such setting; config.stages has 3, counted",
    ),
    (
        "tandem",
        "config.stages.0.entropie=1",
        "no such setting; config.stages.0 has episodes, steps, entropy, learning_rate",
    ),
    (
        "tandem",
        "config.hidden=[64, 0]",
        "--set config.hidden.1 0: must be 1 or more.",
    ),
    (
        "tandem",
        "config.environments=2000000000",
        "environments 2000000000: must be at most 4,194,304.",
    ),
    ("station", "pace=ticks pace=decisions", "--set pace: is set 2 times."),
    ("tandem", "masked", "--set masked: the recipe has no such setting"),
    ("tandem", "=1", "--set =1: the recipe has no such setting"),
    (
        "station",
        "config.clip=2 config.epochs=0 sees=mine",
        "--set config.clip 2: must be less than 1.|--set config.epochs 0: must|--set sees 'mine'",
    ),
    (
        "dqn",
        "config.agents=both config.horizon=mine",
        "agents 'both': choose 'each' or 'one'|horizon 'mine': choose 'own' or 'next'",
    ),
    (
        "alphazero",
        "config.search.kind=uct config.iterations=0",
        "--set config.search.kind 'uct'|--set config.iterations 0",
    ),
    (
        "alphazero",
        "waiting=7 config.search.noise=3",
        "--set waiting 7: must be true or false|--set config.search.noise 3: must be at most 1.",
    ),
    ("yu2020", "config.value_norm=[1]", "--set config.value_norm.1: is missing."),
    (
        "yu2020",
        "config.value_norm=[1,2,3]",
        "--set config.value_norm a list: has room for 2 values.",
    ),
    (
        "response",
        "people=3 config.gae=1.5",
        "--set people 3: must be text.|--set config.gae 1.5: must be at most 1.",
    ),
]


@pytest.mark.parametrize(("name", "settings", "told"), TOLD)
def test_everything_that_is_wrong_is_told_at_once_with_what_is_allowed(name, settings, told):
    with pytest.raises(UsageError) as caught:
        changed(
            RECIPES[name],
            [settings] if "{" in settings or ", " in settings else settings.split(" "),
        )
    for words in told.split("|"):
        assert words in str(caught.value)


@pytest.mark.parametrize("name", RECIPES)
def test_the_command_ends_with_2_and_one_message_before_it_makes_a_folder(name, tmp_path, capfd):
    arguments = [
        "train",
        "examples/thesis.yaml",
        "--recipe",
        name,
        "--run",
        str(tmp_path / "run"),
        "-q",
    ]
    assert run([*arguments, "--set", "config.learning_rat=1", "--set", "config.stages=foo"]) == 2
    said = capfd.readouterr().err
    assert said.count("--set") == 2
    assert "bug" not in said
    assert not (tmp_path / "run").exists()


def test_settings_of_another_recipe_are_refused_when_a_run_is_read():
    with pytest.raises(
        SettingsError, match=r"(?s)config.stages: there is no such.*pace: there is no such"
    ):
        recipe_from("dqn", RECIPES["station"].to_dict())
