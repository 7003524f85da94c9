"""What the page of the docs says of the studio's speed is what the benchmark printed."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_docs_tell_what_the_benchmark_printed() -> None:
    printed = (ROOT / "benchmarks/results/studio_speed.txt").read_text().rstrip()
    assert f"```text\n{printed}\n```" in (ROOT / "docs/studio.md").read_text()
