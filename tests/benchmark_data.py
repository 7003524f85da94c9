"""Where the public benchmark sets are, for the tests that read them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

BESIDE = Path(__file__).resolve().parents[2] / "shared" / "data" / "benchmarks"


def folder(name: str = "") -> Path:
    """The folder of one set, or of all; where it is absent the test is skipped."""
    found = Path(os.environ.get("TANDEM_BENCHMARKS", BESIDE)) / name
    if not found.is_dir():
        pytest.skip(
            "the public benchmark sets are not here; TANDEM_BENCHMARKS=FOLDER says where they are"
        )
    return found
