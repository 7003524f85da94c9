"""Workbooks are opened in this process, by the very lines that the child process runs: starting one
costs more than reading a small book, and these tests open well over a thousand.

Where the child is the subject (what it is refused, how it ends, what the commands print) it runs.
"""

from __future__ import annotations

import io
import subprocess
from collections.abc import Sequence
from contextlib import redirect_stdout
from typing import Any

import pytest

from tandem.files.spreadsheet import confined, worker

APART = ("test_hostile_workbooks.py", "test_import_commands.py", "test_other_offices.py")
"""The files whose books are opened by a child process, as a user's are."""


class Here:
    """Stands for `subprocess` where `confined` asks for its child."""

    TimeoutExpired = subprocess.TimeoutExpired

    @staticmethod
    def run(asked: Sequence[str], *, input: bytes, **_: Any) -> subprocess.CompletedProcess[bytes]:
        with redirect_stdout(io.StringIO()) as said:
            worker._answer(asked[3], input)
        return subprocess.CompletedProcess(asked, 0, said.getvalue().encode(), b"")


@pytest.fixture(autouse=True)
def _opened_here(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.path.name not in APART:
        monkeypatch.setattr(confined, "subprocess", Here)
