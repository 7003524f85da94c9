"""What every test shares."""

from __future__ import annotations

import os
from collections.abc import Generator
from typing import Any

import pytest
from hypothesis import settings

settings.register_profile("tandem", deadline=None)  # a busy machine is no fault of the code
settings.load_profile("tandem")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    return _no_excuse((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    return _no_excuse((yield))


def _no_excuse(report: Any) -> Any:
    """Where TANDEM_CI is set, all that `apt-get install` can bring is there: what is skipped for want of it has failed."""
    if os.environ.get("TANDEM_CI") and report.skipped and "apt-get install" in str(report.longrepr):
        report.outcome = "failed"
    return report
