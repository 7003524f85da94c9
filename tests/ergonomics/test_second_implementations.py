"""Each method of the first tier agrees with an implementation written apart from it."""

from __future__ import annotations

import pytest
from tests.fuzz import ergonomics

from tandem.ergonomics import duet


@pytest.mark.parametrize("method", ergonomics.JUDGES)
def test_a_method_agrees_with_its_second_implementation(method):
    assert ergonomics.disagreements(method, 2_000, seed=7) == []


def test_composite_indices_agree_with_their_second_implementation():
    assert ergonomics.composites(300, seed=7) == []


def test_a_changed_table_is_found(monkeypatch):
    """A fault that is planted is seen: one cell of table C of RULA."""
    from tandem.ergonomics import rula

    rows = list(rula.TABLE_C)
    rows[3] = "3334567"  # the last cell is 6
    monkeypatch.setattr(rula, "TABLE_C", tuple(rows))
    assert ergonomics.disagreements("rula", 5_000, seed=7) != []


def test_a_changed_composite_is_found(monkeypatch):
    """Faults that are planted are seen: the multiplier of hours in days, the reach in jobs."""
    from tandem.ergonomics import niosh, rsi

    monkeypatch.setattr(rsi, "hours_multiplier", lambda *, H: 0.2 if H <= 0.05 else 0.05 * H + 0.6)
    assert all("subtasks" in found for found in ergonomics.composites(200, seed=7))
    assert ergonomics.composites(200, seed=7) != []
    monkeypatch.undo()
    nearer = {**niosh.SYSTEMS, "cm": niosh.SYSTEMS["cm"]._replace(h_min=24)}
    monkeypatch.setattr(niosh, "SYSTEMS", nearer)
    assert any("subtasks" not in found for found in ergonomics.composites(200, seed=7))


def test_the_printed_damage_is_the_rounded_inverse_of_the_printed_cycles():
    from tests.ergonomics.second import fatigue

    pairs = zip(duet.DAMAGE_PER_CYCLE, fatigue.CYCLES, strict=True)
    assert all(abs(damage * cycles - 1) < 0.005 for damage, cycles in pairs)
