"""Carries a sweep out, from wherever it stands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tandem.bench.engines import ENGINES
from tandem.bench.folder import SweepFolder
from tandem.bench.jobs import Job, jobs_of, sharded
from tandem.bench.outcome import Answer, Failure
from tandem.bench.spec import Spec
from tandem.errors import UsageError


@dataclass(frozen=True)
class State:
    """How far a sweep, or a shard of it, is: so many of so many jobs, and the last one."""

    done: int
    of: int
    last: Job | None = None


def carry_on(
    spec: Spec,
    folder: str | Path,
    *,
    jobs: int = 1,
    shard: tuple[int, int] | None = None,
    engine: str = "processes",
    tell: Callable[[State], None] = lambda _: None,
) -> list[Failure]:
    """Does what is missing in the folder, each job once, and returns those that failed; they are
    done again by the next call.

    Every result is on the disk before the next one is asked for: a call that is stopped loses what
    is in hand and nothing else.

    Args:
      jobs: done side by side.
      shard: `(i, n)`: the i-th of n parts, counted from 1; other parts may be done elsewhere, in
        the same folder or in one of their own.
      engine: "processes" of this machine, or "ray".
      tell: hears of every job.

    Raises:
      UsageError: a number is out of range, the folder holds something else, or Ray is missing.
      KeyboardInterrupt: it was stopped; what is done is kept.
    """
    if jobs < 1:
        raise UsageError(f"jobs {jobs}: must be 1 or more.")
    if shard is not None and not 1 <= shard[0] <= shard[1]:
        raise UsageError(
            f"shard {shard[0]}/{shard[1]}: the first number is from 1 to the second one."
        )
    if engine not in ENGINES:
        raise UsageError(f"there is no engine {engine!r}: choose {' or '.join(ENGINES)}.")
    place = SweepFolder(Path(folder))
    place.begin(spec)
    wanted = sharded(jobs_of(spec), shard)
    todo = [job for job in wanted if not place.has(job)]
    done, failures = len(wanted) - len(todo), list[Failure]()
    tell(State(done, len(wanted)))
    if not todo:
        return []
    cells = {cell.digest: cell for cell in spec.cells.values()}
    answers = ENGINES[engine](todo, cells, min(jobs, len(todo)))
    try:
        for answer in answers:
            if isinstance(answer, Answer):
                place.keep(answer)
                done += 1
                tell(State(done, len(wanted), answer.job))
            else:
                failures.append(answer)
    finally:
        close = getattr(answers, "close", None)
        if close is not None:
            close()
    return failures
