"""What is said of the tasks that a plan changes, in English and in German."""

from __future__ import annotations

from tests.schedule.test_plan_changes import OLD, plan

from tandem.report.language import words
from tandem.report.replanned import counted, told
from tandem.schedule.changes import changes


def test_what_is_said_has_the_numbers() -> None:
    other = plan(a=("cobot", 2), b=("anna", 8), c=("anna", 4), d=("cobot", 0))
    found, t = changes(OLD, other), words("en")
    assert counted(found, t) == (
        "1 task changes operator, 2 change order, 0 move by more than 5 s, the rest (1) stays."
    )
    said = [told(changed, t) for changed in found.changed]
    assert "task a: operator: anna -> cobot, start 0 s -> 2 s (+2 s)" in said
    assert "task c: order: anna, start 4 s as before" in said


def test_new_tasks_and_gone_ones_are_named() -> None:
    other = plan(e=("anna", 0), b=("anna", 2), c=("anna", 4), d=("cobot", 0))
    found = changes(OLD, other)
    assert counted(found, words("en")).endswith("the rest (3) stays, new: e, gone: a.")
    assert counted(found, words("de")).endswith("der Rest (3) bleibt, neu: e, entfallen: a.")


def test_a_german_reads_german() -> None:
    other = plan(a=("cobot", 2.5), b=("anna", 2), c=("anna", 4), d=("cobot", 0))
    found, t = changes(OLD, other), words("de")
    [said] = [told(changed, t) for changed in found.changed]
    assert said == "Vorgang a: Bediener: anna -> cobot, Beginn 0 s -> 2,5 s (+2,5 s)"
    assert counted(found, t).startswith("1 Vorgang mit anderen Bedienern, 0 in anderer Reihenfolge")
