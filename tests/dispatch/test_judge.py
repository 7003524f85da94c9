"""The judge: the document that outsiders rely on, paired intervals, the command line."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.dispatch.stations import THESIS

from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.dispatch.deciders.table import POLICIES, policy
from tandem.dispatch.evaluation.trial import judge, split_people
from tandem.draw.judged import judged_figure, plot_regret
from tandem.errors import UsageError
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.world.randomness import Chance

ROOT = Path(__file__).resolve().parents[2]
CELL = str(ROOT / "examples" / "thesis.yaml")
RESULTS = ROOT / "benchmarks" / "results"
Capture = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def documents() -> list[dict[str, Any]]:
    return judge(
        THESIS,
        ("expected", "fixed", "minimax"),
        ("random:0.1", "random:0.5", "learning:0.2"),
        400,
        3,
    )


def row(document: dict[str, Any], policy: str) -> dict[str, Any]:
    found: dict[str, Any] = next(one for one in document["policies"] if one["policy"] == policy)
    return found


def test_the_document_is_what_outsiders_rely_on(documents: list[dict[str, Any]]) -> None:
    document = documents[0]
    assert document["people"] == "random:0.1"
    assert [one["policy"] for one in document["policies"]] == ["expected", "fixed", "minimax"]
    for one in document["policies"]:
        for measure in ("makespan", "stress"):
            low, high = one[measure]["ci95"]
            assert low <= one[measure]["mean"] <= high
            assert one[measure]["p5"] <= one[measure]["p95"]
        assert one["latency_ms"]["p50"] <= one["latency_ms"]["p99"]
        assert {"regret", "regret_ci95", "proximity", "changes", "done"} <= set(one)


def test_regret_is_against_the_exact_optimum_where_there_is_one(
    documents: list[dict[str, Any]],
) -> None:
    assert [document["optimum"] for document in documents] == [
        pytest.approx(23.2333, abs=1e-4),
        pytest.approx(24.1667, abs=1e-4),
        None,
    ]
    low, high = row(documents[1], "expected")["regret_ci95"]
    assert low <= 0 <= high, "the exact decider's regret is 0, as far as the sample tells"
    assert row(documents[1], "minimax")["regret_ci95"][0] > 0
    assert row(documents[1], "fixed")["proximity"] < 1
    assert row(documents[2], "fixed")["regret"] is None


def test_pairs_say_more_than_means(documents: list[dict[str, Any]]) -> None:
    """The same episodes: the interval of the difference is narrower than two independent means
    would give.
    """
    for document in documents[:2]:
        one, other = row(document, "expected")["makespan"], row(document, "minimax")
        low, high = other["difference"]["ci95"]
        assert other["difference"]["mean"] == pytest.approx(
            other["makespan"]["mean"] - one["mean"], abs=1e-3
        )
        apart = (
            (one["ci95"][1] - one["ci95"][0]) ** 2
            + (other["makespan"]["ci95"][1] - other["makespan"]["ci95"][0]) ** 2
        ) ** 0.5
        assert high - low <= apart * 1.05


def test_the_same_seed_gives_the_same_document() -> None:
    def timeless(seed: int) -> str:
        found = judge(THESIS, ("fixed", "spt"), ("random:0.5",), 12, seed)
        for one in found[0]["policies"]:
            del one["latency_ms"]
        return json.dumps({**found[0], "seed": 0})

    assert timeless(1) == timeless(1) != timeless(2)


def test_who_gets_fewer_episodes_is_compared_over_these() -> None:
    (document,) = judge(THESIS, ("fixed", "spt"), ("random:0.5",), 400, 0, fewer={"spt": 400 // 4})
    assert (row(document, "fixed")["episodes"], row(document, "spt")["episodes"]) == (400, 100)


def test_scattered_times_have_no_exact_optimum() -> None:
    (document,) = judge(
        THESIS, ("fixed",), ("compliant",), 12, 0, chance=Chance(spread="lognormal", cv=0.3)
    )
    assert document["optimum"] is None
    assert row(document, "fixed")["makespan"]["p5"] < row(document, "fixed")["makespan"]["p95"]


@pytest.mark.parametrize(
    ("given", "found"),
    [
        (("compliant,prefers:3,1",), ("compliant", "prefers:3,1")),
        (
            ("random:0.5+pace:2,utility:stress=1,time=0.5", "adversarial"),
            ("random:0.5+pace:2", "utility:stress=1,time=0.5", "adversarial"),
        ),
        (("population:crew.yaml:train,compliant",), ("population:crew.yaml:train", "compliant")),
    ],
)
def test_commas_within_a_description_stay_in_it(
    given: tuple[str, ...], found: tuple[str, ...]
) -> None:
    assert split_people(given) == found


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"policies": ("fixd", "expectd")}, "'fixd'.*'fixed'.*'expectd'.*'expected'"),
        ({"policies": ("fixed", "fixed")}, "twice"),
        ({"episodes": 1}, "2 at least"),
        ({"people": ()}, "name at least one"),
    ],
)
def test_a_wrong_trial_says_what_is_wrong(change: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        judge(THESIS, **{"policies": ("fixed",), **change})


def test_pictures_are_drawn_of_one_and_of_several(documents: list[dict[str, Any]]) -> None:
    assert len(judged_figure(documents[:1]).axes) == 2
    figure = judged_figure(documents)
    assert figure.axes[0].get_title(loc="left") == "Regret by who works there"
    ax = plot_regret(documents)
    assert [text.get_text() for text in ax.get_xticklabels()] == ["random:0.1", "random:0.5"]
    assert ax.lines[0].get_xdata().tolist() == [0.1, 0.5]  # type: ignore[union-attr]


def test_the_command_prints_one_document_or_a_list(tmp_path: Path, capsys: Capture) -> None:
    chart, file = tmp_path / "chart.svg", tmp_path / "found.json"
    asked = ["simulate", CELL, "--policy", "fixed,spt", "--episodes", "10", "--json", "-q"]
    assert run([*asked, "--people", "random:0.5", "--chart", str(chart), "-o", str(file)]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["people"] == "random:0.5"
    assert json.loads(file.read_text()) == printed
    assert "<svg" in chart.read_text()
    assert run([*asked, "--people", "compliant,random:1"]) == 0
    assert [one["people"] for one in json.loads(capsys.readouterr().out)] == [
        "compliant",
        "random:1",
    ]
    assert run([*asked[:-2], "-q", "--people", "random:1"]) == 0
    assert "exact optimum 25.3333" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["--policy", "fixd"], 2, "Did you mean 'fixed'"),
        (["--policy", "fixed", "--people", "randm:1"], 2, "Did you mean 'random'"),
        (["--policy", "fixed", "--chart", "x.gif"], 2, "ends in .svg"),
        (["--policy", "fixed", "--episodes", "1"], 2, "--episodes"),
        (["--policy", "fixed", "--prior", "one"], 2, "0.6:1"),
        (["--policy", "fixed", "--weights", "0,0"], 2, "more than 0"),
        (["--policy", "learned", "--learned", "none.safetensors"], 3, "none.safetensors"),
        (["--policy", "fixed", "--people", "population:none.yaml"], 3, "none.yaml"),
    ],
)
def test_bad_input_ends_with_one_message_and_its_code(
    arguments: list[str], code: int, said: str, capsys: Capture
) -> None:
    assert run(["simulate", CELL, "-q", *arguments]) == code
    assert said in capsys.readouterr().err


def with_changeovers(**more: Any) -> Cell:
    """Two tasks that need different tools, which exact values cannot hold; with what else stands in
    it.
    """
    return cell_of(
        {
            "name": "Two tools",
            "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tools": {
                "driver": {"changeover": {"human": 2}},
                "wrench": {"changeover": {"human": 2}},
            },
            "tasks": {
                "screw": {"time": {"human": 4, "robot": 9}, "tool": "driver"},
                "bolt": {"time": {"human": 3}, "tool": "wrench"},
            },
            **more,
        }
    )


def written(cell: Cell, folder: Path) -> str:
    (folder / "cell.json").write_text(json.dumps(cell.to_dict()))
    return str(folder / "cell.json")


@pytest.mark.parametrize(
    ("cell", "policy", "reason"),
    [
        (with_changeovers(), "expected", "exact values cannot hold changeovers"),
        (with_changeovers(), "minimax", "exact values cannot hold changeovers"),
        (layered(15, seed=0), "expected", "at most 14 tasks, this one has 15"),
    ],
)
def test_who_cannot_hold_the_cell_is_left_out_and_the_others_are_judged(
    cell: Cell, policy: str, reason: str, tmp_path: Path, capsys: Capture
) -> None:
    """First or last of those named, with one kind of people or two."""
    file = written(cell, tmp_path)
    for names in (f"{policy},spt,lpt", f"spt,lpt,{policy}"):
        assert (
            run(
                [
                    "simulate",
                    file,
                    "--policy",
                    names,
                    "--people",
                    "compliant,random:0.5",
                    "--episodes",
                    "2",
                    "--json",
                    "-q",
                ]
            )
            == 0
        )
        said = capsys.readouterr()
        for document in json.loads(said.out):
            assert [one["policy"] for one in document["policies"]] == ["spt", "lpt"]
            assert document["compared_with"] == "spt"
            assert "difference" in row(document, "lpt")
            [left] = document["left_out"]
            assert left["policy"] == policy
            assert reason in left["reason"]
        assert said.err.count(f"{policy} is left out: ") == 1, (
            "said once, also when nothing else is"
        )


def test_a_policy_file_that_is_not_there_leaves_out_who_wanted_it(
    tmp_path: Path, capsys: Capture
) -> None:
    asked = [
        "--policy",
        "spt,learned",
        "--learned",
        str(tmp_path / "none.policy"),
        "--episodes",
        "2",
        "--json",
        "-q",
    ]
    assert run(["simulate", CELL, *asked]) == 0
    [left] = json.loads(capsys.readouterr().out)["left_out"]
    assert "none.policy" in left["reason"]


def test_who_has_no_plan_that_keeps_the_deadlines_is_left_out() -> None:
    """Each task alone could keep its deadline, both cannot."""
    tasks = {name: {"time": {"human": 5}, "deadline": 6} for name in ("one", "other")}
    cell = with_changeovers(tasks=tasks, tools={})
    (document,) = judge(cell, ("fixed", "spt"), ("compliant",), 2, 0)
    assert [(one["policy"], "no schedule" in one["reason"]) for one in document["left_out"]] == [
        ("fixed", True)
    ]


def test_where_nobody_is_left_all_reasons_are_said_and_the_code_is_the_first_s(
    tmp_path: Path, capsys: Capture
) -> None:
    asked = ["simulate", written(with_changeovers(), tmp_path), "--episodes", "2", "-q", "--policy"]
    lost = ["--learned", str(tmp_path / "lost")]
    assert run([*asked, "expected,learned", *lost]) == 3
    said = capsys.readouterr().err
    assert "- expected: tools: exact values cannot hold changeovers" in said
    assert f"- learned: {tmp_path / 'lost'}" in said
    assert run([*asked, "minimax"]) == 3


def test_the_document_says_what_plan_was_carried_out(
    capsys: Capture, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (document,) = judge(THESIS, ("fixed", "spt"), ("compliant",), 2, 0)
    assert row(document, "fixed")["plan"] == {
        "digest": policy("fixed", THESIS).chosen.schedule.digest,  # type: ignore[attr-defined]
        "makespan": 23,
        "stress": 7,
        "status": "optimal",
        "bound": {"makespan": 23, "stress": 7},
    }
    assert "plan" not in row(document, "spt")
    monkeypatch.setattr("tandem.dispatch.deciders.fixed.PLANNING_WORK", 1e-6)
    file = written(layered(40, seed=1), tmp_path)
    assert run(["simulate", file, "--policy", "fixed", "--episodes", "2", "--json", "-q"]) == 0
    said = capsys.readouterr()
    assert row(json.loads(said.out), "fixed")["plan"]["status"] == "feasible"
    assert "not proven the best" in said.err


def test_the_table_of_deciders_is_listed(capsys: Capture) -> None:
    assert run(["policies", "--json"]) == 0
    assert [one["name"] for one in json.loads(capsys.readouterr().out)["policies"]] == list(
        POLICIES
    )
    assert run(["policies"]) == 0
    assert capsys.readouterr().out.count("\n") == len(POLICIES)


def rows(name: str) -> list[dict[str, str]]:
    with open(RESULTS / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_committed_run_keeps_what_was_promised_of_untold_paces() -> None:
    found = [one for one in rows("pace.csv") if one["policy"] == "replan-robust"]

    def loss(thesis: bool, pace: float) -> float:
        mine = [
            float(one["loss"])
            for one in found
            if (one["cell"] == "thesis") == thesis and float(one["pace"]) == pace
        ]
        return sum(mine) / len(mine)

    assert all(loss(False, pace) < 0.05 for pace in (0.6, 1.5, 2.0))
    assert loss(False, 3.0) < 0.10
    assert all(loss(True, pace) < 0.02 for pace in (1.5, 2.0, 3.0))
    assert loss(True, 0.6) == pytest.approx(0.8 / 15.8, abs=2e-3), (
        "which is what the exact Bayes-adaptive decider loses too"
    )
    document = json.loads((RESULTS / "pace.json").read_text())["thesis"]
    assert document["above_bayes_adaptive"] < 0.01


@pytest.fixture(scope="module")
def deviation() -> Callable[[str, str], list[dict[str, str]]]:
    found = rows("deviation.csv")
    return lambda cell, people: [
        one for one in found if one["cell"] == cell and one["people"] == people
    ]


def test_the_committed_table_has_no_decider_below_the_exact_optimum(
    deviation: Callable[[str, str], list[dict[str, str]]],
) -> None:
    """Its interval may reach below, its mean beyond 3.5 standard errors may not."""
    everything = [one for one in rows("deviation.csv") if one["regret_share"]]
    assert len({one["cell"] for one in everything}) >= 12
    for one in everything:
        half = (float(one["regret_high"]) - float(one["regret_low"])) / 2
        assert float(one["regret_share"]) > -half / 1.96 * 3.5 - 1e-4, one
    for one in deviation("thesis", "random:0.5"):
        assert float(one["optimum"]) == pytest.approx(24.1667, abs=1e-4)
