"""Files that are too large, too deep or too long-winded end in one message, not in minutes:
everything is counted before it is built.
"""

from __future__ import annotations

import gc
import json

import pytest

import tandem
from tandem.cell import parts, times
from tandem.errors import CellError
from tandem.files import positions
from tandem.files.load import loads
from tandem.files.validate import cell_of
from tandem.plan import methods

HEAD = "operators: {h: {kind: human}, r: {kind: robot}}\ntasks:\n"


def many(count: int, task: str) -> str:
    return HEAD + "".join(
        f"  t{n}: {task.format(n=n, before=max(n - 1, 0))}\n" for n in range(count)
    )


TOO_LARGE = {
    "tasks": many(100_000, "{{time: {{h: 1, r: 2}}, after: [t{before}]}}"),
    "predecessors": (
        HEAD + "  a: {time: {h: 1}}\n  b: {time: {h: 1}, after: [" + "a, " * 600_000 + "]}\n"
    ),
    "keys twice": HEAD + "  t: {time: {h: 1}}\n" * 150_000,
}


@pytest.mark.parametrize("kind", TOO_LARGE)
def test_a_file_that_goes_on_and_on_is_refused_where_the_count_is_reached(kind):
    with pytest.raises(
        CellError, match=rf"big.yaml:\d+:\d+: more than {positions.MOST_VALUES:,} keys and values"
    ) as refused:
        loads(TOO_LARGE[kind], source="big.yaml")
    assert len(refused.value.faults) == 1


def test_json_is_counted_too():
    text = json.dumps(
        {
            "operators": {"h": {"kind": "human"}},
            "tasks": {f"t{n}": {"time": {"h": 1}, "after": []} for n in range(150_000)},
        }
    )
    with pytest.raises(CellError, match="more than 500,000 keys and values"):
        loads(text)


@pytest.mark.parametrize(
    "text",
    ["a: " + "[" * 100_000, "{a: " * 100_000, "[" * 100_000, '{"a":' * 100_000, "- " * 100_000],
)
def test_what_nests_without_end_is_refused(text):
    with pytest.raises(CellError, match=r"nests deeper than 30|not well-formed"):
        loads(text)


def test_an_alias_bomb_is_refused_at_its_anchors():
    bomb = "a: &a [x, x]\n" + "".join(
        f"{new}: &{new} [*{old}, *{old}, *{old}]\n"
        for old, new in zip("abcdefgh", "bcdefghi", strict=True)
    )
    with pytest.raises(CellError, match="is an anchor"):
        loads(bomb)


@pytest.mark.parametrize(
    "number", ["1e999", "-1e999", "9" * 8000, "1" + "0" * 400, "0." + "3" * 8000, "1e-999"]
)
@pytest.mark.parametrize("key", ["time", "stress", "release", "capacity"])
@pytest.mark.parametrize("form", ["yaml", "json"])
def test_numbers_beyond_all_measure_are_refused_at_their_place(number, key, form):
    task = {"time": f'{{"h": {number}}}', "capacity": '{"h": 1}'}.get(
        key, f'{{"h": 1}}, "{key}": {number}'
    )
    zones = f', "zones": {{"z": {{"capacity": {number}}}}}' if key == "capacity" else ""
    text = (
        '{"operators": {"h": {"kind": "human"}},\n'
        f'"tasks": {{"a": {{"time": {task}}}}}{zones}}}'
    )
    if number == "1e-999" and key in ("stress", "release"):
        assert loads(text, form).tasks["a"].release == 0
        return
    with pytest.raises(CellError, match=r"x:2:\d+: "):
        loads(text, form, source="x")


def test_a_label_of_millions_of_signs_is_cut_short_in_the_message():
    with pytest.raises(CellError, match="label has 3000000 characters") as refused:
        loads(HEAD + '  a: {time: {h: 1}, label: "' + "x" * 3_000_000 + '"}')
    assert len(str(refused.value)) < 500


def test_of_very_many_faults_the_first_are_told_and_the_rest_counted():
    with pytest.raises(CellError) as refused:
        loads(many(10_000, "{{time: {{h: -1}}, foo: 3}}"))
    assert len(refused.value.faults) == 51
    assert refused.value.faults[-1].message == "and 19950 more. Mend these first."


def test_very_many_unknown_names_are_told_without_comparing_each_with_all():
    with pytest.raises(CellError, match="'t0' comes after 'x0', which is no task"):
        loads(many(30_000, "{{time: {{h: 1}}, after: [x{n}]}}"))


def test_more_breaks_than_a_year_of_shifts_has_are_refused():
    breaks = ", ".join(f"[{10 * n}, {10 * n + 1}]" for n in range(parts.MOST_BREAKS + 1))
    with pytest.raises(
        CellError, match="operator 'h': breaks holds 2001, at most 2,000 can be planned"
    ):
        loads(
            f"operators: {{h: {{kind: human, breaks: [{breaks}]}}}}\n"
            "tasks: {a: {time: {h: 1}}}"
        )


@pytest.mark.parametrize(
    ("start", "length", "operators", "end"),
    [
        (0, 2, "a", 2),
        (0, 3, "a", 15),
        (1, 2, "a", 7),
        (5, 1, "a", 6),
        (0, 4, "ab", 24),
        (12, 2, "b", 22),
        (30, 5, "ab", 35),
    ],
)
def test_the_soonest_end_lies_outside_the_breaks_of_all(start, length, operators, end):
    """a is off from 2 to 5 and from 7 to 12, b from 13 to 20."""
    cell = cell_of(
        {
            "operators": {
                "a": {"kind": "human", "breaks": [[2, 5], [7, 12]]},
                "b": {"kind": "human", "breaks": [[13, 20]]},
            },
            "tasks": {"t": {"time": {"a": 1}}},
        }
    )
    rests = times._Rests(cell)
    assert (
        rests.soonest_end(start * times.MICRO, length * times.MICRO, tuple(operators))
        == end * times.MICRO
    )


def test_loading_leaves_the_collector_as_it_was():
    for state in (True, False):
        (gc.enable if state else gc.disable)()
        try:
            with pytest.raises(CellError):
                loads("a: [")
            loads(HEAD + "  a: {time: {h: 1}}")
            assert gc.isenabled() is state
        finally:
            gc.enable()


def test_a_cell_of_more_tasks_than_can_be_planned_is_refused_before_planning(monkeypatch):
    monkeypatch.setattr(methods, "MOST_TASKS", 3)
    cell = loads(many(4, "{{time: {{h: 1}}}}"))
    with pytest.raises(
        CellError, match=r"the cell has 4 tasks, and at most 3 can be planned\. Split it"
    ):
        tandem.plan(cell)
