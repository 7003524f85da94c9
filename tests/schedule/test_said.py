"""What the checker says, in another language: the same facts, and English wherever nothing else is
asked for.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

import tandem
from tandem.cell.language import sentences
from tandem.errors import UsageError
from tandem.files.validate import cell_of
from tandem.schedule import checker
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.said import Said, in_language

ROOM = Path(checker.__file__).parent
EXAMPLES = Path(__file__).parents[2] / "examples"
ENGLISH, GERMAN = (
    json.loads((ROOM / f"words_{language}.json").read_text()) for language in ("en", "de")
)
CELL = {
    "operators": {
        "robot": {"kind": "robot", "setup": 2},
        "human": {"kind": "human", "breaks": [[10, 12.5]]},
    },
    "tasks": {
        "drill": {"time": {"robot": 4}, "release": 3},
        "hold": {"time": {"human": 6}, "deadline": 8},
        "press": {"time": {"human": 3, "robot": 5}, "after": ["drill"]},
        "pack": {"time": {"human": 1}},
    },
}
ROWS = [
    Assignment(1.0, 5.0, "drill", ("robot",)),
    Assignment(8.0, 14.0, "hold", ("human",)),
    Assignment(2.5, 9.0, "press", ("robot",)),
    Assignment(-1.0, 1.0, "hold", ("rbot", "rbot")),
    Assignment(0.0, 1.0, "drill", ("human",)),
    Assignment(0.0, 1.0, "weld", ("human",)),
]


def told(language: str) -> list[str]:
    faults = checker.faults(cell_of(CELL), Schedule(tuple(ROWS)))
    return [in_language(fault, language) for fault in faults]


@pytest.mark.parametrize("room", ["schedule", "plan"])
def test_both_languages_have_the_same_sentences_with_the_same_places(room: str) -> None:
    english, german = (sentences(f"tandem.{room}", language) for language in ("en", "de"))
    assert list(english) == list(german)
    for key, sentence in english.items():
        places = [sorted(re.findall(r"{(\w+)", one)) for one in (sentence, german[key])]
        assert set(places[0]) == set(places[1]), key


def test_every_sentence_is_used_and_every_one_that_is_used_is_there() -> None:
    source = (ROOM / "checker.py").read_text()
    named = set(re.findall(r'"([a-z]+(?:[._][a-z]+)*)"', source)) | {"and", "or", "nobody"}
    made = {f"kind.{kind}" for kind in ("human", "robot", "machine")} | {
        f"wait.{when}.{between}"
        for when in ("before", "past")
        for between in ("end-start", "start-start")
    }
    assert set(ENGLISH) <= named | made
    assert set(re.findall(r'said\(\s*"([a-z_.]+)"', source)) | made <= set(ENGLISH)


def disturbed() -> Iterator[tuple[str, str]]:
    """What the checker says, in both languages, of plans of the examples in which each task in turn
    begins at another time: a little sooner, much later, or when another one does.
    """
    for name, limit in (("control-box", 9), ("pump", 9), ("press", 9), ("crew", 9), ("window", 9)):
        cell = tandem.load(EXAMPLES / f"{name}.yaml")
        if name == "crew":
            cell = cell.replace(same_operator=[["cables", "signature"]])
        if name == "press":
            cell = cell.replace(zones={"press bed": {"apart": ["human", "robot"]}})
        people = {
            who: operator.model_copy(update={"stress_limit": 1.0, "limits": {"peak:stress": 0.5}})
            for who, operator in cell.operators.items()
            if operator.kind == "human"
        }
        cell = cell.replace(operators={**cell.operators, **people})
        rows = list(
            tandem.plan(tandem.load(EXAMPLES / f"{name}.yaml"), method="longest-tail")[0].schedule
        )
        for place, a in enumerate(rows):
            for start in (a.start - 2, a.start + 31, *(one.start for one in rows)):
                moved = replace(a, start=max(start, 0.0), end=max(start, 0.0) + a.end - a.start)
                for who in (a.operators, ("cobot",)):
                    other = replace(moved, operators=who)
                    schedule = Schedule((*rows[:place], other, *rows[place + 1 :]))
                    for fault in checker.faults(cell, schedule, max_makespan=limit, max_stress=1.0):
                        yield fault, in_language(fault, "de")


def test_waits_tools_zones_walks_and_limits_are_said_in_german_too() -> None:
    heads = {sentence.split()[0] for sentence in GERMAN.values()}
    found = dict(disturbed())
    keys = {getattr(english, "key", english) for english in found}
    wanted = {
        "wait.least", "wait.most", "ready.late", "limits.person",
        "tool.one", "zone.one", "apart", "hold.busy",
        "stress.person", "pair", "limit.makespan", "limit.stress",
    }  # fmt: skip
    assert wanted <= keys
    for english, german in found.items():
        assert isinstance(english, Said)
        assert german.split()[0] in heads
        numbers = [re.findall(r"\d+", one.replace(",", ".")) for one in (english, german)]
        assert set(numbers[0]) == set(numbers[1]), (english, german)


@pytest.mark.parametrize(
    ("english", "german"),
    [
        (
            "task 'drill': human cannot do it; robot can.",
            "Vorgang 'drill': human kann ihn nicht ausführen; möglich: robot.",
        ),
        (
            "task 'drill': starts at 1 s, before its release: 3 s is the earliest.",
            "Vorgang 'drill': beginnt bei 1 s, vor seiner Freigabe: frühestens bei 3 s.",
        ),
        (
            "task 'hold': ends at 14 s, after its deadline: 8 s is the latest.",
            "Vorgang 'hold': endet bei 14 s, nach seiner Frist: spätestens bei 8 s.",
        ),
        (
            "operator 'human': task 'hold' (8 to 14 s) runs into the break from 10 s to 12.5 s.",
            "Bediener 'human': Vorgang 'hold' (8 bis 14 s) fällt in die Pause von 10 s bis 12,5 s.",
        ),
        (
            "task 'press': robot cannot do it in 6.5 s (2.5 to 9 s); it takes 5 s, so it would end"
            " at 7.5 s.",
            "Vorgang 'press': Durch robot dauert er nicht 6,5 s (2,5 bis 9 s), sondern 5 s; er"
            " endete also bei 7,5 s.",
        ),
        (
            "task 'weld': the cell has no such task. It has drill, hold, press, pack.",
            "Vorgang 'weld': Die Zelle hat keinen solchen Vorgang. Sie hat drill, hold, press,"
            " pack.",
        ),
        (
            "task 'pack': is missing; every task must be done once.",
            "Vorgang 'pack': fehlt; jeder Vorgang muss einmal ausgeführt werden.",
        ),
    ],
)
def test_a_fault_says_the_same_in_german(english: str, german: str) -> None:
    place = told("en").index(english)
    assert told("de")[place] == german


def test_all_that_stands_here_is_said_in_german_and_stays_english_by_itself() -> None:
    assert told("en") == checker.faults(cell_of(CELL), Schedule(tuple(ROWS)))
    assert not {one.split()[0] for one in told("de")} & {"task", "operator"}


def test_what_is_only_said_in_english_stays_and_no_language_is_guessed() -> None:
    assert in_language("the file has changed.", "de") == "the file has changed."
    fault = tandem.faults(cell_of(CELL), Schedule(()))[0]
    with pytest.raises(UsageError, match="language 'xx'"):
        in_language(fault, "xx")
