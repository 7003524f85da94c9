"""The published systems that run here, and what each experiment module must offer."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, cast

from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import UsageError

Document = Mapping[str, Any]
"""What a reproduction found, in plain data; see `Experiment.reproduce`."""


@dataclass(frozen=True)
class Played:
    """How one episode on a cell went.

    Attributes:
      makespan: seconds, on the cell's own clock (or steps, where the system knows no seconds); None
        when the episode did not reach the goal.
      decisions_ms: how long each decision of the robot's side took, milliseconds.
      deviations: how often the human did something else than it was told or expected to.
      undone: how often something that stood wrongly was taken apart again.
    """

    makespan: float | None
    decisions_ms: tuple[float, ...] = ()
    deviations: int = 0
    undone: int = 0


@dataclass(frozen=True)
class Features:
    """Handles by which the laboratory finds out what a system can do. It calls them on small cells
    of its own: no entry of the matrix is prose.

    Each may raise CellError for a cell that the system cannot express; the matrix then says so,
    with the words of the error. None where the system has no such thing. All must be quick (a
    second or two, compiling included): short trainings, small budgets.

    Attributes:
      trains: gives the function that trains it (so that it is imported only then); its module under
        `learn` names the algorithm.
      agents: who decides, by name, read off the world or policy that is trained.
      cost: what the system itself says that a cell costs: the least cost by its own objective, or
        that of one fixed policy. A number that moves with the cell's times, stress or difficulty
        exactly when the system minds them; other units are welcome.
      play: (cell, seed): one episode by a policy that may be trained on this very cell first.
      carry: (trained_on, played_on, seed): one episode on a cell that the policy was not trained
        on.
      deviate: (cell, seed): one episode with a human who does not do what is expected.
      mistake: (cell, seed): one episode with a human who mounts something wrongly at least once.
      exact: document -> the exact (proven) values that it holds; empty when it holds none.
    """

    trains: Callable[[], Callable[..., Any]]
    agents: Callable[[], Sequence[str]]
    cost: Callable[[Cell], float]
    play: Callable[[Cell, int], Played]
    carry: Callable[[Cell, Cell, int], Played] | None = None
    deviate: Callable[[Cell, int], Played] | None = None
    mistake: Callable[[Cell, int], Played] | None = None
    exact: Callable[[Document], Sequence[float]] | None = None


class Experiment(Protocol):
    """What the module of a system offers."""

    FEATURES: Features

    def reproduce(
        self,
        folder: Path,
        *,
        quick: bool = False,
        seeds: int | None = None,
        tell: Callable[[str], None] = lambda _: None,
    ) -> dict[str, Any]:
        """Runs the system and returns the document, which is also written to `folder/NAME.json`. A
        run that was stopped goes on where it was.

        The document has at least "schema_version", "command", "quick", "seeds" or "records", and
        "versions".
        """

    def stored(self) -> dict[str, Any]:
        """The document of the long run that ships with the package. Raises CellError when this copy
        has none.
        """

    def table(self, document: Document) -> str:
        """Published, as described, our recipe and exact, side by side: Markdown, with a first line
        or two on how it was made.
        """

    def draw_figures(self, document: Document, folder: Path) -> list[Path]:
        """Draws the figures as SVG and PNG into the folder and returns the files."""

    def runs_on(self, cell: Cell) -> Any:
        """The cell as the system holds it. Raises CellError that names every feature that it cannot
        express.
        """


@dataclass(frozen=True)
class System:
    """A system by name.

    Attributes:
      title: authors, year, and what it is in a few words.
      module: where its experiment is; loaded when asked for.
      published: False for a study of our own, which has no place in the comparison of systems.
      takes_cases: `reproduce` has an argument `cases`, files of further cells.
    """

    title: str
    module: str
    published: bool = True
    takes_cases: bool = False

    def load(self) -> Experiment:
        """Its experiment module."""
        return cast(Experiment, importlib.import_module(self.module))


SYSTEMS: dict[str, System] = {
    "thesis": System("Kinat 2023: two independent PPO agents", "tandem.lab.kinat2023.experiment"),
    "yu2020": System(
        "Yu, Huang, Chang 2020: the chessboard and AlphaGo-Zero-style search",
        "tandem.lab.yu2020.experiment",
    ),
    "yu2021": System(
        "Yu, Huang, Chang 2021: a deep Q-network for each agent, more than two agents",
        "tandem.lab.yu2021.experiment",
    ),
    "antonelli2021": System(
        "Antonelli et al. 2021: Q-learning with disassembly", "tandem.lab.antonelli2021.experiment"
    ),
    "alessio2022": System(
        "Alessio et al. 2022: PPO against an adversary on a grid",
        "tandem.lab.alessio2022.experiment",
    ),
    "zhang2022": System(
        "Zhang et al. 2022: two actors that share a critic, cooperation and collaboration",
        "tandem.lab.zhang2022.experiment",
    ),
    "cells": System(
        "our recipe on cells that are not the thesis's",
        "tandem.lab.other_cells",
        published=False,
        takes_cases=True,
    ),
}
"""Name -> system. A new one is a module and a line here."""


def system(name: str) -> System:
    """The system of that name.

    Raises UsageError, with the nearest known name, when there is none.
    """
    if name not in SYSTEMS:
        raise UsageError(f"system {name!r}: there is none. {Known(SYSTEMS).hint(name)}")
    return SYSTEMS[name]
