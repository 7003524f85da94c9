"""`tandem dispatch` as an integrator tries it: a pipe, a kill, the same again, garbage, an
unplugged robot.
"""

from __future__ import annotations

import io
import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tandem.cli.root import run

CELL = str(Path("examples/thesis.yaml").resolve())
CREW = str(Path("examples/crew.yaml").resolve())
TWO = (
    '{"event": "started", "at": 0, "task": 1, "operator": "robot", "id": 1}\n'
    '{"event": "done", "at": 9, "task": 1, "id": 2}\n'
)


class Said:
    """What a run of the command said."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.err = code, err
        self.documents: list[dict[str, Any]] = [
            json.loads(line) for line in out.splitlines() if line.startswith("{")
        ]
        self.out = out

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [document for document in self.documents if document["type"] == kind]


@pytest.fixture
def dispatch(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Any:
    def go(*arguments: object, lines: str | bytes = "") -> Said:
        data = lines.encode() if isinstance(lines, str) else lines
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(data)))
        code = run(["dispatch", CELL, "--policy", "longest-tail", *map(str, arguments)])
        out, err = capfd.readouterr()
        return Said(code, out, err)

    return go


def test_two_events_are_piped_in(dispatch: Any) -> None:
    said = dispatch(lines=TWO)
    assert said.code == 0
    assert [document["type"] for document in said.documents] == [
        "shift",
        "decision",
        "answer",
        "decision",
        "answer",
        "decision",
        "summary",
    ]
    assert [answer["accepted"] for answer in said.of("answer")] == [True, True]
    assert (
        said.documents[-1]["over"],
        said.documents[-1]["events"],
        said.documents[-1]["late"],
    ) == (False, 2, 0)


def test_the_same_events_again_are_known_and_garbage_is_answered(
    dispatch: Any, tmp_path: Path
) -> None:
    journal = tmp_path / "shift.db"
    first = dispatch("--journal", journal, lines=TWO)
    assert "Go on with: tandem dispatch" in first.err
    again = dispatch(
        "--journal",
        journal,
        lines=TWO.encode() + b"\n  \n\xff\xfe garbage\n" + b"x" * 400_000 + b"\n[]\n",
    )
    assert again.of("shift")[0]["resumed"]
    assert [answer.get("duplicate_of") for answer in again.of("answer")] == [1, 2, None, None, None]
    assert again.of("decision") == [first.of("decision")[-1]], (
        "what was decided last is told again, and nothing else"
    )
    assert "more than 64000 characters" in again.of("answer")[3]["reasons"][0]
    replayed = dispatch("--journal", journal, "--replay")
    assert (replayed.code, replayed.out) == (
        0,
        "8 entries, 2 events taken, 3 decisions: the same.\n",
    )


IN_WINDOWS = '{"event":"tick","at":1,"id":"MÜ-1"}\n{"event":"tick","at":1,"id":"MÖ-1"}\n'


@pytest.mark.parametrize("coding", ["cp1252", "utf-16", "utf-16-le"])
@pytest.mark.parametrize("from_file", [True, False], ids=["a file", "a pipe"])
def test_events_that_are_not_utf_8_are_refused_line_by_line(
    coding: str, from_file: bool, dispatch: Any, tmp_path: Path
) -> None:
    raw = IN_WINDOWS.encode(coding)
    (tmp_path / "events.jsonl").write_bytes(raw)
    said = dispatch("--events", tmp_path / "events.jsonl") if from_file else dispatch(lines=raw)
    assert said.code == 0
    assert len(said.of("answer")) >= 2
    assert all("this line is not UTF-8" in answer["reasons"][0] for answer in said.of("answer"))
    assert said.documents[-1]["events"] == 0


def test_a_mark_of_byte_order_is_no_part_of_the_first_event(dispatch: Any) -> None:
    said = dispatch(lines=b"\xef\xbb\xbf" + TWO.encode())
    assert [answer["accepted"] for answer in said.of("answer")] == [True, True]


def test_a_robot_is_unplugged_and_a_human_refuses(dispatch: Any) -> None:
    lines = [
        {"event": "started", "at": 0, "task": "1", "operator": "robot"},
        {"event": "failed", "at": 2, "operator": "robot"},
        {"event": "failed", "at": 3, "task": "1"},
        {"event": "refused", "at": 3, "task": "1", "operator": "human"},
    ]
    said = dispatch(lines="\n".join(map(json.dumps, lines)))
    assert all(answer["accepted"] for answer in said.of("answer"))
    assert said.of("decision")[-1]["starts"] == []
    assert said.of("decision")[-1]["announced"] in ({"human": "2"}, {"human": "3"})


def test_events_come_from_a_file_and_a_simulated_floor_runs_to_the_end(
    dispatch: Any, tmp_path: Path
) -> None:
    (tmp_path / "events.jsonl").write_text(TWO)
    assert dispatch("--events", tmp_path / "events.jsonl").documents[-1]["events"] == 2
    said = dispatch(
        "--simulate",
        "pace:2",
        "--cv",
        "0.2",
        "--failures",
        "30",
        "--absences",
        "40",
        "--seed",
        "5",
        "--journal",
        tmp_path / "s.db",
    )
    assert said.documents[-1]["over"]
    assert said.of("decision")[-1]["over"]
    again = dispatch(
        "--simulate",
        "pace:2",
        "--cv",
        "0.2",
        "--failures",
        "30",
        "--absences",
        "40",
        "--seed",
        "5",
        "--journal",
        tmp_path / "s.db",
    )
    assert [document["type"] for document in again.documents] == ["shift", "decision", "summary"]


REFUSED: list[tuple[tuple[str, ...], int, str]] = [
    (("--simulate", "fast"), 2, "there is no such kind of person"),
    (("--policy", "atuo"), 2, "there is no policy 'atuo'. Did you mean 'auto'?"),
    (("--budget", "0"), 2, "--budget"),
    (("--start", "noon"), 2, "'noon' is no time"),
    (("--start", "2026-03-02T06:00:00"), 2, "has no time zone"),
    (("--replay",), 2, "name the journal with --journal"),
    (("--replay", "--journal", "none.db"), 2, "there is no such journal"),
    (("--journal", CELL), 3, "this is no journal of a shift"),
    (("--journal", "nowhere/shift.db"), 2, "there is no folder"),
    (("--events", "none.jsonl"), 2, "does not exist"),
    (("--products", "-1"), 2, "a shift begins with 0 to 1000"),
    (("--variant", "short"), 2, "write NAME=FILE"),
    (("--variant", f"a={CELL}", "--variant", f"a={CELL}"), 2, "the name 'a' was given twice"),
    (("--variant", "a=none.yaml"), 3, "none.yaml"),
    (("--variant", f"a={CREW}"), 2, "Give both the same."),
]


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    REFUSED,
    ids=[" ".join(row[0]).rpartition("/")[2] for row in REFUSED],
)
def test_what_is_wrong_with_the_call_is_said(
    arguments: tuple[str, ...], code: int, says: str, dispatch: Any
) -> None:
    said = dispatch(*arguments)
    assert (said.code, said.documents) == (code, [])
    assert says in said.err
    assert "Traceback" not in said.err


def test_a_journal_keeps_what_the_shift_was_begun_with(dispatch: Any, tmp_path: Path) -> None:
    journal = tmp_path / "shift.db"
    dispatch("--journal", journal, "--seed", "7", "--max-stress", "20", lines=TWO)
    said = dispatch("--journal", journal, "--seed", "8", "--weights", "1,2")
    assert said.code == 2
    assert "--seed is 8, the shift was begun with 7." in said.err
    assert "--weights is 1,2, the shift was begun with 1,0." in said.err
    assert dispatch("--journal", journal).of("shift")[0]["seed"] == 7


def test_on_a_terminal_it_speaks_in_words(dispatch: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tandem.cli.dispatch._is_terminal", lambda: True)
    lines = (
        TWO + '{"event": "wrong", "at": 9, "task": 1}\n'
        '{"event": "started", "at": 9, "task": 3, "operator": "human"}\n'
        "x\n"
    )
    said = dispatch(lines=lines)
    for words in (
        "Advice, not a safety function",
        "started '1' (robot)",
        "robot '1' until about 9 s",
        "take '1' apart",
        "refused    this is not JSON",
        "not over",
    ):
        assert words in said.out


def test_products_are_made_one_after_the_other(dispatch: Any, tmp_path: Path) -> None:
    arguments = ("--products", 3, "--simulate", "pace:1.6", "--journal", tmp_path / "s.db")
    said = dispatch(*arguments)
    assert (said.documents[-1]["products"], said.documents[-1]["over"]) == (3, True)
    assert said.of("decision")[0]["product"]["number"] == 1
    assert said.of("decision")[-1]["product"]["number"] == 3
    again = dispatch(*arguments)
    assert [document["type"] for document in again.documents] == ["shift", "decision", "summary"]
    other = dispatch("--products", 4, "--journal", tmp_path / "s.db")
    assert (other.code, other.documents) == (2, [])
    assert "--products is 4, the shift was begun with 3." in other.err


def test_a_variant_is_named_by_its_product(dispatch: Any, tmp_path: Path) -> None:
    short = tmp_path / "short.yaml"
    short.write_text(
        "operators: {robot: {kind: robot}, human: {kind: human}}\n"
        "tasks: {lid: {time: {human: 3}, stress: 1}}\n"
    )
    arguments = ("--variant", f"short={short}", "--products", 0, "--journal", tmp_path / "s.db")
    lines = (
        '{"event": "product", "at": 0, "order": "A-1", "variant": "short"}\n'
        '{"event": "started", "at": 0, "task": "lid", "operator": "human"}\n'
        '{"event": "done", "at": 3, "task": "lid"}\n'
        '{"event": "product", "at": 3, "order": "A-2"}\n'
    )
    said = dispatch(*arguments, lines=lines)
    assert all(answer["accepted"] for answer in said.of("answer"))
    assert said.of("shift")[0]["variants"] == ["short"]
    assert said.of("decision")[-1]["product"]["order"] == "A-2"
    resumed = dispatch("--journal", tmp_path / "s.db")
    assert resumed.of("shift")[0]["variants"] == ["short"], "the journal has it"
    assert dispatch("--journal", tmp_path / "s.db", "--replay").code == 0


def test_products_in_words(dispatch: Any) -> None:
    lines = Path("examples/products.jsonl").read_text()
    said = dispatch("--products", 0, "--words", lines=lines)
    for words in (
        "product 1 (order 'A-17'), begun at 0 s",
        "done by",
        "person 'Anna' (human)",
        "stuck      task '6' by human: what task '6' needs is missing.",
        "product 2 (order 'A-18'), begun at 29.5 s",
        "end",
    ):
        assert words in said.out


def program(*arguments: object) -> list[str]:
    return [
        sys.executable,
        "-m",
        "tandem.cli",
        "dispatch",
        CELL,
        "--policy",
        "longest-tail",
        *map(str, arguments),
    ]


@pytest.mark.parametrize(
    ("number", "code", "says"),
    [
        (signal.SIGINT, 130, "interrupted. Go on with"),
        (signal.SIGTERM, 0, "terminated. Go on with"),
    ],
)
def test_it_ends_cleanly_when_it_is_told_to(
    number: int, code: int, says: str, tmp_path: Path, dispatch: Any
) -> None:
    journal = tmp_path / "shift.db"
    with subprocess.Popen(
        program("--journal", journal), stdin=-1, stdout=-1, stderr=-1, text=True
    ) as shift:
        assert shift.stdin is not None and shift.stdout is not None and shift.stderr is not None  # noqa: PT018  for the type checker
        shift.stdin.write(TWO)
        shift.stdin.flush()
        for _ in range(6):
            shift.stdout.readline()
        second = subprocess.run(
            program("--journal", journal), stdin=subprocess.DEVNULL, capture_output=True, text=True
        )
        assert (second.returncode, "another shift is writing this journal" in second.stderr) == (
            2,
            True,
        )
        shift.send_signal(number)
        assert shift.wait(20) == code
        assert says in shift.stderr.read()
    assert dispatch("--journal", journal).of("shift")[0]["number"] == 2


def test_killed_ten_times_nothing_is_lost_or_doubled(tmp_path: Path) -> None:
    """The command of the benchmark, on a small scale."""
    from benchmarks.kill import run as kill

    document = kill(5, "longest-tail", 8, 1, 0.05, tmp_path)
    for row in document["rows"]:
        assert row["kills"] >= 3
        assert row["wrong"] == []
        assert row["replay_is_the_same"]


def test_a_shift_of_products_that_is_killed_loses_nothing(tmp_path: Path) -> None:
    """The benchmark of long shifts, on a small scale."""
    from benchmarks.long_shift import faults
    from benchmarks.long_shift import run as long_shift

    document = long_shift(["longest-tail"], 6, 4, 1.6, 7, 1, tmp_path, seconds=0.2)
    assert faults(document) == []
    assert document["rows"][0]["kills"] >= 2


def test_the_long_shift_that_is_committed_is_the_one_that_the_manual_tells() -> None:
    from benchmarks.long_shift import faults

    document = json.loads(Path("benchmarks/results/long_shift.json").read_text())
    assert (document["products"], document["pace"], faults(document)) == (50, 1.6, [])
    assert all(row["kills"] == 20 for row in document["rows"])
    page = Path("docs/dispatch.md").read_text()
    for row in document["rows"]:
        assert f"| `{row['policy']}` | {row['events']} |" in page


def test_the_result_that_is_committed_is_the_one_that_the_manual_tells() -> None:
    rows = json.loads(Path("benchmarks/results/kill.json").read_text())["rows"]
    assert [(row["kills"], row["wrong"], row["replay_is_the_same"]) for row in rows] == [
        (100, [], True)
    ] * 2
    page = Path("docs/dispatch.md").read_text()
    starting, unanswered, again = (
        sum(row[key] for row in rows)
        for key in ("while_starting", "with_an_unanswered_event", "sent_again_and_known")
    )
    for words in (
        f"{rows[0]['events']} events with kills",
        f"{starting} kills",
        f"{unanswered} while an event",
        f"{again} events were in the journal",
    ):
        assert words in page
