"""What a method found: one schedule with its bounds, or a front of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell, plain
from tandem.plan.knee import Recommended, knee_index, recommended
from tandem.plan.provers import Prover, Step
from tandem.plan.question import Question
from tandem.schedule.cost import cost_of_a_piece
from tandem.schedule.measures import makespan, stress, stress_by_human
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

SCHEMA_VERSION = 1

FRAME_OF_TASKS = ["point", "makespan", "stress", "task", "operators", "start", "end"]


class Status(StrEnum):
    """How far a result is proven, in the solver's words."""

    OPTIMAL = "optimal"
    FEASIBLE = "feasible"


@dataclass(frozen=True)
class Bound:
    """No schedule that answers the same question can be better than this: seconds, and stress in
    the cell's measure.

    For a point of a front the question is "least makespan among the schedules with at most this
    stress" for `makespan`, and "least stress among the schedules with at most this makespan" for
    `stress`.

    Attributes:
      of_makespan, of_stress: what each prover gave, in rising order; the last one is who proved the
        bound. Empty where nobody is known, as in results that were stored without.
    """

    makespan: float
    stress: float
    of_makespan: tuple[Step, ...] = field(default=(), compare=False)
    of_stress: tuple[Step, ...] = field(default=(), compare=False)

    @property
    def proved_by(self) -> tuple[Prover, Prover] | None:
        """Who proved the bound of the makespan, and that of the stress."""
        if not self.of_makespan or not self.of_stress:
            return None
        return self.of_makespan[-1].by, self.of_stress[-1].by

    def to_dict(self) -> dict[str, Any]:
        """As a point of a result document holds it: `bound`, and `proved_by` where it is known."""
        numbers = {"makespan": plain(self.makespan), "stress": plain(self.stress)}
        if self.proved_by is None:
            return {"bound": numbers}
        by = dict(zip(("makespan", "stress"), map(str, self.proved_by), strict=True))
        return {"bound": numbers, "proved_by": by}


class Outcome(StrEnum):
    """What came of a second opinion on what CP-SAT has proven."""

    AGREES = "confirmed"
    DISAGREES = "contradicted"
    OPEN = "not finished"


@dataclass(frozen=True)
class Confirmation:
    """What the dynamic program says of a proven answer, after so many partial schedules."""

    outcome: Outcome
    states: int

    def to_dict(self) -> dict[str, Any]:
        """As a result document holds it."""
        by = str(Prover.DYNAMIC)
        return {"by": by, "outcome": str(self.outcome), "states": self.states}


@dataclass(frozen=True)
class Beyond:
    """A number of a cell that lies outside of what a policy was trained on: `least` to `most`. What
    a cell has or has not is 1 or 0.
    """

    what: str
    value: float
    least: float
    most: float

    def to_dict(self) -> dict[str, Any]:
        """As a result document holds it."""
        numbers = {key: plain(getattr(self, key)) for key in ("value", "least", "most")}
        return {"what": self.what, **numbers}


@dataclass(frozen=True)
class Confidence:
    """How far a trained policy is to be trusted with a cell.

    Attributes:
      chance: what it gave the choices of its likeliest schedules, mean over those that left it one;
        None where none did.
      beyond: what of the cell is unlike all that it was trained on.
    """

    chance: float | None
    beyond: tuple[Beyond, ...]

    def to_dict(self) -> dict[str, Any]:
        """As a result document holds it."""
        return {"chance": self.chance, "beyond": [one.to_dict() for one in self.beyond]}


@dataclass(frozen=True)
class Quantiles:
    """Makespans of simulated assemblies, seconds: `p50`, `p95`, over so many `episodes`."""

    p50: float
    p95: float
    episodes: int

    def to_dict(self) -> dict[str, Any]:
        """As a `risk` of a result document holds it."""
        return {"p50": plain(self.p50), "p95": plain(self.p95), "episodes": self.episodes}


@dataclass(frozen=True)
class Risk:
    """What a schedule's makespan becomes on the floor, where times scatter.

    Attributes:
      fixed: when it is carried out as it stands, only the clock giving way.
      replanned: when the rest is planned anew at every event and the schedule is left where that
        gains; None where that was not asked, no live decider can hold the cell, or no time was
        left.
    """

    fixed: Quantiles
    replanned: Quantiles | None

    def to_dict(self) -> dict[str, Any]:
        """As a result document holds it."""
        replanned = None if self.replanned is None else self.replanned.to_dict()
        return {"fixed": self.fixed.to_dict(), "replanned": replanned}


@dataclass(frozen=True)
class Result:
    """One schedule and how good it is proven to be.

    Attributes:
      canonical: the schedule is the one that stands behind these values in every run.
      risk: what becomes of it where times scatter; None when that was not asked.
    """

    cell: Cell
    schedule: Schedule
    status: Status
    bound: Bound
    canonical: bool = False
    risk: Risk | None = None

    @cached_property
    def makespan(self) -> float:
        """When the last task ends, seconds."""
        return makespan(self.schedule)

    @cached_property
    def stress(self) -> float:
        """The cell's measure of stress: the sum over tasks done by humans unless the cell says
        otherwise.
        """
        return stress(self.cell, self.schedule)

    @cached_property
    def worst_stress(self) -> float:
        """The stress of the human who has most; 0 without humans."""
        return max(stress_by_human(self.cell, self.schedule).values(), default=0.0)

    @property
    def cost(self) -> float | None:
        """Of a piece, where the station makes one at a time; None when the cell states no cost."""
        return cost_of_a_piece(self.cell, self.makespan)

    @property
    def gap(self) -> float:
        """How far the makespan may be above the best, as a share of it; 0 when optimal."""
        return (self.makespan - self.bound.makespan) / max(self.makespan, 1e-9)

    def to_dict(self) -> dict[str, Any]:
        """One entry of `front` in a result document."""
        return {
            "makespan": plain(self.makespan),
            "stress": plain(self.stress),
            "status": str(self.status),
            **self.bound.to_dict(),
            "canonical": self.canonical,
            "digest": self.schedule.digest,
            **({} if self.cost is None else {"cost_per_piece": plain(self.cost)}),
            **({} if self.risk is None else {"risk": self.risk.to_dict()}),
            "assignments": self.schedule.to_list(),
        }


@dataclass(frozen=True)
class Front:
    """The results that nothing found beats in both makespan and stress, sorted by makespan.

    Attributes:
      complete: every point, and the absence of others, is proven.
      solver: name and version of what proved or found it.
      interrupted: the search was stopped from outside; what it had is here.
      out_of_time: the time limit ended the search.
      question: what was asked: all compromises or one, and within which limits.
      source: the file of the cell as it was named; None when the cell came from elsewhere.
      robust: what is recommended is chosen by the P95 of the makespan as carried out.
      bound_front: (makespan, stress), sorted by makespan: each schedule that answers the question
        is at least as great in both as one of these (a lower bound set; Ehrgott and Gandibleux
        2007, Bound sets for biobjective combinatorial optimization problems, Computers and
        Operations Research 34(9), 2674-2694). Empty where the method says nothing of them, or
        nothing is open.
      open_area: the share of the front's area that is neither reached by what was found nor ruled
        out by what was proven (`Archive.open_area`); None where that was not told.
      confirmation: a second opinion on what CP-SAT has proven; None where nobody was asked.
      confidence: of the trained policy that made schedules; None where none did.
    """

    cell: Cell
    results: tuple[Result, ...]
    complete: bool
    method: str
    solver: str
    seed: int
    wall_s: float
    interrupted: bool = False
    question: Question = Question()
    source: str | None = None
    robust: bool = False
    out_of_time: bool = False
    bound_front: tuple[tuple[float, float], ...] = ()
    open_area: float | None = None
    confirmation: Confirmation | None = None
    confidence: Confidence | None = None

    def __iter__(self) -> Iterator[Result]:
        return iter(self.results)

    def __len__(self) -> int:
        return len(self.results)

    def __getitem__(self, index: int) -> Result:
        return self.results[index]

    @property
    def points(self) -> list[tuple[float, float]]:
        """(makespan, stress) of each result."""
        return [(result.makespan, result.stress) for result in self.results]

    @property
    def ended_by(self) -> str:
        """What ended the search: "proof" when nothing is open, else "interrupted", "time" or
        "work", when all that it was to do is done.
        """
        if self.interrupted:
            return "interrupted"
        if self.complete:
            return "proof"
        return "time" if self.out_of_time else "work"

    @property
    def knee(self) -> Result:
        """The recommended compromise: the point farthest below the straight line between the
        front's two ends, both axes scaled to the front's own range (Das 1999). The quickest when
        the front has fewer than three points or none lies below the line. Where the front is not
        complete, a proven point that is nearly as good is preferred (`plan.knee`). Of a `robust`
        front it is that of the points (P95 of the makespan as carried out, stress).
        """
        return self.results[self.knee_place]

    @property
    def knee_place(self) -> int:
        """Index of the knee."""
        return self._recommended.place

    @property
    def is_knee_certain(self) -> bool:
        """Whether the recommended point stays the recommended one whatever is learned later."""
        return self._recommended.certain

    @cached_property
    def _recommended(self) -> Recommended:
        if self.robust:
            return Recommended(self._robust_place(), self.complete)
        if self.complete:
            return Recommended(knee_index(self.points), True)
        proven = [result.status == Status.OPTIMAL for result in self]
        return recommended(self.points, proven, self.bound_front)

    def _robust_place(self) -> int:
        late = [
            result.makespan if result.risk is None else result.risk.fixed.p95 for result in self
        ]
        # points that another one beats in both are no compromise
        kept = sorted(
            (
                place
                for place, (time, (_, load)) in enumerate(zip(late, self.points, strict=True))
                if not any(
                    other <= time and less <= load and (other, less) != (time, load)
                    for other, (_, less) in zip(late, self.points, strict=True)
                )
            ),
            key=late.__getitem__,
        )
        return kept[knee_index([(late[place], self.points[place][1]) for place in kept])]

    def shown(self, point: int | None = None) -> Result:
        """The point of this number, counted from 1; the knee when none is given."""
        return self.knee if point is None else self.results[point - 1]

    def to_dict(self) -> dict[str, Any]:
        """The result document of `tandem plan --json`."""
        asks_for_worst = self.question.minimize == "worst-stress"
        return {
            "schema_version": SCHEMA_VERSION,
            "cell": self.cell.name,
            "cell_digest": self.cell.digest,
            "objectives": ["makespan", "stress"],
            "complete": self.complete,
            "method": self.method,
            "solver": self.solver,
            "seed": self.seed,
            "wall_s": round(self.wall_s, 4),
            "interrupted": self.interrupted,
            **self._recommendation(),
            "ended_by": self.ended_by,
            "question": self.question.to_dict(),
            **self._open(),
            **({} if self.confirmation is None else {"confirmation": self.confirmation.to_dict()}),
            **({} if self.confidence is None else {"confidence": self.confidence.to_dict()}),
            "front": [
                {
                    **result.to_dict(),
                    **({"worst_stress": plain(result.worst_stress)} if asks_for_worst else {}),
                }
                for result in self.results
            ],
            "source": self.source,
            "cell_document": self.cell.to_dict(),
        }

    def _recommendation(self) -> dict[str, Any]:
        """What a result document says of the point that is recommended."""
        if not self.results:
            return {}
        chosen = {"point": self.knee_place + 1, "certain": self.is_knee_certain}
        return {**({"recommended_by": "p95"} if self.robust else {}), "recommended": chosen}

    def _open(self) -> dict[str, Any]:
        """What a result document says of the part of the front that is not known."""
        if self.complete or not self.bound_front:
            return {}
        pairs = [
            {"makespan": plain(makespan), "stress": plain(stress)}
            for makespan, stress in self.bound_front
        ]
        share = {} if self.open_area is None else {"open_area": round(self.open_area, 6)}
        return {**share, "bound_front": pairs}

    def to_frame(self, *, tasks: bool = False) -> pandas.DataFrame:
        """One row a point: makespan, stress, status, bounds. Needs pandas.

        Args:
          tasks: one row for every task of every point instead: the point (counted from 1), its
            makespan and stress, the task, its operators joined by " + ", start and end in seconds.
        """
        import pandas

        if tasks:
            of_tasks = [
                {
                    "point": place,
                    "makespan": result.makespan,
                    "stress": result.stress,
                    "task": one.task,
                    "operators": " + ".join(one.operators),
                    "start": one.start,
                    "end": one.end,
                }
                for place, result in enumerate(self.results, 1)
                for one in result.schedule
            ]
            return pandas.DataFrame(of_tasks, columns=FRAME_OF_TASKS)
        rows = [
            {
                "makespan": r.makespan,
                "stress": r.stress,
                "status": str(r.status),
                "bound_makespan": r.bound.makespan,
                "bound_stress": r.bound.stress,
            }
            for r in self.results
        ]
        return pandas.DataFrame(rows)

    def plot(self, ax: Axes | None = None) -> Axes:
        """The front as a picture; `ax` in, `ax` out. Needs matplotlib."""
        from tandem.draw.front import plot_front

        return plot_front(self, ax=ax)
