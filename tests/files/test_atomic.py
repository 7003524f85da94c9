"""Output files are whole or absent."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tandem.files.atomic import store
from tandem.files.generators import layered
from tandem.files.load import dump


def test_a_file_is_replaced_as_a_whole_and_keeps_its_permissions(tmp_path):
    path = tmp_path / "plan.json"
    path.write_text("old", "utf-8")
    path.chmod(0o640)
    store(path, "new é")
    assert path.read_text("utf-8") == "new é"
    assert path.stat().st_mode & 0o777 == 0o640
    assert [entry.name for entry in tmp_path.iterdir()] == ["plan.json"]


def test_a_link_still_points_to_the_file_that_was_written(tmp_path):
    (tmp_path / "real.txt").write_text("old", "utf-8")
    (tmp_path / "link.txt").symlink_to("real.txt")
    store(tmp_path / "link.txt", b"new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "real.txt").read_bytes() == b"new"


def test_nothing_is_left_behind_where_nothing_can_be_written(tmp_path):
    with pytest.raises(OSError, match="directory"):
        store(tmp_path / "nowhere" / "plan.json", "x")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError, match="directory"):
        store(tmp_path / "folder", "x")
    assert [entry.name for entry in tmp_path.iterdir()] == ["folder"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_device_is_written_directly():
    with pytest.raises(OSError, match="No space left"):
        store("/dev/full", "x")
    store("/dev/null", "x")


@pytest.fixture
def full_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 KiB that is nearly full."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)],
        capture_output=True,
        check=False,
    )
    if mounted.returncode != 0:
        pytest.skip("mounting a small disk needs the rights of root")
    try:
        (folder / "ballast").write_bytes(bytes(40 * 1024))
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=False)


def test_on_a_full_disk_the_old_file_stays_as_it_was(full_disk):
    cell = layered(500, seed=1)
    dump(layered(3, seed=1), full_disk / "cell.yaml")
    before = (full_disk / "cell.yaml").read_bytes()
    with pytest.raises(OSError, match="No space left"):
        dump(cell, full_disk / "cell.yaml")
    with pytest.raises(OSError, match="No space left"):
        dump(cell, full_disk / "new.yaml")
    assert (full_disk / "cell.yaml").read_bytes() == before
    assert sorted(os.listdir(full_disk)) == ["ballast", "cell.yaml"]
