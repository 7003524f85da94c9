"""What was found for a station that repeats: one pattern with its bounds, or a front of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.plan.cycle.question import FRONT, CycleQuestion
from tandem.plan.knee import knee_index
from tandem.plan.result import SCHEMA_VERSION, Status
from tandem.schedule import measures
from tandem.schedule.cost import cost_of_a_piece
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.model import Schedule

OBJECTIVES = ["cycle_time", "stress"]
"""What the points of such a front are compared by."""


@dataclass(frozen=True)
class CycleBound:
    """No pattern that answers the same question can be better than this.

    Attributes:
      cycle_time: seconds; of the patterns with at most this stress.
      stress: of each product, of the patterns with at most this cycle time.
      in_process: products; of the patterns with this cycle time and stress.
    """

    cycle_time: float
    stress: float
    in_process: int

    def to_dict(self) -> dict[str, Any]:
        """As the `bound` of a point."""
        return {
            "cycle_time": plain(self.cycle_time),
            "stress": plain(self.stress),
            "in_process": self.in_process,
        }


@dataclass(frozen=True)
class CycleResult:
    """One pattern and how good it is proven to be.

    Attributes:
      status: "optimal" when cycle time and stress are proven; how few may be in process is told by
        the bound.
      canonical: the pattern is the one that stands behind these values in every run.
    """

    cell: Cell
    periodic: PeriodicSchedule
    status: Status
    bound: CycleBound
    canonical: bool = False

    @property
    def schedule(self) -> Schedule:
        """One product, from its own launch."""
        return self.periodic.schedule

    @property
    def cycle_time(self) -> float:
        """Seconds between two products."""
        return self.periodic.cycle_time

    @property
    def makespan(self) -> float:
        """Seconds that one product is in the station."""
        return self.periodic.makespan

    @property
    def in_process(self) -> int:
        """The most products in the station at once."""
        return self.periodic.in_process

    @cached_property
    def stress(self) -> float:
        """Of each product, in the cell's measure of stress."""
        return measures.stress(self.cell, self.schedule)

    @property
    def gap(self) -> float:
        """How far the cycle time may be above the best, as a share of it; 0 when optimal."""
        return (self.cycle_time - self.bound.cycle_time) / self.cycle_time

    @property
    def cost(self) -> float | None:
        """Of all that a cycle makes; None when the cell states no cost."""
        return cost_of_a_piece(self.cell, self.cycle_time)

    @property
    def per_hour(self) -> float:
        """Products in an hour of the steady state."""
        return 3600 / self.cycle_time

    @cached_property
    def utilisation(self) -> dict[str, float]:
        """Share of each cycle that each operator spends on tasks."""
        working = measures.working(self.cell, self.schedule)
        return {name: seconds / self.cycle_time for name, seconds in working.items()}

    def to_dict(self) -> dict[str, Any]:
        """One entry of `front` in a result document."""
        return {
            "cycle_time": plain(self.cycle_time),
            "stress": plain(self.stress),
            "makespan": plain(self.makespan),
            "in_process": self.in_process,
            "status": str(self.status),
            "bound": self.bound.to_dict(),
            "canonical": self.canonical,
            **({} if self.cost is None else {"cost_per_piece": plain(self.cost)}),
            "digest": self.periodic.digest,
            "assignments": self.schedule.to_list(),
        }


@dataclass(frozen=True)
class CycleFront:
    """The patterns that nothing found beats in both cycle time and stress, sorted by cycle time.

    Attributes:
      complete: every point, and the absence of others, is proven.
      interrupted: the search was stopped from outside; what it had is here.
      out_of_time: the time limit ended the search.
      source: the file of the cell as it was named; None when the cell came from elsewhere.
      mix: variant -> how many of it each cycle makes, in the order of the products; empty where
        each makes one product of the cell.
    """

    cell: Cell
    results: tuple[CycleResult, ...]
    complete: bool
    method: str
    solver: str
    seed: int
    wall_s: float
    interrupted: bool = False
    question: CycleQuestion = FRONT
    source: str | None = None
    out_of_time: bool = False
    mix: tuple[tuple[str, int], ...] = ()

    @property
    def products(self) -> int:
        """How many products a cycle makes."""
        return sum(count for _, count in self.mix) or 1

    def __iter__(self) -> Iterator[CycleResult]:
        return iter(self.results)

    def __len__(self) -> int:
        return len(self.results)

    def __getitem__(self, index: int) -> CycleResult:
        return self.results[index]

    @property
    def points(self) -> list[tuple[float, float]]:
        """(cycle time, stress) of each result."""
        return [(result.cycle_time, result.stress) for result in self.results]

    @property
    def ended_by(self) -> str:
        """What ended the search: "proof", "interrupted", "time" or "work"."""
        if self.interrupted:
            return "interrupted"
        if self.complete:
            return "proof"
        return "time" if self.out_of_time else "work"

    @property
    def knee_place(self) -> int:
        """Index of the recommended compromise, found as that of a front of makespans is."""
        return knee_index(self.points)

    @property
    def knee(self) -> CycleResult:
        """The recommended compromise."""
        return self.results[self.knee_place]

    def shown(self, point: int | None = None) -> CycleResult:
        """The point of this number, counted from 1; the knee when none is given."""
        return self.knee if point is None else self.results[point - 1]

    def to_dict(self) -> dict[str, Any]:
        """The result document of `tandem plan --cycle --json`."""
        return {
            "schema_version": SCHEMA_VERSION,
            "cell": self.cell.name,
            "cell_digest": self.cell.digest,
            "objectives": OBJECTIVES,
            "complete": self.complete,
            "method": self.method,
            "solver": self.solver,
            "seed": self.seed,
            "wall_s": round(self.wall_s, 4),
            "interrupted": self.interrupted,
            "ended_by": self.ended_by,
            "question": self.question.to_dict(),
            **({"mix": dict(self.mix), "products_per_cycle": self.products} if self.mix else {}),
            "front": [result.to_dict() for result in self.results],
            "source": self.source,
            "cell_document": self.cell.to_dict(),
        }
