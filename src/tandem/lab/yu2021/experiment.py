"""Yu, Huang and Chang (2021): a deep Q-network for each agent on the Markov game of shared
assembly, more than two agents.

J. Manuf. Syst. 60, 487-499. Neither their task table nor their hyper-parameters nor their results
are public. So: parts of the desk of their first paper, played by three and four agents; their
recipe as far as it is known beside one network for all (single-agent DQN), our recipe, the best
dispatch rule, random play and the exact optimum.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory
from typing import Any

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.lab.quick import compiled_quickly
from tandem.lab.records import kept_record, stored_document, write_document
from tandem.lab.systems import Features, Played
from tandem.lab.yu2020.board import ROBOT, desk
from tandem.lab.yu2021.recipe import YU_2021
from tandem.learn.alphazero.recipes import ALPHAZERO, SearchRecipe
from tandem.learn.dqn.recipes import ValueRecipe
from tandem.learn.forms import unreadable
from tandem.learn.results import Reached
from tandem.learn.training.runs import RunFolder, asked_cell, versions

STORED = "yu2021.json"
SEEDS = 3
PROOF_S = 60.0
RANDOM_GAMES = 100

PUBLISHED = "not public"
"""Their tables are not; the abstract says that it was compared with Nash-Q, dynamic programming and
single-agent DQN.
"""

GAMES, QUICK_GAMES = 960, 64
"""Games of a training, the same for all recipes."""


@dataclass(frozen=True)
class Instance:
    """So many rows of the desk, from the bottom, for so many robots and humans."""

    rows: int
    robots: int
    humans: int

    @property
    def name(self) -> str:
        return (
            f"desk, {self.rows} rows, {self.robots} robot{'s' * (self.robots > 1)}, {self.humans}"
            f" human{'s' * (self.humans > 1)}"
        )

    def cell(self) -> Cell:
        """The cell: each robot can do what the robot could, each human what the human could.

        ASSUMPTION: theirs are desks "with different numbers of tasks and agents"; which ones is not
        public.
        """
        board = desk()
        whole = replace(
            board,
            height=self.rows,
            pieces=tuple(piece for piece in board.pieces if piece.row <= self.rows),
        ).to_cell()
        robots = [f"robot {number + 1}" for number in range(self.robots)]
        humans = [f"human {number + 1}" for number in range(self.humans)]
        able = lambda who: robots if who == ROBOT else humans  # noqa: E731
        tasks = {
            name: {
                "time": {own: seconds for who, seconds in task.time.items() for own in able(who)},
                "after": task.after,
            }
            for name, task in whole.tasks.items()
        }
        operators = {
            **{name: {"kind": "robot"} for name in robots},
            **{name: {"kind": "human"} for name in humans},
        }
        return cell_of({"name": self.name, "operators": operators, "tasks": tasks})


INSTANCES = (Instance(4, 2, 1), Instance(4, 2, 2), Instance(8, 2, 1), Instance(8, 2, 2))
QUICK_INSTANCES = (Instance(3, 2, 1),)


def recipes(games: int, tasks: int) -> dict[str, ValueRecipe | SearchRecipe]:
    """Name -> recipe, each with a budget of so many games of a cell with so many tasks."""
    side_by_side = ALPHAZERO.config.games
    described = replace(YU_2021, config=replace(YU_2021.config, decisions=games * tasks))
    ours = replace(
        ALPHAZERO, config=replace(ALPHAZERO.config, iterations=max(1, games // side_by_side))
    )
    return {
        "as described": described,
        "one network for all": replace(
            described, config=replace(described.config, agents="one", horizon="next")
        ),
        "ours": ours,
    }


def reproduce(
    folder: Path,
    *,
    quick: bool = False,
    seeds: int | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Trains, proves, and returns the document, which is also written to `folder/yu2021.json`.

    The runs are kept in `folder/records`; one that was stopped goes on where it was.
    """
    numbers = range(seeds or (1 if quick else SEEDS))
    instances, games = (QUICK_INSTANCES, QUICK_GAMES) if quick else (INSTANCES, GAMES)
    with compiled_quickly() if quick else nullcontext():
        rows = [_row(instance, numbers, folder / "records", games, tell) for instance in instances]
    document = {
        "schema_version": 1,
        "command": "tandem reproduce yu2021" + " --quick" * quick,
        "quick": quick,
        "seeds": list(numbers),
        "games": games,
        "versions": versions(),
        "published": PUBLISHED,
        "rows": rows,
    }
    return write_document(folder / STORED, document, indent=1)


def _row(
    instance: Instance, seeds: Sequence[int], records: Path, games: int, tell: Callable[[str], None]
) -> dict[str, Any]:
    """One instance: its optimum, the players that learn nothing, and every recipe over the
    seeds.
    """
    from tandem.plan.methods import plan

    cell = instance.cell()
    exact = plan(
        cell, minimize="makespan", time_limit=PROOF_S, seed=0, settle=False, confirm=False
    )[0]
    chance = _random(cell)
    tell(f"{instance.name}: {len(cell.tasks)} tasks, optimum {exact.makespan:g} s ({exact.status})")
    learned = {}
    for name, recipe in recipes(games, len(cell.tasks)).items():
        began = time.process_time()
        run = RunFolder(records / f"{_file_name(instance.name)}-{_file_name(name)}-{len(seeds)}")
        learned[name] = kept_record(
            run.path.with_suffix(".json"),
            partial(_learned, cell, recipe, seeds, run),
            {"cell": cell.digest, "recipe": recipe.to_dict(), "seeds": list(seeds)},
        )
        tell(f"  {name}: greedy {learned[name]['greedy']}, {time.process_time() - began:.0f} CPU s")
    return {
        "instance": instance.name,
        "tasks": len(cell.tasks),
        "agents": len(cell.operators),
        "exact": exact.makespan,
        "status": exact.status,
        "bound": exact.bound.makespan,
        "rule": _quickest_rule(cell),
        "random": {"mean": round(fmean(chance), 3), "best": min(chance), "games": len(chance)},
        "learned": learned,
    }


def _learned(
    cell: Cell, recipe: ValueRecipe | SearchRecipe, seeds: Sequence[int], run: RunFolder
) -> dict[str, Any]:
    """What a training reached, and each seed's (decisions, greedy seconds). One that was stopped
    is gone on with in its folder.

    Raises:
      CellError: the folder holds another training, or one that is damaged.
      KeyboardInterrupt: it was stopped again; what it has saved is gone on with the next time.
    """
    from tandem.learn.training import trainer

    if (run.path / "run.json").exists():
        _same_training(run, cell, seeds)
        result = trainer.resume(run.path)
    else:
        result = trainer.train(
            cell,
            recipe_name="yu2021",
            own_recipe=recipe,
            seeds=tuple(seeds),
            folder=run.path,
            front_limit=1.0,
        )
    if result["interrupted"]:
        raise KeyboardInterrupt
    played = result["seeds"]
    return {
        "greedy": [row["greedy"]["makespan"] for row in played],
        "best_of_n": [row["best_of_n"]["makespan"] for row in played],
        "n": played[0]["best_of_n"]["n"],
        "cpu_s": round(sum(row["cpu_s"] for row in played), 1),
        "curve": _curves(run, seeds),
    }


def _same_training(run: RunFolder, cell: Cell, seeds: Sequence[int]) -> None:
    """Raises CellError when the folder holds the training of another cell or of other seeds."""
    asked = run.asked()
    if asked.seeds != tuple(seeds) or asked_cell(run, asked).digest != cell.digest:
        other = "holds a training of another cell or of other seeds. Delete it: it is made anew."
        raise unreadable(run.path, [other])


def _curves(run: RunFolder, seeds: Sequence[int]) -> list[list[list[float | None]]]:
    """Per seed the (decisions, seconds of the greedy policies) of every interval."""
    rows = run.figures()
    if rows and (missing := {"steps", "greedy_makespan"} - rows[0].keys()):
        without = (
            f"has no figures {' and '.join(sorted(missing))}. Delete the folder: it is made anew."
        )
        raise unreadable(run.path / "metrics.jsonl", [without])
    return [
        [[row["steps"], row["greedy_makespan"]] for row in rows if row["seed"] == seed]
        for seed in seeds
    ]


def _file_name(name: str) -> str:
    return name.replace(", ", "-").replace(" ", "-")


def _random(cell: Cell) -> list[float]:
    return [
        game.makespan for game in at_random(cell, games=RANDOM_GAMES) if game.makespan is not None
    ]


def at_random(cell: Cell, *, games: int, seed: int = 0) -> list[Reached]:
    """Games in which every move is any legal one, nobody waiting of his own will."""
    import jax

    from tandem.learn.alphazero.config import EpsilonGreedy
    from tandem.learn.alphazero.network import Scorer
    from tandem.learn.alphazero.rollout import game_of, play
    from tandem.learn.alphazero.trained import Trained

    network = Scorer(1)
    nobody = Trained(network, network.start(jax.random.key(0)))
    return play(
        cell,
        game_of(cell, 0.0, waiting=False),
        nobody,
        EpsilonGreedy(share=1.0),
        games=games,
        seed=seed,
    )


def stored() -> dict[str, Any]:
    """The document of the long run that ships with the package. Raises CellError when this copy has
    none, or a damaged one.
    """
    return stored_document("yu2021/results.json", "yu2021")


def _quickest_rule(cell: Cell) -> dict[str, Any]:
    from tandem.learn.baseline import best_rule

    rule = best_rule(cell, lambda makespan, _: makespan)
    assert rule is not None  # their cells know no limits
    return {"name": rule.name, "makespan": rule.result.makespan}


def _rule_of(row: Mapping[str, Any]) -> Mapping[str, Any]:
    """The best rule of a row's instance, worked out anew in less than a second: records of earlier
    versions left out the strongest one, `best-of-n`.
    """
    known = {instance.name: instance for instance in INSTANCES}
    if row["instance"] not in known:
        found: Mapping[str, Any] = row["rule"]
        return found
    return _quickest_rule(known[row["instance"]].cell())


def table(document: Mapping[str, Any]) -> str:
    """Published, as described, one network for all, ours and exact, seconds; means over seeds, in
    brackets the best of several drawn games.
    """
    drawn = {name: learned["n"] for name, learned in document["rows"][0]["learned"].items()}
    names, seeds = list(drawn), len(document["seeds"])
    lines = [
        (
            f"Seconds of the greedy policies, mean over {seeds} training{'s' * (seeds > 1)} of"
            f" {document['games']} games each; in brackets the mean of the best of several games"
            f" that are drawn ({', '.join(f'{name}: {number}' for name, number in drawn.items())})."
            f" `{document['command']}`."
        ),
        "",
        (
            f"| instance | tasks | agents | published | random | best rule | {' | '.join(names)} |"
            " exact |"
        ),
        "|" + "---|" * (7 + len(names)),
    ]
    for row in document["rows"]:
        learned = [
            f"{_mean(row['learned'][name]['greedy'])} ({_mean(row['learned'][name]['best_of_n'])})"
            for name in names
        ]
        proof = "" if row["status"] == "optimal" else f" (at least {row['bound']:g})"
        plain = [
            row["instance"],
            str(row["tasks"]),
            str(row["agents"]),
            document["published"],
            f"{row['random']['mean']:.1f}",
        ]
        told = _rule_of(row)
        rule = f"{told['makespan']:g} ({told['name']})"
        lines.append("| " + " | ".join([*plain, rule, *learned, f"{row['exact']:g}{proof}"]) + " |")
    return "\n".join(lines)


def draw_figures(document: Mapping[str, Any], folder: Path) -> list[Path]:
    """A learning curve for each instance, all recipes, mean and 95 % interval over the seeds."""
    folder.mkdir(parents=True, exist_ok=True)
    from tandem.draw.curves import plot_curves
    from tandem.draw.figure import blank
    from tandem.draw.saving import save

    files = []
    for row in document["rows"]:
        ax = blank(7.0, 4.2).axes[0]
        lines = {name: _line(one["curve"]) for name, one in row["learned"].items()}
        levels = {"exact": row["exact"], "random": row["random"]["mean"]}
        plot_curves(
            lines,
            ax,
            xlabel="decisions",
            ylabel="makespan of the greedy policies, s",
            title=row["instance"],
            levels=levels,
        )
        for form in ("svg", "png"):
            file = folder / f"{_file_name(row['instance'])}.{form}"
            save(ax, file)
            files.append(file)
    return files


def _line(
    curve: Sequence[Sequence[Sequence[float]]],
) -> tuple[list[list[float]], list[list[float]]]:
    done = [[point for point in seed if point[1] is not None] for seed in curve]
    return [[point[0] for point in seed] for seed in done], [
        [point[1] for point in seed] for seed in done
    ]


def runs_on(cell: Cell) -> Cell:
    """The cell itself: the game is that of the event world, which holds every cell. Raises
    CellError for times too large to be counted.
    """
    from tandem.learn.alphazero.rollout import game_of

    game_of(cell, 0.0, waiting=False)
    return cell


def _small(cell: Cell, stress_factor: float = 0.0) -> tuple[Any, Any]:
    """The cell's game, and networks after a training of seconds."""
    from tandem.learn.alphazero.rollout import game_of
    from tandem.learn.alphazero.trained import Trained
    from tandem.learn.dqn.network import ValueNetworks
    from tandem.learn.training import trainer

    recipe = replace(
        YU_2021,
        samples=1,
        config=replace(
            YU_2021.config, decisions=480, games=8, kept=256, minibatch=16, warm_up=5, units=8
        ),
    )
    with TemporaryDirectory() as scratch:
        folder = Path(scratch) / "run"
        order: dict[str, Any] = {
            "own_recipe": recipe,
            "seeds": (0,),
            "front_limit": 1.0,
            "stress_factor": stress_factor,
        }
        if trainer.train(cell, recipe_name="yu2021", folder=folder, **order)["interrupted"]:
            raise KeyboardInterrupt
        trained = Trained.load(RunFolder(folder).policy(0), ValueNetworks)
    return game_of(cell, stress_factor, waiting=False), trained


def _trains() -> Callable[..., Any]:
    from tandem.learn.dqn.learning import advance

    return advance


def _agents() -> Sequence[str]:
    return tuple(INSTANCES[-1].cell().operators)


def _cost(cell: Cell) -> float:
    """What random play costs in the game's own cost, the mean of some games with the same draws."""
    return fmean(game.cost for game in at_random(cell, games=16))


def _play(cell: Cell, seed: int) -> Played:
    return _carry(cell, cell, seed)


def _carry(trained_on: Cell, played_on: Cell, seed: int) -> Played:
    from tandem.learn.alphazero.rollout import game_of, play

    _, trained = _small(trained_on)
    began = time.perf_counter()
    game = play(played_on, game_of(played_on, 0.0, waiting=False), trained, seed=seed)[0]
    each = 1000 * (time.perf_counter() - began) / len(played_on.tasks)
    return Played(game.makespan, (each,) * len(played_on.tasks))


def _exact(document: Mapping[str, Any]) -> list[float]:
    return [row["exact"] for row in document["rows"] if row["status"] == "optimal"]


FEATURES = Features(
    trains=_trains, agents=_agents, cost=_cost, play=_play, carry=_carry, exact=_exact
)


def _mean(values: Iterable[float | None]) -> str:
    """Mean; "not finished" when a game was not."""
    known = list(values)
    return (
        "not finished"
        if None in known
        else f"{fmean(value for value in known if value is not None):.1f}"
    )
