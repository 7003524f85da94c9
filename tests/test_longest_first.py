"""The order in which whole files are handed to the workers of a run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from tests import longest_first


@dataclass
class Item:
    """A test of a file, marked slow or not."""

    nodeid: str
    slow: bool = False

    def get_closest_marker(self, name: str) -> str | None:
        return name if self.slow and name == "slow" else None


@dataclass
class Config:
    """A worker's, with what it was told; one process is told nothing."""

    workerinput: dict[str, Any] = field(default_factory=dict)

    def getoption(self, name: str) -> None:
        assert name == "--changed"  # which was not asked for


def order(items: list[Item], known: dict[str, float]) -> list[str]:
    longest_first.pytest_collection_modifyitems(
        Config({longest_first.KEPT: known}),  # type: ignore[arg-type]
        items,  # type: ignore[arg-type]
    )
    return [item.nodeid for item in items]


def test_the_file_that_took_longest_comes_first_and_its_tests_stay_in_order() -> None:
    items = [Item("a.py::1"), Item("b.py::1"), Item("b.py::2"), Item("c.py::1")]
    assert order(items, {"a.py": 1.0, "b.py": 30.0, "c.py": 4.0}) == [
        "b.py::1",
        "b.py::2",
        "c.py::1",
        "a.py::1",
    ]


def test_where_no_time_is_known_files_with_slow_tests_come_first() -> None:
    items = [Item("a.py::1"), Item("b.py::1"), Item("b.py::2", slow=True), Item("c.py::1")]
    assert order(items, {}) == ["b.py::1", "b.py::2", "a.py::1", "c.py::1"]


def test_the_seconds_of_a_run_are_kept_and_a_part_of_a_file_does_not_make_it_short() -> None:
    kept: dict[str, Any] = {longest_first.KEPT: {"a.py": 60.0, "b.py": 5.0, "gone.py": 7.0}}

    @dataclass
    class Cache:
        def get(self, key: str, default: Any) -> Any:
            return kept.get(key, default)

        def set(self, key: str, value: Any) -> None:
            kept[key] = value

    @dataclass
    class Run:
        cache: Cache

    @dataclass
    class Report:
        nodeid: str
        duration: float

    clock = longest_first.Clock(Run(Cache()))  # type: ignore[arg-type]
    for report in (Report("a.py::1", 2.0), Report("b.py::1", 8.0), Report("b.py::2", 1.0)):
        clock.pytest_runtest_logreport(report)  # type: ignore[arg-type]
    clock.pytest_sessionfinish()
    assert kept[longest_first.KEPT] == {"a.py": 30.0, "b.py": 9.0, "gone.py": 7.0}
