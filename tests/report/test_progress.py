"""Progress on stderr: a line for each improvement, a reminder now and then, nothing on stdout."""

from __future__ import annotations

import io
import time

import pytest
from tests.draw.cells import thesis, thesis_front

from tandem.plan.method import Progress
from tandem.plan.methods import plan
from tandem.report.progress import SolveProgress

QUICK, KNEE, _ = thesis_front()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_line_says_objective_bound_gap_and_time() -> None:
    stream = io.StringIO()
    with SolveProgress(stream) as progress:
        progress(Progress((KNEE,), 20.4, 0.1))
    seconds, _, said = stream.getvalue().partition(" s  ")
    assert float(seconds) >= 0
    assert said == "makespan 24 s, stress 3, bound 20.4 s, gap 15 %, 1 point\n"


def test_only_what_is_new_makes_a_line() -> None:
    stream = io.StringIO()
    with SolveProgress(stream) as progress:
        for state in (
            Progress((KNEE,), 20, 0),
            Progress((KNEE,), 20, 0),
            Progress((KNEE,), 24, 0),
            Progress((QUICK, KNEE), 20, 0),
        ):
            progress(state)
    lines = stream.getvalue().splitlines()
    assert [line.partition("  ")[2] for line in lines] == [
        "makespan 24 s, stress 3, bound 20 s, gap 17 %, 1 point",
        "makespan 24 s, stress 3, bound 24 s, gap 0 %, 1 point",
        "makespan 23 s, stress 7, bound 20 s, gap 13 %, 2 points",
    ]


def test_silence_is_broken_now_and_then() -> None:
    stream = io.StringIO()
    with SolveProgress(stream, every_s=0.05):
        deadline = time.monotonic() + 10
        while stream.getvalue().count("searching") < 3 and time.monotonic() < deadline:
            time.sleep(0.01)
    assert stream.getvalue().count("searching") >= 3


def test_a_terminal_gets_one_live_line(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("NO_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal()
    with SolveProgress(stream) as progress:
        progress(Progress((KNEE,), 20, 0))
        deadline = time.monotonic() + 10
        while "makespan 24 s" not in stream.getvalue() and time.monotonic() < deadline:
            time.sleep(0.05)
    assert "makespan 24 s, stress 3" in stream.getvalue()
    assert "\x1b[2K" in stream.getvalue()


def test_a_dumb_terminal_gets_plain_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "dumb")
    stream = Terminal()
    with SolveProgress(stream) as progress:
        progress(Progress((KNEE,), 20, 0))
    assert "\x1b" not in stream.getvalue()
    assert "makespan 24 s" in stream.getvalue()


def test_a_real_search_reports_to_stderr_only(capsys: pytest.CaptureFixture[str]) -> None:
    with SolveProgress() as progress:
        front = plan(thesis(), on_solution=progress, workers=1)
    out, err = capsys.readouterr()
    assert out == ""
    assert "makespan 23 s, stress 7" in err
    assert progress.last is not None
    assert [(r.makespan, r.stress) for r in progress.last.found] == front.points


def test_quiet_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    with SolveProgress(quiet=True) as progress:
        progress(Progress((KNEE,), 20, 0))
    assert capsys.readouterr() == ("", "")
    assert progress.newest is KNEE


def test_an_interruption_passes_through_and_the_reminder_ends() -> None:
    stream = io.StringIO()
    with pytest.raises(KeyboardInterrupt), SolveProgress(stream, every_s=0.01):
        raise KeyboardInterrupt
    before = stream.getvalue()
    time.sleep(0.05)
    assert stream.getvalue() == before


def test_of_a_front_it_is_said_how_much_is_open_and_proven() -> None:
    stream = io.StringIO()
    with SolveProgress(stream) as progress:
        for found, share in (
            ((KNEE,), 1.0),
            ((KNEE,), 0.95),
            ((KNEE,), 0.5),
            ((QUICK, KNEE), 0.0004),
            ((QUICK, KNEE), 0.0),
        ):
            progress(Progress(found, 20, 0.1, share))
    told = [line.partition("  ")[2] for line in stream.getvalue().splitlines()]
    assert told == [
        "makespan 24 s, stress 3; 1 point, 1 proven",
        "makespan 24 s, stress 3; 1 point, 1 proven, 50 % of the front's area open",
        "makespan 23 s, stress 7; 2 points, 2 proven, < 0.1 % of the front's area open",
        "makespan 23 s, stress 7; 2 points, 2 proven, 0 % of the front's area open",
    ]
