"""What is published of the systems: every claim names its source, and stands beside what our
version does.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("jax", reason="needs tandem[learn]")

from tandem.lab.probes import PROBES
from tandem.lab.published import PUBLISHED, UNKNOWN, published
from tandem.lab.systems import SYSTEMS

FEATURES = Path(__file__).resolve().parents[2] / "benchmarks" / "results" / "features.json"


def test_every_claim_is_about_a_system_and_a_feature_that_there_are_and_names_its_source():
    assert set(PUBLISHED) == {name for name, system in SYSTEMS.items() if system.published}
    for claims in PUBLISHED.values():
        assert set(claims) <= set(PROBES)
        assert all(claim.source for claim in claims.values())


def test_what_nobody_has_read_is_not_claimed():
    assert published("alessio2022", "tools") == UNKNOWN
    assert UNKNOWN.value == "not known"


def test_published_and_rebuilt_are_two_things():
    """Yu 2020 knows no mistakes of people; our world of it can."""
    rebuilt = json.loads(FEATURES.read_text("utf-8"))["features"]
    assert set(rebuilt) <= set(PUBLISHED)
    assert all(set(entries) <= set(PROBES) for entries in rebuilt.values())
    assert published("yu2020", "human deviation").value.startswith("no")
    assert rebuilt["yu2020"]["human deviation"]["value"].startswith("yes")
