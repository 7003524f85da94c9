"""Headers in the planners' words are understood, and look-alikes are left alone."""

from __future__ import annotations

import pytest

from tandem.files.spreadsheet.form import HEADERS
from tandem.files.spreadsheet.vocabulary import Meaning, kind_of, meaning


@pytest.mark.parametrize(
    ("header", "understood"),
    [
        ("t human [s]", "time of human, s"),
        ("Zeit Mensch [min]", "time of Mensch, min"),
        ("time robot (s)", "time of robot, s"),
        ("Roboterzeit [s]", "time of Roboter, s"),
        ("Maschinenzeit (1/100 min)", "time of Maschine, 1/100 min"),
        ("Zeit\nWerker 1\n[TMU]", "time of Werker 1, TMU"),
        ("t_human_s", "time of human, s"),
        ("Dauer in Minuten", "time, min"),
        ("Bearbeitungszeit für den Roboter in s", "time of Roboter, s"),
        ("Anna [s]", "time of Anna, s"),
        ("Time human + robot [s]", "time of human + robot, s"),
        ("EAWS-Punkte", "stress"),
        ("Ergonomic score", "stress"),
        ("Belastung (Anna)", "stress of Anna"),
        ("stress anna with ben", "stress of anna in anna + ben"),
        ("Lfd. Nr.", "number"),
        ("Arbeitsgang", "task"),
        ("Bezeichnung", "label"),
        ("direkte Vorgänger", "after"),
        ("Predecessors (row)", "after rows"),
        ("Nachfolger", "before"),
        ("Spätestes Ende [min]", "deadline, min"),
        ("Ressourcennamen", "operator"),
        ("Wait after [s]", "wait, s"),
        ("Wartezeit nach [min]", "wait, min"),
        ('time "cycle time" [s]', "time of cycle time, s"),
    ],
)
def test_understood(header: str, understood: str) -> None:
    assert str(meaning(header)) == understood


@pytest.mark.parametrize(
    "header",
    [
        "Wartezeit [s]",
        "Cycle time [s]",
        "Zykluszeit Roboter [s]",
        "Summe [s]",
        "Total time human [s]",
        "Gesamtzeit",
        "Walk time [s]",
        "Kosten [EUR]",
        "Start",
        "Anna",
        "Farbe",
        "",
        "Zeitpunkt",
        "max. Zeit Mensch [s]",
        "Taktanteil",
    ],
)
def test_left_alone(header: str) -> None:
    assert meaning(header) is None


@pytest.mark.parametrize("lang", HEADERS)
@pytest.mark.parametrize("who", [("robot",), ("Mensch", "UR5e")])
def test_every_header_of_the_template_is_understood(lang: str, who: tuple[str, ...]) -> None:
    words = HEADERS[lang]  # type: ignore[index]
    for what in ("time", "stress of", "difficulty", "spread of", "changeover"):
        found = meaning(words[what].format(who=" + ".join(who)))
        assert found is not None
        assert (found.what, found.who) == (what.removesuffix(" of"), who)
    single = (
        "label",
        "part",
        "stress",
        "after",
        "tool",
        "zone",
        "spread",
        "release",
        "deadline",
        "same operator",
        "operator",
        "kind",
        "stress limit",
        "breaks",
    )
    assert [(meaning(words[what]) or Meaning("")).what for what in single] == list(single)
    assert (meaning(words["name"]) or Meaning("")).what == "task"


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("human", "human"),
        ("Werker 2", "human"),
        ("human_0", "human"),
        ("H1", "human"),
        ("Frau Meier", "human"),
        ("UR5e", "robot"),
        ("robot2", "robot"),
        ("Roboter links", "robot"),
        ("R1", "robot"),
        ("anna", None),
        ("Station 3", None),
        ("robot operator", None),
    ],
)
def test_kinds_are_guessed_only_when_the_name_says_so(name: str, kind: str | None) -> None:
    assert kind_of(name) == kind
