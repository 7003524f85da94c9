"""Yu, Huang and Chang (2020): assembly as a chessboard, learned in the manner of AlphaGo Zero. What
is published of it, their recipe run here as it was described, our recipe, plain rules, and the
proven optimum, on random boards and on their desk.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.lab.kinat2023.experiment import mean
from tandem.lab.origin import origin
from tandem.lab.quick import compiled_quickly
from tandem.lab.records import kept_record, read_record, stored_document, write_document
from tandem.lab.systems import Features, Played
from tandem.lab.yu2020 import games, runs
from tandem.lab.yu2020.board import Board, desk
from tandem.lab.yu2020.chance import Chance, fate
from tandem.lab.yu2020.layout import layout
from tandem.lab.yu2020.play import play as play_one
from tandem.learn.training.runs import versions

STORED = "yu2020.json"
SEEDS = 5
RANDOM_GAMES, DESK_GAMES = 100, 2000
TROUBLED_BOARDS, TROUBLED_GAMES = 10, 5
QUICK_BOARDS, QUICK_TROUBLED_BOARDS = 4, 2

PUBLISHED: dict[str, str | None] = {
    "boards": None,
    "desk": None,
    "decision": None,
    "said": (
        "Beats a conventional mathematical optimisation in completion time and in time per"
        " decision, on 100 random boards and a simulated desk."
    ),
}
"""What is public of their results: no number. The paper's tables are not, nor the sizes of its 100
boards or the method it was compared with.
"""


def reproduce(
    folder: Path,
    *,
    quick: bool = False,
    seeds: int | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Plays, trains, plays again and returns the document, which is also written to
    `folder/yu2020.json`.

    Records and weights of the trainings are kept in `folder/records` as they come; a run that was
    stopped goes on from there.

    Args:
      quick: four boards, one seed, trainings of seconds.
      seeds: trainings of each recipe; 5 when absent.
    """
    with compiled_quickly() if quick else nullcontext():
        document = _document(
            folder / "records", quick, range(seeds or (1 if quick else SEEDS)), tell
        )
    return write_document(folder / STORED, document)


def _document(
    records: Path, quick: bool, seeds: Sequence[int], tell: Callable[[str], None]
) -> dict[str, Any]:
    sizes, number, many, few = (
        (runs.QUICK, QUICK_BOARDS, QUICK_TROUBLED_BOARDS, 2)
        if quick
        else (runs.LONG, len(games.TEST), TROUBLED_BOARDS, TROUBLED_GAMES)
    )
    test, random_games, desk_games = (
        games.TEST[:number],
        *((10, 10) if quick else (RANDOM_GAMES, DESK_GAMES)),
    )
    boards = games.boards(test)
    tell("proving optima")
    document: dict[str, Any] = {
        "schema_version": 1,
        "command": (
            "tandem reproduce yu2020"
            + " --quick" * quick
            + f" --seeds {len(seeds)}" * (len(seeds) != (1 if quick else SEEDS))
        ),
        "quick": quick,
        "seeds": list(seeds),
        "versions": versions(),
        "published": PUBLISHED,
        "exact": kept_record(
            records / "exact.json",
            lambda: _exact_results(test, games.FIRST[: 3 if quick else None]),
        ),
    }
    tell("plain players")
    document["plain"] = kept_record(
        records / "plain.json",
        lambda: games.plain(test, games=random_games, desk_games=desk_games, seed=0),
    )
    document["rules"] = kept_record(records / "rules.json", lambda: games.by_best_rule(test))
    files = list(runs.run_all(records, seeds, boards, sizes, tell))
    untrained = [
        kept_record(
            records / f"{recipe.replace(' ', '-')}_untrained.json",
            partial(runs.untrained_record, recipe, 0, boards, sizes),
        )
        for recipe in runs.RECIPES
    ]
    document["records"] = [*untrained, *(read_record(file) for file in files)]
    # These ask the networks of the first seed only, however many there are.
    document["decisions"] = kept_record(
        records / "decisions.json", partial(runs.decisions, records, sizes)
    )
    document["films"] = kept_record(records / "films.json", partial(runs.films, records, sizes))

    def troubles() -> list[dict[str, Any]]:
        return games.troubled(
            test[:many],
            few,
            runs.learned_deciders(records, boards[:many], few, sizes),
            seed=1,
            tell=tell,
        )

    document["troubles"] = kept_record(records / "troubles.json", troubles)
    return {**document, "summary": summary(document)}


def _exact_results(test: Sequence[int], first: Sequence[int]) -> dict[str, Any]:
    return {"desk": games.proven_desk(), "first": games.proven(first), "test": games.proven(test)}


def stored() -> dict[str, Any]:
    """The document of the long run that ships with the package. Raises CellError when this copy has
    none, or a damaged one.
    """
    return stored_document("yu2020/results.json", "yu2020")


def summary(document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """A row per player: on the test boards its mean gap to the optimum with waiting (with the half
    width of a 95 % interval over boards), to that of the game itself, and the share of boards on
    which it beats the longest tail and the best of the random games; on the desk seconds.
    """
    exact, plain = document["exact"]["test"], {row["player"]: row for row in document["plain"]}
    best_random = next(row for name, row in plain.items() if name.startswith("random, best"))
    rows = []

    def row(
        player: str,
        trained_on: str | None,
        boards: Sequence[Sequence[float]],
        on_desk: Sequence[float],
    ) -> dict[str, Any]:
        found: dict[str, Any] = {
            "player": player,
            "trained_on": trained_on,
            "seeds": max(len(boards), len(on_desk)),
        }
        if boards:
            took = np.mean(boards, axis=0)
            found |= {
                "gap": _gap(took, exact["waiting"]["makespans"]), "gap_no_waiting": _gap(took,
                exact["no_waiting"]["makespans"]),
                "gap_of_seeds": [_gap(np.array(one),
                exact["waiting"]["makespans"])["mean"] for one in boards],
                "beats_longest_tail": _beats(took, plain["longest-tail"]["boards"]),
                "beats_best_random": _beats(took, best_random["boards"]),
            }  # fmt: skip
        return {**found, "desk": list(on_desk)}

    for one in [*document["plain"], *document.get("rules", ())]:
        rows.append(row(one["player"], None, [one["boards"]], [one["desk"]]))
    for recipe in runs.RECIPES:
        for place in ("nothing", "boards", "desk"):
            own = [
                record
                for record in document["records"]
                if (record["recipe"], record["trained_on"]) == (recipe, place)
            ]
            for kind in runs.kinds(own):
                boards = [
                    record["boards"][kind] for record in own if kind in (record["boards"] or {})
                ]
                rows.append(
                    row(
                        f"{recipe}, {kind}",
                        place,
                        boards,
                        [
                            record["desk"][kind][0]
                            for record in own
                            if kind in (record["desk"] or {})
                        ],
                    )
                )
    rows.append(
        row(
            "exact, no waiting",
            None,
            [exact["no_waiting"]["makespans"]],
            [document["exact"]["desk"]["no_waiting"]["makespan"]],
        )
    )
    rows.append(
        row(
            "exact, with waiting",
            None,
            [exact["waiting"]["makespans"]],
            [document["exact"]["desk"]["waiting"]["makespan"]],
        )
    )
    return rows


def changes(document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Both recipes on the desk as they are and with one thing changed: seconds of its search at the
    end, a number a seed; and over the second half of the training, where it may still go up and
    down, the mean and the least.
    """
    rows = []
    for recipe in (*runs.OURS, "as described", *runs.CHANGES):
        own = [
            record
            for record in document["records"]
            if (record["recipe"], record["trained_on"]) == (recipe, "desk")
        ]
        late = [
            point["searched"]
            for record in own
            for point in record["curve"][len(record["curve"]) // 2 :]
        ]
        if own:
            rows.append(
                {
                    "recipe": recipe,
                    "at_the_end": [record["desk"]["search"][0] for record in own],
                    "mean": float(np.mean(late)),
                    "least": min(late),
                }
            )
    return rows


def table(document: Mapping[str, Any]) -> str:
    """Published, as described, ours and exact, as Markdown."""
    number = len(document["exact"]["test"]["seeds"])
    first, last = document["exact"]["test"]["seeds"][0], document["exact"]["test"]["seeds"][-1]
    lines = [
        (
            f"{number} random boards (seeds {first} to {last}, trained on by nobody) and the desk."
            " Gap: mean over the boards to the proven optimum with waiting, with the half width of"
            " its 95 % interval; desk: seconds, one number a seed."
        ),
        "",
        (
            "| player | trained on | seeds | gap, with waiting | gap, no waiting | beats longest"
            " tail | beats best random | desk | ms a decision |"
        ),
        "|" + "---|" * 9,
        (
            "| Yu, Huang, Chang 2020 | 100 random boards? | | not public | not public | | | not"
            " public | not public |"
        ),
    ]
    for row in document["summary"]:
        cells = [
            row["player"], row["trained_on"] or "–", row["seeds"] if row["trained_on"] else "–",
            *([_percent(row["gap"]), _percent(row["gap_no_waiting"]),
            f"{row['beats_longest_tail']:.0%}", f"{row['beats_best_random']:.0%}"]
              if "gap" in row else ["–"] * 4),
            " ".join(f"{seconds:g}" for seconds in row["desk"]) or "–",
            f"{document['decisions'][row['player']]:.2g}"
            if row["player"] in document["decisions"] else "–",
        ]  # fmt: skip
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    lines += [
        "",
        _budgets(document),
        "",
        (
            "| on the desk, one thing changed | at the end, a seed each | mean of the second half |"
            " least in it |"
        ),
        "|" + "---|" * 4,
    ]
    for row in changes(document):
        ends = " ".join(f"{seconds:g}" for seconds in row["at_the_end"])
        lines.append(f"| {row['recipe']} | {ends} | {row['mean']:.1f} s | {row['least']:g} s |")
    lines += [
        "",
        "| troubles | decider | seconds, calm | seconds, troubled | lost | lost |",
        "|" + "---|" * 6,
    ]
    for row in document["troubles"]:
        each = [rough - calm for calm, rough in zip(row["calm"], row["rough"], strict=True)]
        lost, calm, half = float(np.mean(each)), float(np.mean(row["calm"])), mean(each)["ci95"]
        shown = f"{lost:.1f} s" + (f" ± {half:.1f}" if half else "")
        lines.append(
            f"| {row['troubles']} | {row['decider']} | {calm:.1f} | {calm + lost:.1f} | {shown} |"
            f" {lost / calm:.1%} |"
        )
    lines += [
        "",
        "Troubles: "
        + "; ".join(
            f"{name}: the robot fails at {chance.robot_fails:.0%} of its pieces (repair"
            f" {chance.repair_s:g} s on average), the human at {chance.human_errs:.0%}"
            for name, chance in games.TROUBLES.items()
        )
        + ". The same ones for every decider.",
        *origin(document),
    ]
    return "\n".join(lines)


def _budgets(document: Mapping[str, Any]) -> str:
    """How long each recipe was trained."""
    told = []
    for recipe in runs.RECIPES:
        own = [
            record
            for record in document["records"]
            if record["recipe"] == recipe and record["curve"]
        ]
        spent, games = (
            [record["cpu_s"] for record in own],
            {record["curve"][-1]["games"] for record in own},
        )
        told.append(
            f"{recipe}: {' or '.join(map(str, sorted(games)))} games, {np.mean(spent):.0f} CPU s"
        )
    return f"A training, on average: {'; '.join(told)}."


def draw_figures(document: Mapping[str, Any], folder: Path) -> list[Path]:
    """Boards, films of games, gaps, troubles and learning curves, as SVG and PNG; returns the
    files.
    """
    from tandem.draw.saving import save
    from tandem.lab.yu2020.figures import figures

    folder.mkdir(parents=True, exist_ok=True)
    return [
        save(figure, folder / f"{name}{form}", dpi=110)
        for name, figure in figures(document)
        for form in (".svg", ".png")
    ]


def runs_on(cell: Cell) -> Board:
    """The cell as a board. Raises CellError that names every feature that the game cannot
    express.
    """
    return Board.of(cell)


def _train(cell: Cell, seed: int) -> Any:
    from tandem.lab.yu2020.board_training import train

    return train([Board.of(cell)], runs.QUICK.ours, seed=seed)[0]


def _play(cell: Cell, seed: int) -> Played:
    return _carry(cell, cell, seed)


def _carry(trained_on: Cell, played_on: Cell, seed: int) -> Played:
    from tandem.lab.yu2020.board_training import decide_ms, play

    board, trained = Board.of(played_on), _train(trained_on, seed)
    return Played(float(play(trained, [board], seed=seed)[0, 0]), (decide_ms(trained, board),))


def _beside_one_who_errs(cell: Cell, seed: int) -> Played:
    """A game in which the human does half of its pieces wrong, so that they are still there and
    somebody has to do them again.
    """
    from tandem.lab.yu2020.board_training import decider

    board, laid = Board.of(cell), layout(Board.of(cell))
    happens = fate(
        laid,
        Chance(robot_fails=0.0, human_errs=0.5),
        np.random.default_rng(seed).random((3, *laid.time.shape)),
    )
    game = play_one(board, decider(_train(cell, seed), board, seed=seed), fate=happens)
    return Played(float(game.makespan), deviations=len(game.moves) - len(board.pieces))


def _cost(cell: Cell) -> float:
    from tandem.lab.yu2020.optimal import optimum

    return float(optimum(Board.of(cell)).makespan)


def _exact(document: Mapping[str, Any]) -> Sequence[float]:
    return [
        document["exact"]["desk"]["no_waiting"]["makespan"],
        *document["exact"]["test"]["no_waiting"]["makespans"],
    ]


def _agents() -> Sequence[str]:
    from tandem.lab.yu2020.learn_env import BoardGame

    return BoardGame.of(desk()).agents


def _trains() -> Callable[..., Any]:
    from tandem.lab.yu2020.board_training import train

    return train


FEATURES = Features(
    trains=_trains,
    agents=_agents,
    cost=_cost,
    play=_play,
    carry=_carry,
    deviate=_beside_one_who_errs,
    exact=_exact,
)


def _gap(took: Any, optimum: Iterable[float]) -> dict[str, float | None]:
    """Mean over the boards of what was taken beyond the optimum, as a share of it."""
    return mean([float(value) for value in np.asarray(took) / np.asarray(list(optimum)) - 1])


def _beats(took: Any, other: Sequence[float]) -> float:
    return round(float(np.mean(np.asarray(took) < np.asarray(other))), 4)


def _percent(value: Mapping[str, float | None]) -> str:
    assert value["mean"] is not None
    return f"{value['mean']:.2%}" + (f" ± {value['ci95']:.2%}" if value["ci95"] else "")
