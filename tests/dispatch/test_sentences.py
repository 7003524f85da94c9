"""Every sentence that a shift can say: whole, with units, and without a trace of Python."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dispatch.cells import GEARBOX, Saying, in_time, line
from tests.dispatch.happenings import happenings
from tests.dispatch.test_decisions_agree import DECIDERS, OBJECTIVES, decided
from tests.dispatch.test_events import WRONG
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.cli.screen import happened, orders
from tandem.dispatch.deciders.auto import Auto
from tandem.dispatch.deciders.policy import Basis, Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.journal import Journal
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.situation.events import EventError, read_event
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import estimates
from tandem.errors import CellError, InfeasibleError, UsageError
from tandem.files.validate import cell_of

ODD = {
    "a table of Python": r"\{['\"]?\w*['\"]?:? |\{\}",
    "a list of Python": r"\[['\"\d(]|\[\]|\(['\"]\w+['\"],",
    "a value of Python": r"\b(None|True|False|nan|inf|frozenset|dict_keys|object at 0x)\b",
    "two blanks": r"\S  +\S",
    "no blank behind a full stop": r"[a-z'\")][.;:,][A-Za-z]",
    "two full stops": r"(?<!\.)\.\.(?!\.)|\. +\.\)?$",
    "a cost without its unit": r"cost -?\d[\d.e+-]*(?![\d.e+-]| s\b| of stress| \()",
    "a moment without its unit": (
        r"\b(before|until|since|done at|released at|after|have come to|happened at)"
        r" (?!1970)\d[\d.e+-]*(?![\d.]| s\b| ms\b)"
    ),
    "a plural with is": r"^\S+ and \S+ is\b|, \S+ and \S+ is\b",
}


def odd(sentence: str) -> list[str]:
    """What is odd about a sentence."""
    return [name for name, pattern in ODD.items() if re.search(pattern, sentence)]


def sentences(document: dict[str, Any]) -> Iterator[str]:
    """Everything in a document of a shift that is for people."""
    yield from (document[key] for key in ("why", "fault") if key in document)
    for key in ("reasons", "remarks", "stuck"):
        yield from document.get(key, [])


def on_a_terminal(shift: Shift, decision: dict[str, Any]) -> Iterator[str]:
    """The lines of a decision in words, what each is about left out."""
    believed = estimates(shift.situation, shift.settings.options.prior)
    for row in orders(shift.situation, decision, believed):
        label, blank, words = row[2:10].strip(), row[10:11], row[11:]
        if label == "withdraw":
            label, blank, words = row[2:11], row[11:12], row[12:]
        assert label in ("now", "next", "withdrawn", "why"), row
        assert blank == " ", f"a blank lies between what a line is and what it says: {row!r}"
        yield from words.split(" · ")


def all_is_well(found: Iterable[str]) -> None:
    for sentence in found:
        assert odd(sentence) == [], sentence


@settings(max_examples=40)
@given(st.data(), cells(max_tasks=5), st.sampled_from(DECIDERS), st.sampled_from(OBJECTIVES))
def test_every_sentence_of_a_shift_is_whole(
    data: st.DataObject, cell: Cell, name: str, objective: Objective
) -> None:
    named = _named(cell)
    lines = data.draw(happenings(named))
    try:
        for shift, decision in decided(named, name, objective, lines):
            all_is_well(sentences(decision))
            all_is_well(on_a_terminal(shift, decision))
            all_is_well([] if shift.event is None else [happened(shift.event).split("s  ", 1)[1]])
    except (CellError, UsageError, InfeasibleError) as error:
        all_is_well(str(error).split("\n"))


@settings(max_examples=25)
@given(st.data(), cells(max_tasks=5))
def test_every_answer_to_a_line_is_whole(data: st.DataObject, cell: Cell) -> None:
    """What contradicts the shift, and what is odd, included."""
    with Journal() as journal:
        shift = Shift.open(cell, journal, Settings(), decider=in_time())
        for text in data.draw(happenings(cell)):
            at = data.draw(st.sampled_from((0, 0, 5)))
            shifted = json.dumps({**json.loads(text), "at": json.loads(text)["at"] + at})
            for document in shift.take(shifted):
                all_is_well(sentences(document))


def _named(cell: Cell) -> Cell:
    """The same cell, its tasks named in letters, so that a number in a sentence is none of them."""
    data = cell.to_dict()
    letter = {name: f"task {chr(ord('a') + place)}" for place, name in enumerate(cell.tasks)}
    data["tasks"] = {
        letter[name]: {
            **task,
            "after": [letter[first] for first in task.get("after", [])],
            "wait": [{**wait, "after": letter[wait["after"]]} for wait in task.get("wait", [])],
        }
        for name, task in data["tasks"].items()
    }
    data["same_operator"] = [
        [letter[one], letter[other]] for one, other in data.get("same_operator", [])
    ]
    for operator in data["operators"].values():
        if operator.get("holds"):
            operator["holds"] = [[letter[name] for name in pair] for pair in operator["holds"]]
    data.pop("stress_of_set", None)
    return cell_of({key: value for key, value in data.items() if key != "same_operator" or value})


@pytest.mark.parametrize("text", [text for text, _ in WRONG.values()], ids=WRONG)
def test_what_is_said_of_a_wrong_line_is_whole(text: str) -> None:
    """An example of an event is JSON, and stands for itself."""
    with pytest.raises(EventError) as caught:
        read_event(text, GEARBOX)
    for reason in caught.value.reasons:
        said = reason.replace('{"event": "done", "at": 12.5, "task": "4"}', "that")
        all_is_well([re.sub(r"is [\[{\"].*?; it must", "is that; it must", said)])


def test_values_are_shown_as_they_came() -> None:
    for value, shown in (
        ({"name": "base"}, '{"name": "base"}'),
        (["base"], '["base"]'),
        (True, "true"),
        (None, "missing"),
    ):
        with pytest.raises(
            EventError, match=re.escape(f"`task` is {shown}; it must be the name of a task")
        ):
            read_event(line("done", 1, task=value), GEARBOX)


@pytest.mark.parametrize(
    ("objective", "said"),
    [
        (Objective(), "23.25 s"),
        (Objective(2.0, 0.0), "23.25 (2 × s)"),
        (Objective(1.0, 0.5), "23.25 (1 × s + 0.5 × stress)"),
        (Objective(0.0, 1.0), "23.25 of stress"),
        (Objective(0.0, 3.0), "23.25 (3 × stress)"),
    ],
)
def test_a_cost_is_said_with_its_unit(objective: Objective, said: str) -> None:
    assert objective.words(23.25) == said
    assert objective.words(float("inf")) == "no end in sight"


def test_an_order_that_is_withdrawn_stands_apart_from_its_label() -> None:
    """Once: "withdrawnCobot not '4' after all"."""
    decision = {
        "take_apart": [],
        "starts": [],
        "announced": {},
        "why": "x",
        "revoked": [{"operators": ["Cobot"], "task": "4"}],
    }
    assert "  withdrawn Cobot not '4' after all" in orders(Situation.of(GEARBOX), decision, {})


def test_who_could_not_decide_is_named_with_one_full_stop() -> None:
    failing = Saying(UsageError("no policy fits this cell."), name="learned")
    decision = Auto((failing,), policy("longest-tail", GEARBOX)).decide(Situation.of(GEARBOX))
    assert decision.why.endswith(
        "(learned could not decide, UsageError: no policy fits this cell.)"
    )
    all_is_well([decision.why])


def test_what_may_be_set_is_said_as_it_is_written_on_the_command_line() -> None:
    with pytest.raises(UsageError, match=r"prior 0\.6:1,0:2: needs pace factors above 0"):
        Options(prior={0.6: 1.0, 0.0: 2.0})
    all_is_well([Basis(123.0, 4.0, False, 113.0, 0.0).doubt])
    assert replace(Basis(123.0, 4.0, False, 113.0, 0.0), proven=True).doubt == ""
