"""What is wrong with limits of people is said at its place, with the remedy; all of it at once."""

from __future__ import annotations

import pytest
from tests import limited

from tandem.cell.measures import adds_up
from tandem.errors import CellError
from tandem.files.lot import lot
from tandem.files.validate import cell_of
from tandem.schedule.cycle import copied


def said(data: dict) -> str:
    with pytest.raises(CellError) as caught:
        cell_of(data)
    return str(caught.value)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("peak:rebba", "no task of the cell has a value on the scale 'rebba'.*State `ergonomics`"),
        ("pek:reba", "no measure 'pek:reba'. Did you mean 'peak'?"),
        ("stress", "'stress' has a key of its own. Write `stress_limit: MOST`"),
        ("sum", "'sum' has a key of its own. Write `stress_limit: MOST`"),
        ("sum:stress", "'sum:stress' has a key of its own. Write `stress_limit: MOST`"),
        ("sum:reba", "Write `stress_limit: MOST` instead. Of reba limit peak:reba"),
        ("worst:stress", "Write `stress_limit: MOST` instead.*leave out `worst:`"),
        ("worst:peak:reba", "leave out `worst:`"),
        ("time-weighted:reba", "falls by waiting alone. Take peak:reba"),
        ("fatigue:reba:0.1:0.2", "cannot be kept live.*--limit fatigue:reba:0.1:0.2=MOST"),
        ("dose:reba", "ranks are not added"),
        ("time-above:reba", "write it as time-above:SCALE:LEVEL"),
        ("time-above:reba:high", "'high' must be a number"),
    ],
)
def test_what_is_no_limit_is_refused_with_what_to_write_instead(name: str, words: str) -> None:
    data = limited.data()
    data["operators"]["anna"]["limits"] = {name: 3}
    with pytest.raises(CellError, match=f"operator 'anna'.*{words}"):
        cell_of(data)


def test_no_other_spelling_of_the_sum_is_asked_for_on_the_way() -> None:
    data = limited.data()
    data["operators"]["anna"]["limits"] = {"sum:stress": 3, "stress": 3}
    told = said(data)
    assert told.count("Write `stress_limit: MOST` instead.") == 2
    assert "write it as" not in told
    assert "one measure" not in told


def test_all_faults_are_told_at_once() -> None:
    data = limited.data(cycles=None)
    data["operators"]["anna"]["limits"] = {
        "dose:lifft": 1, "time-above:reba:8": 2, "time-above:reba:8.0": 3,
    }  # fmt: skip
    data["operators"]["cobot"]["limits"] = {"peak:reba": 7}
    told = said(data)
    assert "dose is that of a shift" in told
    assert "`cycles_per_shift: 400`" in told
    assert "'time-above:reba:8' and 'time-above:reba:8.0', which are one measure" in told
    assert "operator 'cobot' is a robot and has `limits`. Only humans have a body" in told


@pytest.mark.parametrize("most", [-1, "much", None])
def test_a_limit_is_a_number_0_or_more(most: object) -> None:
    data = limited.data()
    data["operators"]["anna"]["limits"] = {"peak:reba": most}
    assert "peak:reba" in said(data)


def test_stress_by_sets_has_no_limit_of_single_tasks() -> None:
    data = limited.data(peak_stress=3)
    data["stress_of_set"] = {"base": 3}
    assert "states its stress by sets of tasks" in said(data)


def test_several_products_have_the_limits_of_all_but_each_task_its_own() -> None:
    one = limited.cell(peak_reba=9, time_above_reba_9=4, dose_lifft=0.3)
    both = {"peak:reba": 9, "time-above:reba:9": 8, "dose:lifft": 0.6}
    assert dict(copied(one, 2).operators["anna"].limits) == both
    assert dict(lot({"a": one, "b": one}).operators["anna"].limits) == both
    assert lot({"a": one, "b": one}).cycles_per_shift == 100
    other = limited.cell(peak_reba=8, time_above_reba_9=4, dose_lifft=0.3)
    with pytest.raises(CellError, match="limits"):
        lot({"a": one, "b": other})
    assert not adds_up("peak:reba")
