"""Trainings on chessboards, one record a run: the recipe of Yu, Huang and Chang as it was
described, and ours.

A record is plain data and lies in a file of its own beside the weights, so that a batch that was
stopped goes on where it was.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from tandem.lab.records import kept_record
from tandem.lab.yu2020.board import Board, desk
from tandem.lab.yu2020.config import YuConfig, YuSearch
from tandem.lab.yu2020.games import HELD, TRAINING, Decider, Tell, boards
from tandem.lab.yu2020.optimal import optimum, replanning
from tandem.lab.yu2020.play import by_rule
from tandem.lab.yu2020.play import play as play_one
from tandem.lab.yu2020.players import PLAYERS
from tandem.learn.alphazero.config import Config, Search

RECIPES = ("ours", "as described")
NOT_IMITATED = "ours, nothing imitated"
"""Our recipe without the cheapest games in what it learns from. Trained on the desk only."""
OURS = ("ours", NOT_IMITATED)
DRAWN: dict[str, Search | YuSearch] = {
    "ours": Search(simulations=16, gumbel_scale=3.0),
    "as described": YuSearch(temperature=1.0),
}
"""Recipe -> the search of which several games are drawn and the best counts."""
CHANGES: dict[str, dict[str, Any]] = {
    "unvisited moves count 0": {"unvisited": "zero"},
    "own time counts": {"quirk": False},
    "temperature 1": {"temperature": 1.0},
    "c is 10": {"exploration": 10.0},
}
"""What is changed in their recipe, one thing at a time -> its search. Trained on the desk only."""


@dataclass(frozen=True)
class Sizes:
    """How much is done.

    Attributes:
      ours, described: how the two recipes train.
      training: boards that are trained on, of `TRAINING`.
      held: boards that learning curves are read on, of `HELD`.
      simulations: of the searches that play, ours and theirs.
      every: rounds of ours, and games of theirs, from one point of the curve to the next.
      samples: games on the desk of which the best counts; 0 to leave that out.
      trainings: recipe (of `RECIPES`, or with a change), and what it is trained on: "boards",
        random ones, or "desk".
    """

    ours: Config
    described: YuConfig
    training: int
    held: int
    simulations: tuple[int, int]
    every: tuple[int, int]
    samples: int
    trainings: tuple[tuple[str, str], ...]


EVERYTHING = (
    ("ours", "boards"),
    ("ours", "desk"),
    ("as described", "boards"),
    ("as described", "desk"),
    *((change, "desk") for change in (NOT_IMITATED, *CHANGES)),
)
LONG = Sizes(
    Config(iterations=16), YuConfig(), len(TRAINING), len(HELD), (32, 30), (2, 20), 16, EVERYTHING
)
QUICK = Sizes(
    replace(
        Config(),
        search=Search(simulations=8, considered=4),
        iterations=2,
        games=16,
        minibatch=128,
        minibatches=4,
    ),
    replace(
        YuConfig(), outer=1, inner=1, switch=1, search=YuSearch(simulations=6, temperature=1000.0)
    ),
    8,
    4,
    (8, 8),
    (2, 2),
    0,
    (("ours", "boards"), ("as described", "desk")),
)


def wanted(seeds: Sequence[int], sizes: Sizes) -> list[tuple[str, str, int]]:
    """Recipe, what it is trained on, seed."""
    return [(recipe, place, seed) for seed in seeds for recipe, place in sizes.trainings]


def run_all(
    folder: Path, seeds: Sequence[int], test: Sequence[Board], sizes: Sizes, tell: Tell
) -> Iterator[Path]:
    """Every training that has no record in `folder` yet; yields each record's file. The weights lie
    beside it.
    """
    for recipe, place, seed in wanted(seeds, sizes):
        file = folder / f"{recipe.replace(' ', '-')}_{place}_{seed}.json"
        kept_record(file, partial(run, recipe, place, seed, test, sizes, weights_of(file), tell))
        yield file


def weights_of(record: Path) -> Path:
    """Where a record's weights lie."""
    return record.with_suffix(".safetensors")


def config_of(recipe: str, sizes: Sizes) -> Config | YuConfig:
    """How a recipe, or one with a change, is trained."""
    if recipe in OURS:
        return replace(sizes.ours, imitated=0.0) if recipe == NOT_IMITATED else sizes.ours
    return replace(
        sizes.described, search=replace(sizes.described.search, **CHANGES.get(recipe, {}))
    )


def looking_of(recipe: str, sizes: Sizes) -> Search | YuSearch:
    """The search with which it plays: theirs with the most visited move."""
    ours, theirs = sizes.simulations
    if recipe in OURS:
        return Search(simulations=ours, gumbel_scale=0.0)
    return YuSearch(**{**CHANGES.get(recipe, {}), "simulations": theirs, "temperature": 0.0})


def run(
    recipe: str,
    place: str,
    seed: int,
    test: Sequence[Board],
    sizes: Sizes,
    weights: Path,
    tell: Tell,
) -> dict[str, Any]:
    """The record of one training, and of what it plays on the test boards and the desk.

    Args:
      place: "boards", random ones, or "desk".
    """
    from tandem.lab.yu2020.board_training import train

    config, looking, every = (
        config_of(recipe, sizes),
        looking_of(recipe, sizes),
        sizes.every[recipe not in OURS],
    )
    on_desk = place == "desk"
    pool = [desk()] if on_desk else boards(TRAINING[: sizes.training])
    held = [desk()] if on_desk else boards(HELD[: sizes.held])
    began = time.process_time()
    trained, curve = train(pool, config, seed=seed, held=held, looking=looking, every=every)
    cpu_s = time.process_time() - began
    trained.save(weights)
    record: dict[str, Any] = {
        "recipe": recipe,
        "trained_on": place,
        "seed": seed,
        "cpu_s": round(cpu_s, 1),
        "curve": curve,
    }
    # The authors' network fits one size of board, so what is trained on one cannot play the other.
    record["desk"] = (
        played(trained, [desk()], recipe, sizes) if on_desk or recipe == "ours" else None
    )
    record["boards"] = None if on_desk else played(trained, test, recipe, sizes)
    tell(
        f"{recipe}, trained on {place}, seed {seed}: {cpu_s:.0f} CPU s"
        + (f", desk {record['desk']['search'][0]} s" if record["desk"] else "")
    )
    return record


def played(trained: Any, on: Sequence[Board], recipe: str, sizes: Sizes) -> dict[str, Any]:
    """Makespans on these boards: of the network alone, of the search, and on a single board of the
    best of several searched games.
    """
    from tandem.lab.yu2020.board_training import play

    took = {
        "network": play(trained, on)[:, 0].tolist(),
        "search": play(trained, on, looking=looking_of(recipe, sizes))[:, 0].tolist(),
    }
    if sizes.samples and len(on) == 1 and recipe in DRAWN:
        took[f"best of {sizes.samples}"] = (
            play(trained, on, looking=DRAWN[recipe], samples=sizes.samples).min(1).tolist()
        )
    return took


def untrained_record(recipe: str, seed: int, test: Sequence[Board], sizes: Sizes) -> dict[str, Any]:
    """What the recipe plays before it has learned anything, where it will be played afterwards."""
    from tandem.lab.yu2020.board_training import untrained

    config = config_of(recipe, sizes)
    record: dict[str, Any] = {
        "recipe": recipe,
        "trained_on": "nothing",
        "seed": seed,
        "cpu_s": 0.0,
        "curve": [],
        "desk": None,
        "boards": None,
    }
    if recipe == "ours" or (recipe, "desk") in sizes.trainings:
        record["desk"] = played(untrained(config, desk(), seed=seed), [desk()], recipe, sizes)
    if (recipe, "boards") in sizes.trainings:
        record["boards"] = played(untrained(config, test[0], seed=seed), test, recipe, sizes)
    return record


def kinds(records: Sequence[dict[str, Any]]) -> list[str]:
    """How the records' networks were played."""
    return list(
        dict.fromkeys(
            kind for record in records for part in ("boards", "desk") for kind in record[part] or {}
        )
    )


def loaded(folder: Path, recipe: str, *places: str) -> tuple[Any, str] | None:
    """The network of the first seed that was trained on the first of these places that there is a
    record of, and that place.
    """
    from tandem.lab.yu2020.network import YuNetworks
    from tandem.learn.alphazero.network import Scorer
    from tandem.learn.alphazero.trained import Trained

    for place in places:
        if files := sorted(folder.glob(f"{recipe.replace(' ', '-')}_{place}_*.json")):
            return Trained.load(weights_of(files[0]), YuNetworks, Scorer), place
    return None


def decisions(folder: Path, sizes: Sizes) -> dict[str, float]:
    """Player -> milliseconds of one decision on the desk, one game at a time, on this machine.

    Of the exact player for the whole game, which it proves at its first decision."""
    from tandem.lab.yu2020.board_training import decide_ms

    found = {}
    for recipe in RECIPES:
        if (network := loaded(folder, recipe, "desk", "boards")) is not None:
            found[f"{recipe}, network"] = decide_ms(network[0], desk())
            found[f"{recipe}, search"] = decide_ms(
                network[0], desk(), looking=looking_of(recipe, sizes)
            )
    for name, choose in (
        ("longest-tail", by_rule(PLAYERS["longest-tail"])),
        ("exact, no waiting", replanning(desk())),
    ):
        began = time.perf_counter()
        game = play_one(desk(), choose)
        spent = 1000 * (time.perf_counter() - began)
        found[name] = spent if name.startswith("exact") else spent / len(game.moves)
    return {name: float(f"{spent:.3g}") for name, spent in found.items()}


def learned_deciders(
    folder: Path, on: Sequence[Board], games: int, sizes: Sizes
) -> dict[str, Decider]:
    """Decider -> from fates to its makespans on these boards. All were trained on random boards
    without trouble.
    """
    from tandem.lab.yu2020.board_training import play

    found: dict[str, Decider] = {}
    for recipe, kind in (("as described", "search"), ("ours", "network"), ("ours", "search")):
        if (network := loaded(folder, recipe, "boards")) is not None:
            found[f"{recipe}, {kind}"] = _decider(
                play, network[0], on, games, looking_of(recipe, sizes) if kind == "search" else None
            )
    return found


def films(folder: Path, sizes: Sizes) -> dict[str, list[int]]:
    """Who plays the desk -> the columns that it plays: both recipes' searches, trained there if
    they were, and the optimum.
    """
    from tandem.lab.yu2020.board_training import decider

    found = {"exact, no waiting": list(optimum(desk()).columns)}
    for recipe in RECIPES:
        if (network := loaded(folder, recipe, "desk", "boards")) is not None:
            found[f"{recipe}, search, trained on {network[1]}"] = [
                move.column
                for move in play_one(
                    desk(), decider(network[0], desk(), looking=looking_of(recipe, sizes))
                ).moves
            ]
    return found


def _decider(
    play: Callable[..., NDArray[Any]],
    trained: Any,
    on: Sequence[Board],
    games: int,
    looking: Search | YuSearch | None,
) -> Decider:
    return lambda fates: play(
        trained, on, looking=looking, samples=1 if fates is None else games, fates=fates
    )
