"""A shift as an integrator meets it: events in, answers and decisions out, and nothing changed by
what is wrong.
"""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path
from time import sleep
from typing import Any

import pytest
from tests.dispatch.cells import GEARBOX, Plain, Saying, in_time, line

from tandem.dispatch.deciders.policy import Decision
from tandem.dispatch.journal import Journal, JournalError
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.situation.events import LONGEST_LINE
from tandem.dispatch.situation.model import Situation

STARTED, DONE = (
    line("started", 0, task="base", operator="cobot", id="a"),
    line("done", 4.5, task="base", id="b"),
)


def opened(journal: Journal | None = None, **kwargs: Any) -> Shift:
    return Shift.open(
        GEARBOX,
        journal or Journal(),
        Settings(),
        decider=kwargs.pop("decider", None) or in_time(),
        **kwargs,
    )


def test_a_shift_begins_with_a_decision_and_each_event_leads_to_another() -> None:
    shift = opened()
    assert shift.decision["starts"] == []
    assert shift.decision["announced"] == {"anna": "base"}
    answer, decision = shift.take(STARTED)
    assert (answer["accepted"], answer["number"], answer["id"]) == (True, 1, "a")
    assert (decision["number"], decision["announced"], decision["over"]) == (1, {}, False)
    _, decision = shift.take(DONE)
    assert decision["starts"] == [{"task": "gear", "operators": ["cobot"], "order": 2}]
    assert decision["announced"] == {"anna": "shaft"}


@pytest.mark.parametrize(
    "text",
    [
        "garbage",
        STARTED.replace("base", "bse"),
        line("done", 9, task="shaft"),
        line("tick", 0.5),
        DONE.replace("4.5", "5"),
    ],
)
def test_what_is_wrong_is_answered_logged_and_changes_nothing(text: str) -> None:
    shift = opened()
    shift.take(STARTED)
    shift.take(DONE)
    before, decision = shift.situation, shift.decision
    [answer] = shift.take(text)
    assert answer["accepted"] is False
    assert answer["reasons"]
    assert (shift.situation, shift.decision) == (before, decision)
    *_, last = shift.journal.entries()
    assert (last.line, last.event, last.answer, last.number) == (text, None, answer, 3)


def test_the_same_event_twice_is_taken_once() -> None:
    shift = opened()
    shift.take(STARTED)
    situation = shift.situation
    [answer] = shift.take(STARTED)
    assert (answer["accepted"], answer["duplicate_of"]) == (True, 1)
    assert shift.situation == situation
    [answer] = shift.take(line("started", 0, task="base", operator="cobot"))
    assert answer["reasons"] == ["task 'base' is under way since 0 s, by cobot."], (
        "without an id it cannot be known for a repetition"
    )


def test_an_id_stands_for_one_event_only() -> None:
    shift = opened()
    shift.take(STARTED)
    [answer] = shift.take(line("tick", 1, id="a"))
    assert answer["reasons"] == ["the id 'a' stands for another event, number 1."]


def test_a_refused_event_may_come_again_under_its_id_when_it_is_mended() -> None:
    shift = opened()
    assert shift.take(line("started", 0, task="bse", operator="cobot", id="a"))[0]["id"] == "a"
    assert shift.take(STARTED)[0]["accepted"]


def test_an_order_that_is_withdrawn_is_said_to_be() -> None:
    shift = opened(
        decider=in_time(Saying(Decision((("base", ("cobot",)),), {}, (), 0.0, "", "saying")))
    )
    assert shift.decision["starts"] == [{"task": "base", "operators": ["cobot"], "order": 0}]
    _, decision = shift.take(line("refused", 1, task="base", operator="cobot"))
    assert decision["revoked"] == [{"task": "base", "operators": ["cobot"], "order": 0}]
    assert decision["instead"] == "failed"
    assert "not allowed now" in decision["fault"]


def test_the_end_is_told_and_a_mistake_opens_it_again() -> None:
    shift = opened()
    lines = [
        STARTED,
        DONE,
        line("started", 5, task="shaft", operator="anna"),
        line("started", 5, task="gear", operator="cobot"),
    ]
    lines += [
        line("done", 9, task="gear"),
        line("done", 11, task="shaft"),
        line("started", 11, task="cover", operators=["anna", "cobot"]),
    ]
    for text in lines:
        shift.take(text)
    _, decision = shift.take(line("done", 13, task="cover"))
    assert (decision["over"], decision["by"]) == (True, "shift")
    _, decision = shift.take(line("wrong", 14, task="cover"))
    assert (decision["over"], decision["take_apart"]) == (False, ["cover"])


def test_times_of_the_day_begin_with_the_first_event_or_where_it_is_said() -> None:
    first = json.dumps(
        {"event": "started", "at": "2026-03-02T06:00:00Z", "task": "base", "operator": "cobot"}
    )
    then = json.dumps({"event": "done", "at": "2026-03-02T07:00:04.5+01:00", "task": "base"})
    shift = opened()
    shift.take(first)
    shift.take(then)
    assert shift.situation.done["base"].end == 4.5
    assert shift.start == datetime(2026, 3, 2, 6, tzinfo=UTC)
    stated = opened(start=datetime(2026, 3, 2, 5, 59, tzinfo=UTC))
    stated.take(first)
    assert stated.situation.running["base"].start == 60
    counting = opened()
    counting.take(STARTED)
    assert "counts seconds and has no start" in counting.take(then)[0]["reasons"][0]


def test_a_late_decider_is_not_waited_for() -> None:
    class Slow:
        name = "slow"

        def decide(self, situation: Situation) -> Decision:
            sleep(0.3)
            return Plain().decide(situation)

    decider = in_time(Slow(), budget_ms=40)
    shift = opened(decider=decider)
    assert shift.decision["instead"] == "late"
    assert shift.decision["latency_ms"] < 200
    _, decision = shift.take(STARTED)
    assert decision["instead"] == "late", "it is still at the first question"
    sleep(0.7)
    decider.budget_ms = 1000
    assert shift.take(DONE)[1]["instead"] == ""
    assert replay(GEARBOX, shift.journal, decider=decider).differences == ()


def test_a_decider_that_fails_or_says_nonsense_does_not_stop_the_floor() -> None:
    for wrong in (
        ValueError("no idea"),
        Decision((("cover", ("cobot", "anna")),), {}, (), 0.0, "", "x"),
        Decision((), {"anna": "z"}, (), 0.0, "", "x"),
    ):
        shift = opened(decider=in_time(Saying(wrong)))
        assert (shift.decision["instead"], shift.decision["by"]) == ("failed", "plain")
        assert shift.decision["fault"]


def test_both_deciders_failing_leaves_a_plain_answer() -> None:
    decider = in_time(Saying(ValueError("no idea")))
    decider.rule = Saying(ValueError("none either"))
    assert opened(decider=decider).decision["announced"] == {"anna": "base"}


def test_the_same_journal_goes_on_where_it_ended(tmp_path: Path) -> None:
    with Journal(tmp_path / "shift.db") as journal:
        first = opened(journal)
        first.take(STARTED)
        first.take("garbage")
    with Journal(tmp_path / "shift.db") as journal:
        again = opened(journal)
        assert again.is_resumed
        assert (again.situation, again.number, again.decision, again.hello()["running"]) == (
            first.situation,
            2,
            first.decision,
            {"base": ["cobot"]},
        )
        assert again.take(STARTED)[0]["duplicate_of"] == 1
        assert again.take(DONE)[0]["number"] == 4


def test_a_journal_of_another_cell_is_refused(tmp_path: Path) -> None:
    with Journal(tmp_path / "shift.db") as journal:
        opened(journal)
    with (
        Journal(tmp_path / "shift.db") as journal,
        pytest.raises(JournalError, match="is of the cell 'Small gearbox'"),
    ):
        Shift.open(GEARBOX.replace(name="Other"), journal, Settings(), decider=in_time())


def test_a_journal_that_was_changed_is_refused_and_its_replay_says_where(tmp_path: Path) -> None:
    path = tmp_path / "shift.db"
    with Journal(path) as journal:
        shift = opened(journal)
        shift.take(STARTED)
        shift.take(DONE)
    with Journal(path) as journal:
        journal.connection.execute(
            "UPDATE entries SET event = replace(event, '4.5', '4.75') WHERE number = 2"
        )
        with pytest.raises(JournalError, match="entry 2 does not lead where the journal says"):
            opened(journal)
    with Journal(path) as journal:
        journal.connection.execute(
            "UPDATE entries SET line = replace(line, '4.5', '4.75') WHERE number = 2"
        )
        found = replay(GEARBOX, journal, decider=in_time())
    assert found.differences[-1] == "entry 2: the situation afterwards is another one."


def test_a_replay_with_another_decider_tells_each_difference() -> None:
    shift = opened()
    shift.take(STARTED)
    assert replay(GEARBOX, shift.journal, decider=in_time()).differences == ()
    other = replay(
        GEARBOX, shift.journal, decider=in_time(Saying(Decision((), {}, (), 0.0, "no", "other")))
    )
    assert (
        'entry 0: the decision\'s \'announced\' was {"anna": "base"}, and is now {}.'
        in other.differences
    )


LATIN_1 = '{"event": "tick", "at": 1, "id": "MÄ-1"}'.encode("latin-1")


@pytest.mark.parametrize(
    "raw",
    [
        LATIN_1,
        "\ud800".encode(errors="surrogatepass"),
        b"\xff\xfe{\x00",
        b"\x00",
        b"\xff" * 300_000,
        "ä".encode() * 128_001,
    ],
    ids=len,
)
def test_a_line_that_is_not_utf_8_is_kept_as_it_came_and_replayed(
    raw: bytes, tmp_path: Path
) -> None:
    with Journal(tmp_path / "shift.db") as journal:
        shift = opened(journal)
        [answer] = shift.take(raw)
        assert (answer["accepted"], answer["number"]) == (False, 1)
        shift.take(STARTED)
        assert replay(GEARBOX, journal, decider=in_time()).differences == ()
        kept = [entry.line for entry in journal.entries()][1]
        assert kept in (raw, raw.decode(errors="replace")) or len(kept) > LONGEST_LINE
    with Journal(tmp_path / "shift.db") as journal:
        assert opened(journal).number == 2


def test_ids_that_differ_in_a_byte_alone_are_not_merged() -> None:
    """A gateway that writes Windows-1252: both were taken for one, and the second event was
    dropped.
    """
    shift = opened()
    answers = [
        shift.take(text.encode("cp1252"))[0]
        for text in ('{"event":"tick","at":1,"id":"MÜ-1"}', '{"event":"tick","at":1,"id":"MÖ-1"}')
    ]
    assert [answer["accepted"] for answer in answers] == [False, False]
    assert all(
        "this line is not UTF-8: byte 31 is 0xd" in answer["reasons"][0] for answer in answers
    )
    again = [
        shift.take(text)[0]
        for text in ('{"event":"tick","at":1,"id":"MÜ-1"}', '{"event":"tick","at":1,"id":"MÖ-1"}')
    ]
    assert [(answer["accepted"], "duplicate_of" in answer) for answer in again] == [
        (True, False)
    ] * 2


def test_half_a_character_in_a_text_is_refused_and_kept() -> None:
    shift = opened()
    [answer] = shift.take('{"event": "tick", "at": 1, "id": "\ud800"}')
    assert "not UTF-8" in answer["reasons"][0]
    assert replay(GEARBOX, shift.journal, decider=in_time()).differences == ()
