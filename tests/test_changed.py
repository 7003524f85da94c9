"""`pytest --changed`: what a change can break runs, what is nearest to it first, while there is
time.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from tests import changed

ROOT = Path(__file__).resolve().parents[1]


def steps(test: str, *files: str, slow: bool = False) -> int | None:
    marker = SimpleNamespace(name="slow") if slow else None
    item = SimpleNamespace(path=ROOT / test, get_closest_marker=lambda _: marker)
    return changed._steps_to(item, frozenset(files))  # type: ignore[arg-type]


CHECKER = "src/tandem/schedule/checker.py"


def test_a_test_of_the_changed_room_is_nearest_and_the_others_follow_by_imports() -> None:
    assert steps("tests/schedule/test_measures.py", CHECKER) == 0
    assert steps("tests/plan/test_door.py", CHECKER) == 0, "it asks the checker itself"
    assert steps("tests/explain/test_changes.py", CHECKER) == 1
    assert steps("tests/ergonomics/test_ranges_and_order.py", CHECKER) is None


def test_imports_are_counted_from_the_change_upwards() -> None:
    found = changed.downstream(frozenset({CHECKER}))
    assert found["tandem.schedule.checker"] == 0
    assert found["tandem.plan.door"] == 1
    assert "tandem.ergonomics.methods" not in found
    graph = changed._graph()
    for module, count in found.items():
        below = graph.find_modules_directly_imported_by(module)
        assert not count or min(found[one] for one in below if one in found) == count - 1


def test_what_is_slow_runs_only_in_the_changed_room() -> None:
    assert steps("tests/schedule/test_measures.py", CHECKER, slow=True) == 0
    assert steps("tests/plan/test_door.py", CHECKER, slow=True) is None


def test_a_page_concerns_those_that_read_it() -> None:
    assert steps("tests/test_docs.py", "docs/dispatch.md") is not None
    assert steps("tests/schedule/test_measures.py", "docs/dispatch.md") is None


def test_when_the_time_is_over_no_test_begins_and_it_is_said() -> None:
    item = SimpleNamespace()
    changed.Deadline(60.0).pytest_runtest_setup(item)  # type: ignore[arg-type]
    with pytest.raises(pytest.skip.Exception, match="-1 s are over: further from the change"):
        changed.Deadline(-1.0).pytest_runtest_setup(item)  # type: ignore[arg-type]
