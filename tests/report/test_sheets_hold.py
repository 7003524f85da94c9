"""What stands on paper is enough: whoever knows nothing but the sheets cannot work against the
cell, however late or early the others are, and nobody waits for ever.

`python3 dev.py fuzz sheets --cells 1000 --seed 1` does the same with a thousand cells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from random import Random
from typing import Any

import pytest
from tests.draw.cells import front_of
from tests.fuzz import sheets as fuzz
from tests.report.paper import Row, sheets_of, work_by

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.report import instructions
from tandem.report.html import html
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.queues import queues

SEEDS = range(1, 61)


def test_crews_that_work_by_their_sheets_keep_to_the_cell_whatever_the_delays() -> None:
    total = fuzz.run(len(SEEDS), SEEDS[0])
    assert total.findings == []
    assert (total.cells, total.shifts) == (60, 180)
    assert min(total.features[key] for key in fuzz.FEATURES) >= 3
    assert set(total.conditions) >= {
        *("previous", "own", "both", "done", "freed", "partner", "break", "release"),
        *("start", "tool.room", "zone.room"),
    }


def without(kind: str) -> Callable[..., Any]:
    """The steps of a sheet that forgets to say this."""
    true = instructions.steps

    def forgetful(*given: Any) -> tuple[instructions.Step, ...]:
        found = []
        for step in true(*given):
            kept = tuple(one for one in step.begin if one.kind != kind)
            start = instructions.Condition("start", given[-1]("steps.wait.start"), 0.0)
            found.append(replace(step, begin=kept or (start,)))
        return tuple(found)

    return forgetful


@pytest.mark.parametrize("kind", ["done", "freed", "tool.room", "zone.room", "release"])
def test_a_sheet_that_leaves_one_kind_of_condition_out_is_found_out(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tandem.report.instruction_sheet.steps", without(kind))
    assert any(fuzz.judge(seed).findings for seed in range(1, 161))


def test_on_planned_times_nobody_begins_later_than_planned() -> None:
    """The sheets ask for nothing that the plan does not need."""
    for seed in SEEDS:
        random = Random(seed)
        while (found := fuzz.planned(random)) is None:
            pass
        cell, schedule = found
        lengths = {a.task: fuzz.exact(a.end) - fuzz.exact(a.start) for a in schedule}

        def seconds(who: str, row: Row, lengths: dict[str, Decimal] = lengths) -> Decimal:
            return lengths[row.task] if row.change is None else row.change[1]

        worked = work_by(fuzz.all_sheets(cell, schedule, "en"), seconds)
        begun = {w.task: w.start for w in worked if w.task}
        assert begun.keys() == lengths.keys()
        assert [a.task for a in schedule if begun[a.task] > fuzz.exact(a.start)] == []


def crowd(random: Random) -> tuple[Cell, Schedule]:
    """A zone for two or three, and a crew of four who are in and out of it in any order."""
    places = random.choice((2, 3))
    people = "abcd"
    tasks: dict[str, Any] = {}
    rows: list[Assignment] = []
    free = dict.fromkeys(people, 0)
    inside: list[tuple[int, int]] = []  # (end, operators)
    for number in range(12):
        who = tuple(sorted(random.sample(people, random.choice((1, 1, 1, 2)))))
        start = max(free[one] for one in who)
        while sum(n for end, n in inside if end > start) + len(who) > places:
            start = min(end for end, _ in inside if end > start)
        start = max(start, max((int(a.start) for a in rows), default=0))
        end = start + random.randint(1, 9)
        name = f"t{number}"
        tasks[name] = {"zone": "jig"}
        if len(who) == 1:
            tasks[name]["time"] = {who[0]: end - start}
        else:
            tasks[name]["together"] = [{"operators": list(who), "time": end - start}]
        rows.append(Assignment(float(start), float(end), name, who))
        inside.append((end, len(who)))
        free |= dict.fromkeys(who, end)
    cell = cell_of({
        "operators": {one: {"kind": "human"} for one in people},
        "zones": {"jig": {"capacity": places}},
        "tasks": tasks,
    })  # fmt: skip
    return cell, Schedule(tuple(rows))


def test_a_zone_for_several_is_never_crowded_and_need_not_empty_in_the_planned_order() -> None:
    """With so many in it the planned order of leaving is seldom the real one."""
    asked = rooms = 0
    for seed in range(60):
        random = Random(seed)
        cell, schedule = crowd(random)
        sheets = sheets_of(html(front_of(cell, [schedule])), "en")
        rooms += sum(len(row.rooms()) for sheet in sheets.values() for row in sheet.rows)
        assert fuzz.wrong(cell, schedule, sheets, random) == []
        found = queues(cell, schedule)
        ends = {a.task: a.end for a in schedule}
        for a in schedule:
            for queue in found[a.task]:
                late = [task for _, task in queue.before if ends[task] > a.start]
                assert len(late) <= queue.spare < len(queue.before)
                asked += len(a.operators) if queue.spare else 0
    assert rooms == asked > 100


def test_a_sheet_that_does_not_say_when_a_machine_is_free_is_found_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Ben puts his part into the press: his sheet names the task of Anna that empties it."""
    rows = {
        "in 1": (("anna",), 0, 4), "run 1": (("press",), 4, 14), "out 1": (("anna",), 14, 17),
        "in 2": (("ben",), 17, 21), "run 2": (("press",), 21, 31), "out 2": (("ben",), 31, 34),
    }  # fmt: skip
    tasks: dict[str, Any] = {
        name: {"time": {who[0]: end - start}} for name, (who, start, end) in rows.items()
    }
    for part in "12":
        tasks[f"run {part}"]["after"] = [f"in {part}"]
        tasks[f"out {part}"]["after"] = [f"run {part}"]
    press = {"kind": "machine", "holds": [["in 1", "out 1"], ["in 2", "out 2"]]}
    people = {who: {"kind": "human"} for who in ("anna", "ben")}
    cell = cell_of({"operators": {**people, "press": press}, "tasks": tasks})
    plan = Schedule(
        tuple(Assignment(start, end, name, who) for name, (who, start, end) in rows.items())
    )
    sheets = fuzz.all_sheets(cell, plan, "en")
    assert sheets["ben"].rows[0].bold == [("freed", "anna done with out 1 (press free)")]
    assert sheets["anna"].rows[1].cells["then"] == ["ben with in 2 (machine press)"]
    assert fuzz.wrong(cell, plan, sheets, Random(1)) == []
    monkeypatch.setattr(instructions, "parts_handed_over", lambda *_: ())
    found = fuzz.wrong(cell, plan, fuzz.all_sheets(cell, plan, "en"), Random(1))
    assert any("holds the part" in said for said in found)
