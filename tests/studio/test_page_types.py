"""The types that the page's modules state in their comments hold, by TypeScript's own checker."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

STATIC = Path(__file__).parents[2] / "src/tandem/studio/static"
DECLARED = Path(__file__).parent / "types"
"""What the vendored modules offer, as far as the page uses it."""


def test_the_types_of_the_page_hold(tmp_path: Path) -> None:
    checker = os.environ.get("TSC") or shutil.which("tsc")
    if not checker:
        pytest.skip(
            "no type checker for the page: apt-get install npm, npm install --global typescript"
        )
    for path in STATIC.glob("*.js"):
        shutil.copy(path, tmp_path)
    shutil.copytree(DECLARED, tmp_path / "vendor")
    modules = sorted(path.name for path in tmp_path.glob("*.js"))
    assert "app.js" in modules
    told = subprocess.run(
        [
            *(checker, "--checkJs", "--allowJs", "--strict", "--noEmit"),
            *("--target", "es2022", "--module", "es2022", "--moduleResolution", "bundler"),
            *("--lib", "es2023,dom,dom.iterable", *modules),
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert told.stdout == ""
    assert told.returncode == 0
