"""Chessboards to be played and what is known of them without learning: optima, plain players,
troubles. Makespans in seconds everywhere.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tandem.lab.yu2020.board import Board, desk, random_board
from tandem.lab.yu2020.chance import Chance, fate
from tandem.lab.yu2020.layout import layout, stacked
from tandem.lab.yu2020.optimal import optimum, replanning
from tandem.lab.yu2020.play import by_rule, makespans, play
from tandem.lab.yu2020.players import PLAYERS
from tandem.lab.yu2020.world import Fate
from tandem.learn.baseline import best_rule
from tandem.plan.rules import RULES

Tell = Callable[[str], None]
Decider = Callable[[Fate | None], NDArray[Any]]
"""From what goes wrong, `[B, games]` (None: nothing), to makespans `[B, games]`, or `[B, 1]`
without trouble.
"""

FIRST = range(20)
"""Seeds of boards whose optima are known from elsewhere."""
TEST = range(1000, 1100)
"""Seeds of boards that nobody was trained on."""
HELD = range(2000, 2016)
"""Seeds of boards that learning curves are read on."""
TRAINING = range(10_000, 10_256)
"""Seeds of boards that are trained on."""

TROUBLES = {"some": Chance(0.05, 10.0, 0.05), "much": Chance(0.15, 20.0, 0.15)}
"""ASSUMPTION: how often a robot's work fails, seconds of its repair, how often a human errs."""


def boards(seeds: Sequence[int]) -> list[Board]:
    """The boards of the authors' demonstration with these seeds: 45 pieces on 15 rows and 12
    columns.
    """
    return [random_board(seed=seed) for seed in seeds]


def proven(seeds: Sequence[int]) -> dict[str, Any]:
    """The optima of these boards, without and with waiting, and what their proof took."""
    rows: dict[str, Any] = {"seeds": list(seeds)}
    for name, waiting in (("no_waiting", False), ("waiting", True)):
        began = time.process_time()
        found = [optimum(board, waiting=waiting) for board in boards(seeds)]
        spent = time.process_time() - began
        rows[name] = {
            "makespans": [one.makespan for one in found], "states": [one.states for one in found],
            "cpu_s_each": round(spent / len(found), 3),
        }  # fmt: skip
    return rows


def by_best_rule(seeds: Sequence[int]) -> list[dict[str, Any]]:
    """The best dispatch rule of Tandem on these boards and the desk, and the best of a hundred
    drawn schedules alone: seconds. They plan the cell, in which agents may wait; the game's own
    rules are in `plain`.
    """
    rows = []
    for player, among in (("best rule", tuple(RULES)), ("best-of-n", ("best-of-n",))):
        took = []
        for board in [*boards(seeds), desk()]:
            rule = best_rule(board.to_cell(), lambda makespan, _: makespan, among=among)
            assert rule is not None  # boards know no limits
            took.append(rule.result.makespan)
        rows.append({"player": player, "boards": took[:-1], "desk": took[-1]})
    return rows


def proven_desk() -> dict[str, Any]:
    """The same of the desk."""
    rows: dict[str, Any] = {}
    for name, waiting in (("no_waiting", False), ("waiting", True)):
        began = time.process_time()
        found = optimum(desk(), waiting=waiting)
        rows[name] = {
            "makespan": found.makespan,
            "states": found.states,
            "cpu_s": round(time.process_time() - began, 3),
        }
    return rows


def plain(seeds: Sequence[int], *, games: int, desk_games: int, seed: int) -> list[dict[str, Any]]:
    """What players without learning take on these boards and on the desk. Random play: mean, and
    best, of so many games on each board.
    """
    import jax

    everything, key = [*boards(seeds), desk()], jax.random.key(seed)
    rows = []
    for name in PLAYERS:
        if name != "random":
            took = [play(board, by_rule(PLAYERS[name])).makespan for board in everything]
            rows.append({"player": name, "boards": took[:-1], "desk": took[-1], "games": 1})
    drawn = makespans(stacked(everything), PLAYERS["random"], key, games=games)
    on_desk = (
        drawn[-1]
        if desk_games <= games
        else makespans(stacked([desk()]), PLAYERS["random"], key, games=desk_games)[0]
    )
    mean, best = drawn[:-1].mean(1).round(3).tolist(), drawn[:-1].min(1).tolist()
    rows.append(
        {
            "player": "random, mean",
            "boards": mean,
            "desk": round(float(on_desk.mean()), 2),
            "games": games,
        }
    )
    rows.append(
        {
            "player": f"random, best of {games}",
            "boards": best,
            "desk": int(drawn[-1].min()),
            "games": games,
        }
    )
    return rows


def fates(seeds: Sequence[int], chance: Chance, games: int, seed: int) -> Fate:
    """`[B, games, h, w]`: what goes wrong in each game, the same for every decider."""
    generator, rows = np.random.default_rng(seed), []
    for board in boards(seeds):
        laid = layout(board)
        rows.append(
            [fate(laid, chance, generator.random((3, *laid.time.shape))) for _ in range(games)]
        )
    return Fate(
        *(np.array([[getattr(one, name) for one in row] for row in rows]) for name in Fate._fields)
    )


def troubled(
    seeds: Sequence[int],
    games: int,
    learned: Mapping[str, Callable[[Fate | None], NDArray[Any]]],
    *,
    seed: int,
    tell: Tell,
) -> list[dict[str, Any]]:
    """What each decider takes without trouble, and in `games` games a board with each degree of it.

    Args:
      learned: name -> decider on the same boards.
    """
    chosen = boards(seeds)

    def played(choose: Callable[[Board, int], Any]) -> Decider:
        """A decider out of what `play` wants, made anew for each board and number of a game."""

        def decide(fates: Fate | None) -> NDArray[Any]:
            if fates is None:
                return np.array([[play(board, choose(board, 0)).makespan] for board in chosen])
            each = [
                [Fate(*(part[b, g] for part in fates)) for g in range(games)]
                for b in range(len(chosen))
            ]
            return np.array(
                [
                    [play(board, choose(board, g), fate=one).makespan for g, one in enumerate(row)]
                    for board, row in zip(chosen, each, strict=True)
                ]
            )

        return decide

    deciders = {
        "random": played(lambda _, game: by_rule(PLAYERS["random"], seed + game)),
        "longest-tail": played(lambda _, __: by_rule(PLAYERS["longest-tail"])),
        **learned,
        "exact, proven anew": played(lambda board, _: replanning(board)),
    }
    happened = {name: fates(seeds, chance, games, seed) for name, chance in TROUBLES.items()}
    rows = []
    for name, decide in deciders.items():
        calm = decide(None).mean(1)
        for degree, chance in TROUBLES.items():
            rough = decide(happened[degree]).mean(1)
            rows.append({
                "decider": name, "troubles": degree, "robot_fails": chance.robot_fails,
                "repair_s": chance.repair_s, "human_errs": chance.human_errs,
                "calm": calm.round(3).tolist(), "rough": rough.round(3).tolist(), "games": games,
            })  # fmt: skip
            tell(
                f"troubles, {degree}: {name} loses {np.mean(rough - calm):.1f} s of"
                f" {calm.mean():.1f} s"
            )
    return rows
