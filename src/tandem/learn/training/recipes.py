"""The named recipes: an algorithm and its configuration, and what is trained on."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from tandem.errors import UsageError
from tandem.extensions import Table
from tandem.learn.algorithm import AnyRecipe
from tandem.learn.alphazero.recipes import ALPHAZERO
from tandem.learn.dqn.recipes import DQN
from tandem.learn.forms import SettingsError
from tandem.learn.graph.recipes import GRAPH
from tandem.learn.ppo.recipes import RESPONSE, TANDEM
from tandem.learn.settings import read
from tandem.learn.training.algorithms import ALGORITHMS


def theirs(home: str, found: Any) -> AnyRecipe:
    """A recipe that others add. Raises UsageError for what is none."""
    missing = [name for name in ("algorithm", "what", "to_dict") if not hasattr(found, name)]
    if missing or isinstance(found, type):
        raise UsageError(
            f"{home}: is {found!r}, and no recipe. A recipe is a frozen dataclass as"
            " tandem.learn.algorithm.AnyRecipe says, such as dataclasses.replace of one that is"
            " there."
        )
    if found.algorithm not in ALGORITHMS:
        raise UsageError(
            f"{home}: is a recipe for the algorithm {found.algorithm!r}, which nobody adds. There"
            f" are {', '.join(ALGORITHMS)}; one of your own is an entry point of the group"
            " tandem.algorithms, so that a run that was stopped can go on."
        )
    made: AnyRecipe = found
    return made


RECIPES: Table[AnyRecipe] = Table(
    "recipes",
    {
        "tandem": TANDEM,
        "response": RESPONSE,
        "alphazero": ALPHAZERO,
        "dqn": DQN,
        "graph": GRAPH,
    },
    theirs,
)
"""Name -> recipe. A new one is a line here, an entry point of the group `tandem.recipes`, or
anybody's by its dotted name.
"""


def kinds() -> dict[str, type[AnyRecipe]]:
    """Algorithm -> the form of its recipes."""
    return {known.algorithm: type(known) for known in RECIPES.sound().values()}


def recipe(name: str) -> AnyRecipe:
    """The recipe of that name. Raises UsageError for one that `RECIPES` does not hold."""
    if name not in RECIPES:
        meant = "".join(f" Did you mean {near!r}?" for near in get_close_matches(name, RECIPES, 1))
        raise UsageError(f"recipe {name!r}: there is none.{meant} There are: {', '.join(RECIPES)}.")
    return RECIPES[name]


def recipe_from(algorithm: str, data: Any) -> AnyRecipe:
    """The recipe that `to_dict` wrote down.

    Raises SettingsError with everything that does not fit. Assumes that some recipe is of that
    algorithm.
    """
    return read(kinds()[algorithm], data)


def changed(base: AnyRecipe, settings: Sequence[str]) -> AnyRecipe:
    """The recipe with settings such as `waiting=false` or `config.search.simulations=64`; values
    are JSON, or words.

    Raises UsageError, with all faults at once, for what is no setting of the recipe or does not fit
    it.
    """
    if not settings:
        return base
    data, faults = _plain(base), []
    names = [setting.partition("=")[0] for setting in settings]
    for setting in settings:
        if not _put(data, setting):
            there = _there(_plain(base), setting)
            faults.append(f"{_short(setting)}: the recipe has no such setting; {there}.")
    faults += [
        f"{name}: is set {names.count(name)} times."
        for name in dict.fromkeys(names)
        if names.count(name) > 1
    ]
    try:
        made = recipe_from(base.algorithm, data)
    except SettingsError as error:
        faults += list(error.faults)
        faults += [
            fault for setting in settings for fault in _alone(base, setting) if fault not in faults
        ]
    if faults:
        raise UsageError("\n".join(f"--set {fault}" for fault in faults))
    return made


def _alone(base: AnyRecipe, setting: str) -> list[str]:
    """What is wrong with a setting itself, whatever the others are: a part that does not hold keeps
    what stands around it from being judged.
    """
    data = _plain(base)
    _put(data, setting)
    try:
        recipe_from(base.algorithm, data)
    except SettingsError as error:
        return [
            fault for fault in error.faults if fault.startswith(f"{setting.partition('=')[0]} ")
        ]
    return []


def _plain(base: AnyRecipe) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(json.dumps(base.to_dict()))
    return data


def _put(data: dict[str, Any], setting: str) -> bool:
    """Writes the value of `NAME=VALUE` where its name leads; False when that is nowhere. A number
    leads into a list.
    """
    name, is_one, value = setting.partition("=")
    *parents, last = name.split(".")
    part: Any = data
    for parent in parents:
        part = part[_key(part, parent)] if _key(part, parent) is not None else None
    key = _key(part, last)
    if not is_one or key is None:
        return False
    part[key] = _value(value)
    return True


def _key(part: Any, word: str) -> str | int | None:
    if isinstance(part, list) and word.isdecimal() and int(word) < len(part):
        return int(word)
    return word if isinstance(part, dict) and word in part else None


def _there(data: dict[str, Any], setting: str) -> str:
    """What stands where the name leads astray: `config.stages.0.entropi` is told of a stage."""
    part: Any = data
    reached = list[str]()
    for word in setting.partition("=")[0].split("."):
        if (key := _key(part, word)) is None:
            break
        part = part[key]
        reached.append(word)
    way = ".".join(reached)
    if isinstance(part, list):
        return f"{way} has {len(part)}, counted from 0"
    if isinstance(part, dict) and len(reached) > 1:
        return f"{way} has {', '.join(part)}"
    return f"it has {', '.join(_names(data))}"


def _short(setting: str) -> str:
    return setting if len(setting) <= 80 else f"{setting[:77]}..."


def _names(data: Mapping[str, Any], place: str = "") -> list[str]:
    return [
        name
        for key, value in data.items()
        for name in (_names(value, f"{place}{key}.") if isinstance(value, dict) else [place + key])
    ]


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text
