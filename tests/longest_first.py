"""Test files that took long the last time run first, so that the workers of a run end at about the
same time.

pytest hands whole files to the workers (`--dist loadfile`), in the order in which they were
collected. The seconds of each file are kept in pytest's cache; where none are known, on a fresh
checkout, the files with tests that are marked slow come first.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

KEPT = "tandem/seconds_of_files"
"""Where in pytest's cache, as a JSON table: file -> seconds of all its tests."""


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Clock(config), "longest-first-clock")


class Clock:
    """Adds up what each file takes; of the files that did not run, what is known stays."""

    def __init__(self, config: pytest.Config) -> None:
        self.cache = getattr(config, "cache", None)  # none under -p no:cacheprovider
        self.known: dict[str, float] = self.cache.get(KEPT, {}) if self.cache else {}
        self.spent: Counter[str] = Counter()

    @pytest.hookimpl(optionalhook=True)
    def pytest_configure_node(self, node: Any) -> None:
        """Every worker must sort alike, whatever another run writes meanwhile."""
        node.workerinput[KEPT] = self.known

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.spent[report.nodeid.split("::")[0]] += report.duration

    def pytest_sessionfinish(self) -> None:
        if self.cache:
            longest = {
                file: round(max(seconds, self.known.get(file, 0) / 2), 1)
                for file, seconds in self.spent.items()  # a part of a file says less than the file
            }
            self.cache.set(KEPT, self.known | longest)


@pytest.hookimpl(trylast=True)  # rooms mark their slow tests first
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if not hasattr(config, "workerinput"):
        return  # one process runs in the order of the folders
    if config.getoption("--changed") is not None:
        return  # nearest to the change first
    known = config.workerinput[KEPT]
    slow = Counter(file_of(item) for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: (known.get(file_of(item), 0.0), slow[file_of(item)]), reverse=True)


def file_of(item: pytest.Item) -> str:
    return item.nodeid.split("::")[0]
