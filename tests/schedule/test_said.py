"""What the checker says, in another language: the same facts, and English wherever nothing else is
asked for.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import tandem
from tandem.errors import UsageError
from tandem.files.validate import cell_of
from tandem.schedule import checker
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.said import in_language

ROOM = Path(checker.__file__).parent
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


def test_both_languages_have_the_same_sentences_with_the_same_places() -> None:
    assert list(ENGLISH) == list(GERMAN)
    for key, sentence in ENGLISH.items():
        places = [sorted(re.findall(r"{(\w+)", one)) for one in (sentence, GERMAN[key])]
        assert set(places[0]) == set(places[1]), key


def test_every_sentence_is_used_and_every_one_that_is_used_is_there() -> None:
    used = set(re.findall(r'said\(\s*"([a-z_.]+)"', (ROOM / "checker.py").read_text()))
    used |= {"group.cannot", "group.none", "and", "or", "nobody"}
    assert used == set(ENGLISH)


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
    assert in_language("stress: is 9, over its limit of 3.", "de").startswith("stress")
    fault = tandem.faults(cell_of(CELL), Schedule(()))[0]
    with pytest.raises(UsageError, match="language 'xx'"):
        in_language(fault, "xx")
