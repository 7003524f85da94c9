"""Lines from the floor: what is an event, and what is said of what is none."""

from __future__ import annotations

import json
from datetime import UTC, datetime

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dispatch.cells import GEARBOX, line

from tandem.dispatch.shift.documents import event_of
from tandem.dispatch.situation.events import (
    KINDS,
    LONGEST_LINE,
    Event,
    EventError,
    read_event,
    start_of,
)

WRONG = {
    "garbage": ("garbage", "this is not JSON"),
    "nothing": ("{}", "`event` is missing"),
    "no number": ('{"event": "tick", "at": NaN}', "NaN is no number"),
    "a list": ("[1]", "this is a list, not an event"),
    "twice": ('{"event": "tick", "at": 1, "at": 2}', "the key 'at' stands twice"),
    "deep": ("[" * 5000, "this is not JSON"),
    "long": ('{"event": "tick"' + " " * LONGEST_LINE, "more than 64000 characters"),
    "kind": (line("strated", 1, task="base"), "no event 'strated'. Did you mean 'started'?"),
    "kind of no text": (json.dumps({"event": 3, "at": 1}), "no event 3"),
    "task": (line("done", 1, task="bse"), "no task 'bse'. Did you mean 'base'?"),
    "no task": (line("done", 1), "`task` is missing"),
    "task of no text": (line("done", 1, task=["base"]), "must be the name of a task"),
    "operator": (
        line("started", 1, task="base", operator="Anna"),
        "no operator 'Anna'. Did you mean 'anna'?",
    ),
    "no operator": (line("started", 1, task="base"), "`operator` is missing"),
    "operator twice": (line("started", 1, task="cover", operators=["anna", "anna"]), "named twice"),
    "both": (
        line("started", 1, task="base", operator="anna", operators=["anna"]),
        "either `operator` or `operators`",
    ),
    "operators of no text": (line("started", 1, task="base", operator={}), "must name operators"),
    "two refuse": (
        line("refused", 1, task="cover", operators=["anna", "cobot"]),
        "has no key 'operators'",
    ),
    "extra": (
        line("done", 1, task="base", colour="red"),
        "has no key 'colour'. It has event, at, id, task, operator, operators",
    ),
    "no time": (json.dumps({"event": "tick"}), "`at` is missing"),
    "before": (line("tick", -1), "must lie between 0 and"),
    "unix": (line("tick", 1764000000), "Seconds since 1970 are not meant: write ISO 8601"),
    "a yes": (json.dumps({"event": "tick", "at": True}), "`at` is true"),
    "infinite": ('{"event": "tick", "at": 1e999}', "`at` is Infinity"),
    "no clock": (json.dumps({"event": "tick", "at": "noon"}), "'noon', which is no time"),
    "no zone": (json.dumps({"event": "tick", "at": "2026-03-02T06:00:00"}), "without a time zone"),
    "until": (
        line("refused", 9, task="shaft", operator="anna", until=9),
        "until 9 s is not after 9 s",
    ),
    "failed": (line("failed", 1), "say which `task` was given up, or which `operator` is down"),
    "id": (line("tick", 1, id=""), "`id` is ''"),
    "thousands of digits": (
        f'{{"event": "tick", "at": {"9" * 4000}}}',
        "it must be seconds since the start",
    ),
    "an id of digits": (
        f'{{"event": "tick", "at": 1, "id": {"9" * 4000}}}',
        "must be a text of 1 to 200",
    ),
    "a lost character": (
        '{"event": "tick", "at": 1, "id": "M\ufffd"}',
        "U+FFFD stands for a character that was lost",
    ),
    "a table as a task": (
        line("done", 1, task={"name": "base"}),
        '`task` is {"name": "base"}; it must be the name of a task',
    ),
    "half a character in a task": ('{"event": "done", "at": 1, "task": "\\ud800"}', "no task"),
    "half a character in a key": ('{"event": "tick", "at": 1, "\\udfff": 1}', "has no key"),
    "a zero in an id": ('{"event": "tick", "at": 1, "id": "a\\u0000"}', "`id` is"),
    "half a character as it is": (
        '{"event": "tick", "at": 1, "id": "\ud800"}',
        "this line is not UTF-8",
    ),
    "zero bytes": (
        '{"event": "tick", "at": 1}\0',
        "this line is not UTF-8: it holds zero bytes, as UTF-16 does",
    ),
    "half a character": ('{"event": "tick", "at": 1, "id": "\\ud800"}', "`id` is"),
}


@pytest.mark.parametrize(("text", "says"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_with_a_line_is_said(text: str, says: str) -> None:
    with pytest.raises(EventError) as caught:
        read_event(text, GEARBOX)
    assert says in str(caught.value)


def test_everything_wrong_is_said_at_once_and_the_id_is_kept() -> None:
    with pytest.raises(EventError) as caught:
        read_event(line("started", -1, task="bse", operator="Anna", colour=1, id="x-7"), GEARBOX)
    assert len(caught.value.reasons) == 4
    assert caught.value.id == "x-7"


KEYS = st.sampled_from(["event", "at", "task", "operator", "operators", "until", "id", "x"])
WORDS = st.sampled_from([*KINDS, *GEARBOX.tasks, *GEARBOX.operators])
VALUES = st.recursive(
    WORDS | st.none() | st.booleans() | st.floats() | st.text(max_size=9),
    lambda inner: st.lists(inner) | st.dictionaries(KEYS, inner),
)


@settings(max_examples=60)
@given(st.text(max_size=60) | st.dictionaries(KEYS, VALUES).map(json.dumps))
def test_every_line_means_an_event_or_is_told_why_not(text: str) -> None:
    reasons, event = [], None
    try:
        event = read_event(text, GEARBOX)
    except EventError as error:
        reasons = [reason for reason in error.reasons if reason.strip()]
    assert reasons or (event is not None and event_of(event.to_dict()) == event)


TICK = '{"event": "tick", "at": 1, "id": "Gerät-ß"}'


@pytest.mark.parametrize(
    "coding", ["latin-1", "cp1252", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp037"]
)
def test_bytes_that_are_not_utf_8_are_refused(coding: str) -> None:
    with pytest.raises(EventError, match=r"this line is not UTF-8|this is not JSON"):
        read_event(TICK.encode(coding), GEARBOX)


@pytest.mark.parametrize(
    "bytes_", [b"\xff", b"\xc3", b"\xed\xa0\x80", b"\xf5\x80\x80\x80", b"\xc0\xaf", b"\x80"]
)
def test_no_byte_is_put_in_the_place_of_another(bytes_: bytes) -> None:
    """A lone byte, half a sign, a surrogate, beyond the last sign, an overlong form, a
    continuation.
    """
    with pytest.raises(
        EventError, match=r"this line is not UTF-8: byte 36 is 0x.*Send events as UTF-8"
    ):
        read_event(b'{"event": "tick", "at": 1, "id": "M' + bytes_ + b'1"}', GEARBOX)


def test_bytes_are_read_as_text_is_and_a_mark_of_byte_order_is_none_of_it() -> None:
    assert (
        read_event(TICK.encode(), GEARBOX)
        == read_event(TICK, GEARBOX)
        == read_event(b"\xef\xbb\xbf" + TICK.encode(), GEARBOX)
    )
    assert read_event(TICK, GEARBOX).id == "Gerät-ß"


def test_a_line_of_many_bytes_may_be_no_longer_in_characters() -> None:
    padded = line("tick", 1, id="x")[:-1] + " " * (LONGEST_LINE - 40) + "}"
    assert read_event(padded.encode(), GEARBOX).id == "x"
    for long in (b"\xff" * (4 * LONGEST_LINE + 1), "ä".encode() * (LONGEST_LINE + 1)):
        with pytest.raises(EventError, match="more than 64000 characters"):
            read_event(long, GEARBOX)


@pytest.mark.parametrize(
    ("task", "who"),
    [
        ("Geha\u0308use", "Ju\u0308rgen"),
        (" Gehäuse", "Jürgen "),
        ("Gehäuse\t", "\u00a0Jürgen"),
        ("Gehäuse", "Ju\u0308rgen\n"),
    ],
)
def test_a_name_is_known_in_every_spelling(task: str, who: str) -> None:
    """As macOS writes an ä, in two signs; with blanks around it, of any kind."""
    cell = GEARBOX.replace(
        tasks={"Gehäuse": {"time": {"Jürgen": 1}}}, operators={"Jürgen": {"kind": "human"}}
    )
    assert read_event(line("started", 0, task=task, operator=who), cell) == Event(
        "started", 0.0, "Gehäuse", ("Jürgen",)
    )


def test_one_operator_in_two_spellings_is_named_twice() -> None:
    cell = GEARBOX.replace(
        tasks={"1": {"time": {"Jürgen": 1}}}, operators={"Jürgen": {"kind": "human"}}
    )
    with pytest.raises(EventError, match="named twice"):
        read_event(line("started", 0, task="1", operators=["Jürgen", "Ju\u0308rgen"]), cell)


def test_names_that_look_like_numbers_may_be_numbers() -> None:
    cell = GEARBOX.replace(tasks={"1": {"time": {"2": 1}}}, operators={"2": {"kind": "robot"}})
    assert read_event(
        '{"event": "started", "at": 0, "task": 1, "operator": 2, "id": 7}', cell
    ) == Event("started", 0.0, "1", ("2",), id="7")


def test_operators_are_taken_in_the_order_of_the_cell() -> None:
    assert read_event(
        line("started", 1, task="cover", operators=["anna", "cobot"]), GEARBOX
    ).operators == ("cobot", "anna")


def test_times_of_the_day_are_counted_from_the_start() -> None:
    start = datetime(2026, 3, 2, 6, tzinfo=UTC)
    text = json.dumps(
        {
            "event": "refused",
            "at": "2026-03-02T07:00:09.5+01:00",
            "task": "shaft",
            "operator": "anna",
            "until": "2026-03-02T06:01:00Z",
        }
    )
    assert read_event(text, GEARBOX, start) == Event("refused", 9.5, "shaft", ("anna",), until=60.0)
    assert start_of(text) == datetime(2026, 3, 2, 6, 0, 9, 500_000, tzinfo=UTC)
    with pytest.raises(EventError, match="before the start of the shift at 2026-03-02T06:00:00"):
        read_event(json.dumps({"event": "tick", "at": "2026-03-02T05:59:59Z"}), GEARBOX, start)


def test_every_kind_says_what_it_is_for() -> None:
    assert {
        "started",
        "done",
        "refused",
        "failed",
        "repaired",
        "wrong",
        "undone",
        "absent",
        "back",
        "product",
        "broken",
        "mended",
        "missing",
        "there",
        "person",
        "end",
        "tick",
    } == set(KINDS)
    assert all(kind.what for kind in KINDS.values())
