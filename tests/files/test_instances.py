"""Benchmark instances by name, and what `tandem formats` says of a folder of them."""

from __future__ import annotations

import json

import pytest

import tandem
from tandem.cli.root import run
from tandem.errors import CellError, UsageError
from tandem.files.instances.named import instance, shipped
from tandem.files.load import dumps, loads


@pytest.fixture
def sets(tmp_path, monkeypatch):
    """A folder of two sets."""
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "la99.txt").write_text("1 2\n0 3 1 2\n")
        (tmp_path / name / "README.md").write_text("# about")
    (tmp_path / "two" / "mini.fjs").write_text("1 2\n1 2 1 3 2 4\n")
    (tmp_path / "two" / "odd.fjs").write_text("1 2\n1 2 1 3 2\n")
    monkeypatch.setenv("TANDEM_BENCHMARKS", str(tmp_path))
    return tmp_path


def test_ft06_takes_55():
    (point,) = tandem.plan(instance("ft06"), minimize="makespan", workers=1)
    assert (point.makespan, point.status.value) == (55, "optimal")


def test_every_instance_that_ships_is_a_job_shop_of_its_size():
    sizes = {name: len(instance(name).tasks) for name in ("ft10", "ft20", "ta01", "ta80")}
    assert sizes == {"ft10": 100, "ft20": 100, "ta01": 225, "ta80": 2000}
    assert len(shipped()) == 83


def test_taillards_first_row_is_drawn_as_it_was_published():
    """Row 1 of ta01: EJOR 64 (1993); in JSPLIB's file of the same name."""
    cell = instance("ta01")
    row = [next(iter(cell.tasks[f"1.{step}"].time.items())) for step in range(1, 16)]
    assert [time for _, time in row] == [94, 66, 10, 53, 26, 15, 65, 82, 10, 27, 93, 92, 96, 70, 83]
    machines = [6, 12, 4, 7, 3, 2, 10, 11, 8, 14, 9, 13, 5, 0, 1]
    assert [name for name, _ in row] == [f"machine_{number}" for number in machines]


def test_others_come_from_the_folder(sets, capsys):
    assert run(["generate", "mini"]) == 0
    assert loads(capsys.readouterr().out) == loads("1 2\n1 2 1 3 2 4\n", "fjs", source="mini")
    assert instance("one/la99") == instance("one/la99.txt")
    with pytest.raises(UsageError, match=r"several .* 'la99'.*one/la99.txt, two/la99.txt"):
        instance("la99")
    with pytest.raises(UsageError, match=r"there is no instance 'minni'.*Did you mean 'mini'"):
        instance("minni")
    with pytest.raises(CellError, match=r"odd.fjs:2: operation 1: 2 machines need 4 numbers"):
        instance("odd")


def test_without_a_folder_the_message_says_how_to_name_one(monkeypatch, capsys):
    monkeypatch.delenv("TANDEM_BENCHMARKS", raising=False)
    assert run(["generate", "mk01"]) == 2
    said = capsys.readouterr().err
    assert "TANDEM_BENCHMARKS names; it names none" in said
    assert "Traceback" not in said
    with pytest.raises(UsageError, match="Did you mean 'ta01'"):
        instance("ta001")


def test_a_folder_that_is_not_there_is_said(monkeypatch):
    monkeypatch.setenv("TANDEM_BENCHMARKS", "/no/such/folder")
    with pytest.raises(CellError, match="/no/such/folder: TANDEM_BENCHMARKS names this folder"):
        instance("mk01")


def test_formats_counts_a_folder_and_says_why_not(sets, capsys):
    assert run(["formats", str(sets)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines[:4]] == [
        ["set", "format", "files", "cells"],
        ["one", "jsp", "1", "1"],
        ["two", "jsp,", "fjs", "3", "2"],
        ["all", "4", "3"],
    ]
    assert lines[-1].strip() == "operation …: … machines need … numbers, but … follow: 1 of two"
    assert run(["formats", str(sets), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [one["cells"] for one in document["sets"]] == [1, 2]


def test_formats_lists_what_is_read_and_written(capsys):
    assert run(["formats", "--json"]) == 0
    listed = {row["name"]: row for row in json.loads(capsys.readouterr().out)["formats"]}
    assert listed["pyjobshop"] == {
        "name": "pyjobshop",
        "what": "problem data of PyJobShop, JSON",
        "read": False,
        "written": True,
    }
    assert listed["psplib"]["read"]
    assert not listed["psplib"]["written"]
    assert dumps(instance("ft06"), "jsp").splitlines()[0] == "6 6"
