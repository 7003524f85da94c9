"""`tandem dispatch` and `tandem simulate` with a plan that was chosen, and without."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import tandem
from tandem.cli.root import run
from tandem.dispatch.lookahead.objective import Objective
from tandem.files.generators import layered
from tandem.plan.result import knee_index

CELL = Path("examples/thesis.yaml").resolve()
THESIS = tandem.load(CELL)
Capture = pytest.CaptureFixture[str]
Tandem = Callable[..., tuple[int, list[Any], str]]


@pytest.fixture
def tandem_(capfd: Capture, monkeypatch: pytest.MonkeyPatch) -> Tandem:
    """A command: its exit code, the documents that it printed, and what it said besides."""

    def go(*arguments: object) -> tuple[int, list[Any], str]:
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"")))
        code = run(list(map(str, arguments)))
        out, err = capfd.readouterr()
        return code, [json.loads(line) for line in out.splitlines() if line[:1] in "{["], err

    return go


@pytest.fixture
def plan_file(tmp_path: Path) -> Path:
    """The front of the thesis's cell: (23, 7), (24, 3), (34, 2)."""
    front = tandem.plan(THESIS, workers=1)
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(front.to_dict()), encoding="utf-8")
    return path


def shift(
    tandem_: Tandem, *options: object, cell: Path = CELL
) -> tuple[list[Any], dict[str, Any], str]:
    """The decisions and the summary of a shift beside somebody simulated, and what was said."""
    code, documents, err = tandem_("dispatch", cell, "--json", *options)
    assert code == 0, err
    return [one for one in documents if one["type"] == "decision"], documents[-1], err


@pytest.mark.parametrize(("point", "values"), [(1, (23, 7)), (2, (24, 3)), (3, (34, 2))])
@pytest.mark.parametrize("name", ["fixed", "replan-robust", "auto"])
def test_the_chosen_point_is_what_comes_of_a_shift(
    tandem_: Tandem, plan_file: Path, name: str, point: int, values: tuple[float, float]
) -> None:
    """Beside somebody who complies, at stated times. What may be gained by whoever does not yet
    know the pace is not enough to leave the plan.
    """
    digest = json.loads(plan_file.read_text())["front"][point - 1]["digest"]
    asked = ("--policy", name, "--plan", plan_file, "--point", point)
    decisions, summary, _ = shift(tandem_, *asked, "--simulate", "compliant")
    assert (summary["makespan"], summary["stress"]) == values
    said = [one["why"] for one in decisions if one["starts"] or one["asks"]]
    assert all(f"as the plan {digest} has it" in why for why in said), said


def test_what_is_left_of_the_plan_and_why_is_said(tandem_: Tandem, plan_file: Path) -> None:
    """A person who needs three times as long: the robot takes over what the plan gives to them.
    With a penalty that nothing gains, it does not.
    """
    asked = ("--policy", "auto", "--plan", plan_file, "--point", 1, "--simulate", "pace:3")
    free, quicker, _ = shift(tandem_, *asked, "--weights", "1,0")
    left = [one["why"] for one in free if "it leaves the plan" in one["why"]]
    assert left, [one["why"] for one in free]
    assert all("by which" in why and "and gains" in why for why in left), left
    bound, slower, _ = shift(tandem_, *asked, "--weights", "1,0", "--change-penalty", 1000)
    assert not [one for one in bound if "it leaves the plan" in one["why"]]
    assert quicker["makespan"] < slower["makespan"]


def test_the_fixed_policy_judged_is_the_chosen_plan(tandem_: Tandem, plan_file: Path) -> None:
    pytest.importorskip("jax", reason="judging needs the extra tandem[learn]")
    front = json.loads(plan_file.read_text())["front"]
    for point, row in enumerate(front, 1):
        code, [document], _ = tandem_(
            "simulate", CELL, "--policy", "fixed", "--plan", plan_file, "--point", point,
            "--episodes", 2, "--json",
        )  # fmt: skip
        assert code == 0
        [found] = document["policies"]
        assert (found["makespan"]["mean"], found["stress"]["mean"]) == (
            row["makespan"],
            row["stress"],
        )
        assert found["plan"]["digest"] == row["digest"]


def test_without_a_plan_the_weights_are_those_of_the_recommended_point(tandem_: Tandem) -> None:
    """Seconds alone would take 23 s and a stress of 7 or more."""
    front = tandem.plan(THESIS, workers=1)
    expected = Objective.of_point(front, knee_index(front.points))
    code, documents, err = tandem_("dispatch", CELL, "--json", "--simulate", "compliant")
    assert (code, documents[0]["weights"]) == (0, [1.0, expected.stress]), err
    assert (documents[-1]["makespan"], documents[-1]["stress"]) == (24, 3)
    for given, weights in (("1,0", [1, 0]), ("1,0.25", [1, 0.25]), ("knee", [1, expected.stress])):
        _, documents, _ = tandem_("dispatch", CELL, "--json", "--weights", given)
        assert documents[0]["weights"] == weights


def test_fixed_without_a_plan_carries_out_the_recommended_point(tandem_: Tandem) -> None:
    _, summary, _ = shift(tandem_, "--policy", "fixed", "--simulate", "compliant")
    assert (summary["makespan"], summary["stress"]) == (24, 3)


def test_where_the_front_is_not_proven_in_a_few_seconds_that_is_said(
    tandem_: Tandem, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tandem.cli.following.FRONT_S", 0.2)
    cell = tmp_path / "large.json"
    cell.write_text(json.dumps(layered(40, 2, 2, seed=1).to_dict()), encoding="utf-8")
    code, _, err = tandem_("dispatch", cell, "--json", "--policy", "spt")
    assert code == 0
    assert "the front was not proven within 0.2 s: the weights are those of the best" in err


def test_a_stale_plan_is_said_and_one_that_breaks_the_cell_refused(
    tandem_: Tandem, plan_file: Path, tmp_path: Path
) -> None:
    data = THESIS.to_dict()
    data["tasks"]["5"]["stress"] = 4
    data["tasks"]["1"]["label"] = "Base"
    cell = tmp_path / "changed.json"
    cell.write_text(json.dumps(data), encoding="utf-8")
    _, _, err = shift(tandem_, "--plan", plan_file, cell=cell)
    assert f"{plan_file}: stale: made for another state of the cell." in err
    data["tasks"]["4"]["time"]["robot"] += 4
    cell.write_text(json.dumps(data), encoding="utf-8")
    for command in (("dispatch", cell), ("simulate", cell, "--policy", "fixed")):
        code, _, err = tandem_(*command, "--plan", plan_file)
        assert code == 6
        assert "'4'" in err
        assert "tandem replan CELL --from PLAN.json" in err


def test_words_name_the_plan(plan_file: Path, capfd: Capture) -> None:
    digest = json.loads(plan_file.read_text())["front"][2]["digest"]
    arguments = ["dispatch", str(CELL), "--plan", str(plan_file), "--point", "3", "--words"]
    assert run([*arguments, "--simulate", "compliant"]) == 0
    assert f"decided by auto, the plan {digest} in hand." in capfd.readouterr().out


def test_a_shift_goes_on_with_its_own_plan_only(
    tandem_: Tandem, plan_file: Path, tmp_path: Path
) -> None:
    journal = ("--journal", tmp_path / "shift.db", "--json")
    first = tandem_("dispatch", CELL, "--plan", plan_file, "--point", 3, *journal)
    code, documents, err = tandem_("dispatch", CELL, "--plan", plan_file, "--point", 3, *journal)
    assert (code, documents[0]["plan"]) == (0, first[1][0]["plan"]), err
    plan_file.unlink()
    assert tandem_("dispatch", CELL, *journal)[1][0]["plan"] == first[1][0]["plan"]
    assert tandem_("dispatch", CELL, *journal, "--replay")[0] == 0


def test_another_plan_than_the_shift_s_is_refused(
    tandem_: Tandem, plan_file: Path, tmp_path: Path
) -> None:
    journal = ("--journal", tmp_path / "shift.db", "--json")
    tandem_("dispatch", CELL, "--plan", plan_file, "--point", 3, *journal)
    code, _, err = tandem_("dispatch", CELL, "--plan", plan_file, "--point", 1, *journal)
    digests = [row["digest"] for row in json.loads(plan_file.read_text())["front"]]
    assert code == 2
    assert (
        f"--plan is the plan {digests[0]}, the shift was begun with the plan {digests[2]}." in err
    )


@pytest.mark.parametrize(
    ("options", "code", "message"),
    [
        (("--point", 2), 2, "--point: chooses a point of a plan; give it with --plan."),
        (("--plan", "PLAN", "--point", 9), 2, "--point 9: the front has 3 points"),
        (("--plan", "PLAN", "--policy", "spt"), 2, "spt would not heed it"),
        (("--plan", "PLAN", "--point", 1, "--stress", 2), 2, "exclude each other"),
        (("--plan", "none.json"), 2, "none.json"),
        (("--weights", "knees"), 2, "nor knee"),
        (("--plan", "PLAN", "--learned", "x.npz"), 2, "a plan and a trained policy are given"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_message(
    tandem_: Tandem, plan_file: Path, options: tuple[object, ...], code: int, message: str
) -> None:
    given = [plan_file if one == "PLAN" else one for one in options]
    found, documents, err = tandem_("dispatch", CELL, *given)
    assert (found, documents) == (code, [])
    assert message in err
    assert "Traceback" not in err


def test_points_of_a_front_have_weights_by_which_they_are_its_best() -> None:
    """Where the front is convex there; (1, w) with w between both slopes."""
    front = tandem.plan(THESIS, workers=1)
    assert front.points == [(23, 7), (24, 3), (34, 2)]
    weights = [Objective.of_point(front, point) for point in range(3)]
    for point, objective in enumerate(weights):
        costs = [objective.cost(*values) for values in front.points]
        assert costs.index(min(costs)) == point
    assert [objective.stress for objective in weights] == [0.125, 1.58, 20.0]


@pytest.mark.parametrize(
    ("asked", "weights"),
    [
        ({"minimize": "makespan"}, (1, 0)),
        ({"minimize": "stress"}, (1, 34)),
        ({"minimize": "weighted", "weights": (1.0, 0.5)}, (1, 0.5)),
        ({"max_stress": 2}, (1, 17)),
    ],
)
def test_a_front_of_one_point_weighs_as_it_was_asked(
    asked: dict[str, Any], weights: tuple[float, float]
) -> None:
    front = tandem.plan(THESIS, workers=1, **asked)
    objective = Objective.of_point(front, 0)
    assert (objective.time, objective.stress) == weights
