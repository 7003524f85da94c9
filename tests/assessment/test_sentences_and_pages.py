"""What is said of a score, in both languages, and the pages that can be signed."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import openpyxl
import pytest

from tandem.assessment import pages
from tandem.assessment import sentences as say
from tandem.cell.language import LANGUAGES, sentences
from tandem.cell.stated import Conditions
from tandem.ergonomics import METHODS, score
from tandem.ergonomics.tasks import scored, totals
from tandem.errors import UsageError
from tandem.files.facts.load import load_facts
from tandem.files.facts.template import write

ROOMS = ("tandem.ergonomics", "tandem.assessment")


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> pages.Assessment:
    """The 20 tasks of the template, with the German headings."""
    path = tmp_path_factory.mktemp("facts") / "Angaben.xlsx"
    write(path, "de")
    rows = [scored(task) for task in load_facts(path, Conditions(cycles=420)).tasks]
    made = {"version": "0", "command": "tandem score Angaben.xlsx"}
    return pages.Assessment("Angaben", rows, totals(rows), made)


@pytest.mark.parametrize("room", ROOMS)
def test_both_languages_say_the_same_things(room):
    english, german = (sentences(room, language) for language in LANGUAGES)
    assert set(english) == set(german)
    for key, text in english.items():
        assert set(re.findall(r"{\w*}", text)) == set(re.findall(r"{\w*}", german[key])), key


def test_a_score_is_explained_in_one_sentence():
    facts = {
        "neck_flexion_deg": 5.0, "trunk_flexion_deg": 45.0, "upper_arm_flexion_deg": 70.0,
        "lower_arm_flexion_deg": 80.0, "wrist_flexion_deg": 5.0, "load_kg": 6.0,
        "coupling": "fair", "trunk_twist_or_side": True, "knee_flexion_deg": 40.0,
    }  # fmt: skip
    outcome = score("reba", facts)
    assert say.explanation(say.words("en"), outcome) == (
        "REBA 7: trunk 4 because flexed 45 degrees and twisted or bent to a side; upper arm 3"
        " because flexed 70 degrees; legs 2 because knees bent 40 degrees; load +1 because 6 kg;"
        " medium risk, change it."
    )
    lines = [say.step(say.words("en"), step) for step in outcome.steps]
    assert "trunk 4: flexed 45 degrees (20 to 60: 3), twisted or bent to a side (+1)" in lines
    german = say.explanation(say.words("de"), outcome)
    assert german.startswith("REBA 7: Rumpf 4 (um 45 Grad gebeugt und verdreht")


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_sentence_of_every_method_can_be_said(found, language):
    t = say.words(language)
    assert {row.given.method for row in found.rows} >= {"rula", "reba", "niosh", "rsi", "duet"}
    for row in found.rows:
        for said in (
            say.explanation(t, row.outcome),
            say.stability(t, row),
            say.provenance(t, row),
        ):
            assert said
            assert "{" not in said
        assert all(say.step(t, step) for step in row.outcome.steps)
    for name in METHODS:
        assert t(f"method.{name}")
        assert t(f"limits.{name}")
        assert t(f"level.{name}.0")


def test_the_page_has_facts_provenance_steps_level_stability_limits_and_a_place_to_sign(found):
    text = pages.html(say.words("de"), found)
    for part in (
        "Ergonomische Bewertung: Angaben", "Gehäuse von Palette nehmen", "aus Video", "M. Muster",
        "um 65 Grad gebeugt (über 60: 4)", "hohes Risiko, bald handeln", "Nicht stabil:",
        "nicht angegeben: angenommen", "Was die Methoden nicht sehen", "keine Sicherheitsfunktion",
        "Unterschrift", "CLI 1,844",
    ):  # fmt: skip
        assert part in text
    assert "http" not in text.partition("</style>")[2]
    assert "<script" not in text


def test_a_name_in_a_page_is_no_markup(found):
    evil = pages.Assessment("<b>x</b>", found.rows, found.totals, found.made)
    assert "<b>x</b>" not in pages.html(say.words("en"), evil)


def test_the_workbook_has_a_row_for_each_task_fact_and_step(found):
    book = openpyxl.load_workbook(io.BytesIO(pages.xlsx(say.words("de"), found)))
    assert book.sheetnames == ["Übersicht", "Schicht", "Angaben", "Schritte"]
    summary = list(book["Übersicht"].iter_rows(min_row=4, values_only=True))
    assert [row[0] for row in summary[:20]] == [row.given.task for row in found.rows]
    assert summary[0][3] == 10
    steps = sum(len(row.outcome.steps) for row in found.rows)
    assert book["Schritte"].max_row == 3 + steps


def test_the_document_carries_every_step_and_fact(found):
    data = json.loads(pages.json_text(say.words("en"), found))
    assert len(data["tasks"]) == 20
    first = data["tasks"][0]
    assert first["score"] == 10
    assert first["facts"]["trunk_flexion_deg"] == {
        "value": 65.0, "unit": "°", "source": "video", "assessor": "M. Muster",
        "date": "2025-11-03",
    }  # fmt: skip
    assert [step["step"] for step in first["steps"]][-1] == "reba"
    assert {total["kind"] for total in data["totals"]} == {"ordinal", "composite", "dose"}


def test_markdown_has_every_task(found):
    text = pages.markdown(say.words("en"), found)
    assert text.count("\n### ") == 20
    assert "Scores that only rank are not added." in text


def test_a_file_of_another_kind_is_refused_before_anything_is_read():
    with pytest.raises(UsageError, match="an assessment is written as"):
        pages.check(Path("page.docx"))
