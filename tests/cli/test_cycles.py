"""`tandem plan` for a station that repeats: what it prints, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tandem.cli.root import main

EXAMPLES = Path(__file__).parents[2] / "examples"
THESIS, COVER = str(EXAMPLES / "thesis.yaml"), str(EXAMPLES / "cover.yaml")
BOX = str(EXAMPLES / "control-box.yaml")


def run(*arguments: str) -> int:
    """The exit code of the command."""
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    return int(ended.value.code or 0)


def ran(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = run("plan", *arguments, "-q")
    printed = capsys.readouterr()
    return code, printed.out, printed.err


def test_the_document_of_a_cycle(capsys, tmp_path):
    kept = tmp_path / "cycle.json"
    code, out, _ = ran(capsys, THESIS, "--cycle", "--json", "-o", str(kept))
    document = json.loads(out)
    assert code == 0
    assert document["objectives"] == ["cycle_time", "stress"]
    assert document["complete"] is True
    assert document["ended_by"] == "proof"
    front = [(p["cycle_time"], p["stress"], p["in_process"]) for p in document["front"]]
    assert front == [(19, 12, 2), (20, 7, 2), (24, 3, 1), (34, 2, 1)]
    for point in document["front"]:
        assert point["status"] == "optimal"
        assert point["bound"]["cycle_time"] == point["cycle_time"]
        assert point["makespan"] == max(row["end"] for row in point["assignments"])
        assert len(point["digest"]) == 12
    assert json.loads(kept.read_text("utf-8"))["front"] == document["front"]
    assert run("check", str(kept)) == 0


def test_one_product_in_process(capsys):
    code, out, _ = ran(capsys, THESIS, "--cycle", "--max-in-process", "1", "--json")
    points = [(p["cycle_time"], p["stress"]) for p in json.loads(out)["front"]]
    assert (code, points) == (0, [(23, 7), (24, 3), (34, 2)])


def test_a_takt(capsys):
    code, out, _ = ran(capsys, THESIS, "--takt", "22")
    assert code == 0
    assert "20" in out
    assert "takt of 22 s" in out
    code, _, err = ran(capsys, THESIS, "--takt", "10")
    assert code == 4
    assert "least cycle time that can be kept is 19 s" in err


def test_a_batch_alone_and_beside_the_cycle(capsys):
    code, out, _ = ran(capsys, COVER, "--batch", "4", "--json")
    document = json.loads(out)
    assert (code, document["front"][0]["makespan"]) == (0, 116)
    assert document["batch"]["makespan"] == document["batch"]["bound"] == 116
    code, out, _ = ran(capsys, COVER, "--cycle", "--batch", "2", "--json")
    document = json.loads(out)
    assert document["objectives"] == ["cycle_time", "stress"]
    assert document["batch"]["makespan"] == 66
    assert len(document["batch"]["assignments"]) == 14


def test_a_mix(capsys):
    asked = ("--cycle", "--minimize", "cycle_time", "--mix", "base=2")
    code, out, _ = ran(capsys, COVER, *asked, "--json")
    document = json.loads(out)
    assert (code, document["front"][0]["cycle_time"]) == (0, 57)
    assert (document["mix"], document["products_per_cycle"]) == ({"base": 2}, 2)
    assert document["alone"] == {"cycle_time": {"base": 31}, "mean": 31, "worst": 31}
    _, out, _ = ran(capsys, COVER, *asked)
    assert "28.5 s a product" in out


def test_a_variant(capsys):
    code, out, _ = ran(capsys, BOX, "--variant", "outdoor", "--takt", "70", "--json")
    document = json.loads(out)
    tasks = {row["task"] for row in document["front"][0]["assignments"]}
    assert (code, "second gasket" in tasks, document["source"]) == (0, True, None)
    assert document["front"][0]["cost_per_piece"] > 0
    code, _, err = ran(capsys, BOX, "--variant", "outdor")
    assert (code, "Did you mean 'outdoor'" in err) == (2, True)


def test_breaks_are_said_to_play_no_part(capsys, tmp_path):
    text = Path(THESIS).read_text("utf-8")
    assert "human: {kind: human}" in text
    cell = tmp_path / "cell.yaml"
    cell.write_text(text.replace("human: {kind: human}", "human: {kind: human, breaks: [[9, 12]]}"))
    code, _, err = ran(capsys, str(cell), "--takt", "30")
    assert (code, "those of human play no part" in err) == (0, True)


@pytest.mark.parametrize(
    ("asked", "code", "said"),
    [
        (("--max-in-process", "2"), 2, "goes with --cycle or --takt"),
        (("--cycle", "--weights", "1,1", "--cv", "0.2"), 2, "--weights and --cv"),
        (("--cycle", "--minimize", "makespan"), 2, "choose cycle_time or stress"),
        (("--takt", "30", "--minimize", "stress"), 2, "--minimize and --takt exclude"),
        (("--minimize", "cycle_time"), 2, "goes with --cycle"),
        (("--takt", "-3"), 2, "takt -3: must be"),
        (("--cycle", "--max-in-process", "0"), 2, "max-in-process"),
        (("--cycle", "--point", "9"), 2, "--point 9: the front has 4"),
        (("--cycle", "--method", "longest-tail"), 2, "There are exact, exhaustive"),
        (("--cycle", "-o", "plan.xml"), 2, "xml"),
        (("--mix", "base=2"), 2, "go with --cycle"),
        (("--cycle", "--one-allocation"), 2, "goes with --mix"),
        (("--cycle", "--mix", "base=x"), 2, "no name and count"),
        (("--cycle", "--mix", "base=1,base=2"), 2, "stands there twice"),
        (("--cycle", "--mix", "shares"), 2, "the cell has no variants"),
        (("--cycle", "--mix", "longg=1"), 2, "no such variant"),
        (("--batch", "0"), 2, "batch"),
        (("--batch", "3", "--max-stress", "5"), 2, "no limit on a batch"),
        (("--batch", "3", "--method", "exhaustive"), 2, "batches are planned by exact"),
        (("--batch", "9000"), 3, "at most 20,000 can be planned"),
    ],
)
def test_what_does_not_go_together_is_said(capsys, asked, code, said):
    found, out, err = ran(capsys, THESIS, *asked)
    assert (found, out) == (code, "")
    assert said in err
    assert "Traceback" not in err


def test_fixed_times_are_refused_at_their_places(capsys):
    code, out, err = ran(capsys, str(EXAMPLES / "gearbox.yaml"), "--cycle")
    assert (code, out) == (3, "")
    assert "tasks.seal.release" in err
    assert "tasks.check.deadline" in err
