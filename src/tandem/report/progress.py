"""What a method knows while it works, on stderr: one live line in a terminal, else a line now and
then.
"""

from __future__ import annotations

import sys
import threading
import time
from types import TracebackType
from typing import TYPE_CHECKING, Self, TextIO

from tandem.plan.method import Progress
from tandem.plan.result import Result, Status
from tandem.report.language import Words, words

if TYPE_CHECKING:
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

EVERY_S = 10.0
LESS = 0.8
"""A line is written when less than this is open of what was open at the line before."""
LEAST_SHOWN = 0.001
"""A share that is open and less is said to be less than this."""


class SolveProgress:
    """A context manager that is the `on_solution` of a method: `with SolveProgress() as progress:
    method(cell, on_solution=progress)`.

    In a terminal one line is kept up to date; elsewhere a line is written with each improvement and
    every ten seconds. `TERM=dumb` counts as elsewhere. Nothing is ever written to stdout.

    Args:
      stream: where to write; stderr when absent.
      quiet: write nothing, only keep what was told in `last`.
      every_s: seconds between lines when nothing happens and nobody sees a live line.
      language: of what is written.
    """

    def __init__(
        self,
        stream: TextIO | None = None,
        *,
        quiet: bool = False,
        every_s: float = EVERY_S,
        language: str = "en",
    ):
        self.stream, self.quiet, self.every_s = stream, quiet, every_s
        self.words = words(language)
        self.last: Progress | None = None
        self.newest: Result | None = None
        self._open = 1.0 / LESS
        self._began = time.monotonic()
        self._live: Live | None = None
        self._console: Console | None = None
        self._done = threading.Event()
        self._writing = threading.Lock()
        self._written_at = self._began
        self._watch: threading.Thread | None = None

    def __enter__(self) -> Self:
        self._began = self._written_at = time.monotonic()
        if self.quiet:
            return self
        from rich.console import Console

        self._console = Console(file=self.stream or sys.stderr, highlight=False)
        if self._console.is_terminal and not self._console.is_dumb_terminal:
            from rich.live import Live

            self._live = Live(
                get_renderable=self._line,
                console=self._console,
                refresh_per_second=4,
                transient=True,
            )
            self._live.start()
        else:
            self._watch = threading.Thread(target=self._remind, name="tandem-progress", daemon=True)
            self._watch.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._done.set()
        if self._watch is not None:
            self._watch.join()
        if self._live is not None:
            self._live.stop()

    def __call__(self, progress: Progress) -> None:
        known = set(self._points(self.last))
        new = [result for result in progress.found if _point(result) not in known]
        better_bound = self.last is None or progress.bound > self.last.bound
        self.last = progress
        self.newest = new[-1] if new else self.newest
        less_open = progress.open_area is not None and progress.open_area < LESS * self._open
        if (new or better_bound or less_open) and self._live is None and not self.quiet:
            self._open = progress.open_area or self._open
            self._write()

    def wording(self) -> str:
        """The line: time, objective, bound, gap, points so far. The gap is that of the newest
        point, to which the bound belongs. Of a front that is worked through: how many points, how
        many of them proven, how much of its area is open.
        """
        t = self.words
        tenths = f"{time.monotonic() - self._began:.1f}"
        time_s = f"{tenths.replace('.', t('decimal'))} s"
        if self.last is None:
            return f"{time_s}  {t('progress.searching')}"
        if self.newest is None:
            return f"{time_s}  {t('progress.nothing', bound=t.seconds(self.last.bound))}"
        if self.last.open_area is not None:
            return f"{time_s}  {self._front(self.newest, self.last, self.last.open_area)}"
        makespan = self.newest.makespan
        gap = max(0.0, makespan - self.last.bound) / max(makespan, 1e-9)
        found = t(
            "progress.found",
            makespan=t.seconds(makespan),
            stress=t.number(self.newest.stress),
            bound=t.seconds(self.last.bound),
            gap=t.share(gap),
            points=t.count("picture.points", len(self.last.found)),
        )
        return f"{time_s}  {found}"

    def _front(self, newest: Result, progress: Progress, open_area: float) -> str:
        """What is said of a front that is worked through."""
        t = self.words
        said = {
            "makespan": t.seconds(newest.makespan),
            "stress": t.number(newest.stress),
            "points": t.count("picture.points", len(progress.found)),
            "proven": sum(result.status == Status.OPTIMAL for result in progress.found),
        }
        if open_area >= 1:  # the first schedules are the area's frame: their share says nothing
            return t("progress.front_begun", **said)
        return t("progress.front", **said, open=open_share(open_area, t))

    @staticmethod
    def _points(progress: Progress | None) -> list[tuple[float, float]]:
        return [] if progress is None else [_point(result) for result in progress.found]

    def _line(self) -> Text:
        from rich.text import Text

        return Text(self.wording(), no_wrap=True, overflow="ellipsis")

    def _write(self) -> None:
        if self._console is None:
            return
        with self._writing:
            self._written_at = time.monotonic()
            self._console.print(self.wording(), soft_wrap=True, markup=False)

    def _remind(self) -> None:
        while not self._done.wait(max(0.0, self._written_at + self.every_s - time.monotonic())):
            if time.monotonic() - self._written_at >= self.every_s:
                self._write()


def open_share(share: float, t: Words) -> str:
    """How much of a front's area is open, in words; never that nothing is while anything is."""
    return f"< {t.share(LEAST_SHOWN)}" if 0 < share < LEAST_SHOWN else t.share(share)


def _point(result: Result) -> tuple[float, float]:
    return result.makespan, result.stress
