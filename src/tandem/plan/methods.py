"""Every method of planning in one table, and `plan`, the way in."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from difflib import get_close_matches
from inspect import signature
from math import inf
from pathlib import Path
from time import monotonic
from traceback import extract_tb
from typing import Any

from tandem.cell.model import Cell
from tandem.errors import (
    CellError,
    Fault,
    InfeasibleError,
    TandemError,
    UnsoundScheduleError,
    UsageError,
)
from tandem.extensions import Table
from tandem.plan import dynamic_programming, exact, worst_stress
from tandem.plan.canonical import settled, unproven
from tandem.plan.confirm import SHARE, apology, confirm_none, confirmed, is_asked
from tandem.plan.cpsat import SOLVER
from tandem.plan.door import RefusedScheduleWarning
from tandem.plan.infeasible import infeasible
from tandem.plan.method import Hint, Method, Progress
from tandem.plan.question import Question
from tandem.plan.result import Front, Outcome
from tandem.plan.rules import RULES, SPECS
from tandem.schedule.checker import faults


@dataclass(frozen=True)
class Entry:
    """A line of the table; it is called like the method itself.

    Attributes:
      what: the method does, in a line.
      settles: which of equal schedules it gives says nothing, so that the last step of planning
        may choose (`canonical.py`). The schedule of a rule is what the rule says.
    """

    what: str
    solve: Method
    settles: bool = False

    def __call__(self, *arguments: Any, **options: Any) -> Front:
        return self.solve(*arguments, **options)

    @property
    def draws(self) -> bool:
        """Whether it can be told how many schedules to draw: it takes `samples`."""
        return self._takes("samples")

    @property
    def reads(self) -> bool:
        """Whether it can be given a policy that was trained: it takes `policy`."""
        return self._takes("policy")

    def _takes(self, option: str) -> bool:
        solve = self.solve.solve if isinstance(self.solve, _Own) else self.solve
        return option in signature(solve).parameters


def theirs(home: str, found: Any) -> Entry:
    """The line of a method that others add. Raises UsageError for what is no method."""
    if isinstance(found, Entry):
        return found
    if not callable(found):
        raise UsageError(
            f"{home}: is {found!r}, and no method. A method is called as"
            " tandem.plan.method.Method says."
        )
    said = (found.__doc__ or "").strip().partition("\n")[0]
    return Entry(said or f"a method of your own, {home}", _Own(home, found))


@dataclass(frozen=True)
class _Own:
    """A method of somebody else: what it raises is told with its place, and its schedules are
    checked.
    """

    home: str
    solve: Method

    def __call__(self, cell: Cell, question: Question = Question(), **options: Any) -> Front:
        try:
            front = self.solve(cell, question, **options)
        except TandemError:
            raise
        except Exception as error:
            last = extract_tb(error.__traceback__)[-1]
            place = "" if last.filename == __file__ else f" ({last.filename}:{last.lineno})"
            raise UsageError(
                f"{self.home}: {type(error).__name__}: {' '.join(str(error).split())}{place}. A"
                " method is called as tandem.plan.method.Method says."
            ) from error
        if not isinstance(front, Front):
            raise UsageError(f"{self.home}: answered {front!r}, and no tandem.Front.")
        for result in front:
            if wrong := faults(cell, result.schedule):
                raise UnsoundScheduleError([f"{self.home}: {fault}" for fault in wrong])
        return front


METHODS: Table[Entry] = Table(
    "methods",
    {
        "exact": Entry(
            "CP-SAT beside large-neighbourhood search: the complete front with proof",
            exact.solve,
            settles=True,
        ),
        "exhaustive": Entry(
            "dynamic programming, no constraint solver: the complete front of small cells with"
            " proof",
            dynamic_programming.solve,
            settles=True,
        ),
        **{name: Entry(SPECS[name].what, solve) for name, solve in RULES.items()},
    },
    theirs,
)
"""Name -> method. A new one is a file and a line here, an entry point of the group
`tandem.methods`, or anybody's by its dotted name.
"""


MOST_TASKS = 20_000
"""With more, even the first schedule takes minutes, and no time limit could be kept."""

LAST_STEP = 0.1
"""The share of the time limit of a front that its search leaves to the last step, which chooses the
schedules behind the points that are proven by then.
"""


def describe(method: str) -> str:
    """What a method does, in a line."""
    return METHODS.told(lambda entry: entry.what)[method]


def plan(
    cell: Cell,
    question: Question | None = None,
    *,
    method: str = "exact",
    minimize: str = "front",
    weights: tuple[float, float] = (1.0, 1.0),
    max_makespan: float | None = None,
    max_stress: float | None = None,
    time_limit: float | None = 60.0,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    samples: int | None = None,
    policy: str | Path | None = None,
    hint: Hint = None,
    on_solution: Callable[[Progress], None] | None = None,
    settle: bool = True,
    confirm: bool = True,
) -> Front:
    """The complete trade-off between makespan (seconds) and stress, each point with a schedule and
    what is proven about it.

    Args:
      cell: what is to be assembled, and who is there.
      question: instead of `minimize`, `weights`, `max_makespan` and `max_stress`, which are its
        parts.
      method: a name in `METHODS`.
      time_limit: seconds; None to go on until everything is proven.
      work: a limit on the work of the search instead of its time, in CP-SAT's deterministic
        seconds; of the exhaustive search, in units of `dynamic_programming.NODES_A_SECOND`. No
        clock is asked then: `time_limit` plays no part, and a run repeats exactly for a seed and
        version, proven or not.
      workers: threads; None for one a core. Behind a proven point stands the same schedule
        (`canonical.py`) with any number of them.
      samples: how many schedules a method makes that draws them (`learned`); its own number when
        None.
      policy: a file with a trained policy for a method that reads one (`learned`); what comes with
        Tandem when None.
      hint: a schedule to begin with, or several, such as those of an earlier front; the ones that
        the checker refuses are left aside.
      on_solution: called with each improvement; raising KeyboardInterrupt in it ends the search
        with what was found.
      settle: choose the canonical schedule of each proven point. False for callers who read the
        values alone: the last step often takes longer than the search.
      confirm: what CP-SAT has proven of a cell of up to `confirm.MOST_TASKS` tasks is confirmed by
        the dynamic program, which calls no solver. Leave it out where only values are wanted.

    Raises:
      UsageError: an unknown method, or an option out of range.
      CellError: the cell has more than `MOST_TASKS` tasks.
      InfeasibleError: it is proven that no schedule answers the question; its `reasons` say, in the
        cell's words, what stands in the way.
      NothingFoundError: none was found within the limit.
    """
    _check(cell, minimize if question is None else question.minimize, method)
    check_effort(time_limit, work, workers)
    if question is None:
        question = Question(minimize, weights, max_makespan, max_stress)  # type: ignore[arg-type]
    began = monotonic()
    settles = settle and METHODS[method].settles
    kept_back = LAST_STEP if question.minimize == "front" and settles else 0.0
    # a method that knows no limit on work is not told of one that nobody asked for
    limit: dict[str, float | None] = (
        {"time_limit": None if time_limit is None else time_limit * (1 - kept_back)}
        if work is None
        else {"time_limit": None, "work": work}
    )
    told = _drawn(samples, method) | _read(policy, method)

    def solve(asked: Cell, question: Question, seconds: float | None) -> Front:
        return METHODS[method](
            asked,
            question,
            **{**limit, **told, "time_limit": seconds},
            seed=seed,
            workers=workers,
            hint=hint,
            on_solution=on_solution,
        )

    def for_confirming() -> float | None:
        if work is not None or time_limit is None:
            return None
        return SHARE * (began + time_limit - monotonic())

    try:
        if question.minimize == "worst-stress":
            front = worst_stress.solve(cell, question, solve, limit["time_limit"])
        else:
            front = solve(cell, question, limit["time_limit"])
    except InfeasibleError as error:
        if confirm and method == "exact" and is_asked(cell, question):
            confirm_none(cell, question, for_confirming())
        raise infeasible(str(error), cell, question) from error
    if confirm and front.complete and front.solver == SOLVER and is_asked(cell, question):
        front = confirmed(front, for_confirming(), unproven)
        if front.confirmation is not None and front.confirmation.outcome == Outcome.DISAGREES:
            warnings.warn(apology(), RefusedScheduleWarning, stacklevel=2)
    if settles and not front.interrupted:
        until = None if work is not None or time_limit is None else began + time_limit
        front = settled(front, until=until, workers=workers or os.cpu_count() or 1)
    if front.cell is not cell:
        front = worst_stress.unlimited(front, cell)
    return replace(front, wall_s=monotonic() - began)


def _check(cell: Cell, minimize: str, method: str) -> None:
    """Refuses what cannot be asked."""
    if minimize == "change":
        raise UsageError("fewest changes are counted from an old plan: ask tandem.replan for them.")
    if method not in METHODS:
        near = get_close_matches(method, METHODS, 1, 0.5)
        hint_text = f"Did you mean {near[0]!r}? " if near else ""
        raise UsageError(
            f"there is no method {method!r}. {hint_text}There are {', '.join(METHODS)}."
        )
    if len(cell.tasks) > MOST_TASKS:
        raise CellError(
            [
                Fault(
                    f"the cell has {len(cell.tasks):,} tasks, and at most {MOST_TASKS:,} can be"
                    " planned. Split it.",
                    ("tasks",),
                )
            ]
        )


def _drawn(samples: int | None, method: str) -> dict[str, int]:
    """How many schedules the method is told to draw, as an option where it is told. Raises
    UsageError for a number that is none, or that the method has no use for.
    """
    if samples is None:
        return {}
    if samples < 1:
        raise UsageError(f"samples {samples}: must be 1 or more.")
    if not METHODS[method].draws:
        able = ", ".join(name for name, entry in METHODS.items() if entry.draws)
        raise UsageError(
            f"samples {samples}: method {method!r} draws no schedules whose number could be told."
            f" Those that do: {able}."
        )
    return {"samples": samples}


def _read(policy: str | Path | None, method: str) -> dict[str, Path]:
    """The trained policy as an option of the method. Raises UsageError where it reads none."""
    if policy is None:
        return {}
    if not METHODS[method].reads:
        able = ", ".join(name for name, entry in METHODS.items() if entry.reads)
        raise UsageError(
            f"policy {policy}: method {method!r} reads no trained policy. Those that do: {able}."
        )
    return {"policy": Path(policy)}


def check_effort(time_limit: float | None, work: float | None, workers: int | None) -> None:
    """Refuses limits that are none, with UsageError."""
    if time_limit is not None and not time_limit > 0:
        raise UsageError(f"time limit {time_limit}: must be more than 0 seconds.")
    if work is not None and not 0 < work < inf:
        raise UsageError(f"work {work}: must be a number of more than 0.")
    if workers is not None and workers < 1:
        raise UsageError(f"workers {workers}: must be 1 or more.")
