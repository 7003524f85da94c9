"""What was compiled is kept in the user's cache, unless the user says otherwise or it cannot be."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

ASK = """
import os
from tandem.cli.compiled import keep_compiled
keep_compiled()
print(os.environ.get("JAX_COMPILATION_CACHE_DIR", ""))
"""
COMPILE = (
    ASK
    + """
import jax, logging
logging.basicConfig(level=logging.DEBUG)
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0)
print(jax.jit(lambda x: x * 2 + 1)(3.0))
"""
)


def asked(code: str, **variables: str) -> subprocess.CompletedProcess[str]:
    env = {
        name: value for name, value in os.environ.items() if not name.startswith(("JAX_", "XDG_"))
    }
    return subprocess.run(
        [sys.executable, "-c", code],
        env=env | variables,
        capture_output=True,
        text=True,
        check=True,
    )


def test_a_second_process_finds_what_the_first_one_compiled(tmp_path):
    first = asked(COMPILE, XDG_CACHE_HOME=str(tmp_path))
    folder = Path(first.stdout.splitlines()[0])
    assert folder.is_relative_to(tmp_path)
    assert any(file.name.startswith("jit__lambda") for file in folder.iterdir())
    second = asked(COMPILE, XDG_CACHE_HOME=str(tmp_path))
    assert second.stdout == first.stdout
    assert "Persistent compilation cache hit for 'jit__lambda" in second.stderr
    assert "Persistent compilation cache hit for 'jit__lambda" not in first.stderr


def test_what_a_killed_command_left_half_written_is_dropped(tmp_path):
    folder = Path(asked(COMPILE, XDG_CACHE_HOME=str(tmp_path)).stdout.splitlines()[0])
    (whole,) = folder.glob("jit__lambda*-cache")
    half = whole.with_name("jit_half-cache")
    half.write_bytes(whole.read_bytes()[:100])
    again = asked(COMPILE, XDG_CACHE_HOME=str(tmp_path))
    assert not half.exists()
    assert whole.exists()
    assert "Error" not in again.stderr


def test_a_folder_that_the_user_has_named_is_left_alone(tmp_path):
    entry = tmp_path / "somebody-else-cache"
    entry.touch()
    found = asked(ASK, JAX_COMPILATION_CACHE_DIR=str(tmp_path))
    assert found.stdout.strip() == str(tmp_path)
    assert entry.exists()


def test_where_nothing_can_be_kept_nothing_is_said(tmp_path):
    (tmp_path / "a file").touch()
    found = asked(ASK, XDG_CACHE_HOME=str(tmp_path / "a file"))
    assert found.stdout.strip() == ""
    assert found.stderr == ""
