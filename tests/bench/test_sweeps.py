"""`tandem bench`: the same tables however the work is split, stopped and gone on with."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from tandem.bench.jobs import jobs_of
from tandem.bench.spec import Spec, read_spec
from tandem.bench.summary import read_runs, summarised
from tandem.bench.sweep import carry_on
from tandem.bench.written import FORMS, latex, markdown, tables
from tandem.cli.root import run
from tandem.errors import CellError
from tandem.files.generators import layered
from tandem.files.load import dump
from tandem.plan.methods import plan

ROOT = Path(__file__).resolve().parents[2]
THESIS = ROOT / "examples/thesis.yaml"
FIVE = "small/five-1.yaml"
SPEC = """\
format: 1
name: Three methods on five cells
methods: [exact, heft, spt]
cells: [thesis.yaml, small]
seeds: 5
work: 1
optimum_work: 2
"""

INTERRUPTED = """
import os, signal
from tandem.plan.methods import plan as tandem_plan
def plan(cell, question=None, **_):
    '''Answers with what it has when it is stopped, as Tandem's own methods do.'''
    if not os.path.exists('pressed'):
        open('pressed', 'w').close()
        try:
            os.kill(os.getpid(), signal.SIGINT)
            for _ in range(10**6): pass
        except KeyboardInterrupt:
            pass
    return tandem_plan(cell, question, method='spt')
def fails(cell, question=None, **_):
    '''Fails.'''
    raise ValueError('no luck')
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the thesis's cell, a folder of four others, and a sweep of all of them."""
    shutil.copy(THESIS, tmp_path)
    (tmp_path / "small").mkdir()
    for seed in range(4):
        dump(layered(5, seed=seed), tmp_path / "small" / f"five-{seed}.yaml")
    (tmp_path / "sweep.yaml").write_text(SPEC)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def files(folder: str | Path, part: str = "jobs") -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in Path(folder, part).glob("*.json")}


def told(*folders: str | Path) -> str:
    """All that the tables say, the names of the runs aside."""
    document = summarised(read_runs(folders), draws=200)
    return json.dumps({**document, "runs": []})


@pytest.mark.slow
def test_a_sweep_is_the_same_by_processes_in_shards_and_when_it_was_killed(here: Path) -> None:
    """3 methods x 5 cells x 5 seeds; whatever happens on the way, the same files and tables."""
    spec = read_spec("sweep.yaml")
    assert len(spec.cells) == len(spec.seeds) == 5
    assert carry_on(spec, "alone") == []
    expected = files("alone")
    # five optima, and three methods, the best rule and `random` for each cell and seed
    assert len(expected) == len(jobs_of(spec)) == 5 + 5 * 5 * 5

    for part in (1, 2, 3):
        carry_on(spec, f"shard-{part}", shard=(part, 3))
        assert len(files(f"shard-{part}")) < len(expected)
    assert told("shard-1", "shard-2", "shard-3") == told("alone")

    command = [sys.executable, "-m", "tandem", "bench", "sweep.yaml", "-o", "killed", "--jobs", "2"]
    started = subprocess.Popen(command, start_new_session=True, stderr=subprocess.DEVNULL)
    while len(files("killed")) < 5:
        assert started.poll() is None
        time.sleep(0.01)
    started.kill()
    started.wait()
    assert 5 <= len(files("killed")) < len(expected)
    _ended(started.pid)
    before = {path: path.stat().st_mtime_ns for path in Path("killed/jobs").glob("*.json")}
    assert carry_on(spec, "killed", jobs=2) == []
    assert files("killed") == expected
    assert all(path.stat().st_mtime_ns == at for path, at in before.items()), "done twice"
    assert told("killed") == told("alone")


def _ended(group: int) -> None:
    """Waits until nobody of the process group is there: who did jobs ends with the command."""
    for _ in range(600):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    raise AssertionError("processes of a command that was killed go on")


def test_ctrl_c_keeps_what_is_done_and_no_answer_that_was_cut_short(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "stops_once.py").write_text(INTERRUPTED)
    words = ["bench", "--method", "heft,stops_once:plan", "--cell", "thesis.yaml", "-o", "run"]
    words += ["--seeds", "2", "--optimum-work", "1", "-q"]
    assert run(words) == 130
    assert "stopped; 3 of 9 jobs are kept in run. The same command goes on." in (
        capsys.readouterr().err
    )
    assert not any("stops_once" in name for name in files("run"))
    assert run(words) == 0
    assert len(files("run")) == 9
    assert "| stops_once:plan |   2/2 |" in capsys.readouterr().out


def test_a_method_that_fails_is_told_and_the_others_go_on(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "luckless.py").write_text(INTERRUPTED)
    words = ["bench", "--method", "luckless:fails,spt", "--cell", "thesis.yaml", "-o", "run"]
    assert run([*words, "--seeds", "2", "--optimum-work", "1"]) == 2
    printed = capsys.readouterr()
    assert "2 jobs failed, and will be done again by the next call:" in printed.err
    assert printed.err.count("luckless:fails: ValueError: no luck") == 1
    assert "run: 7 of 9 jobs are done" in printed.out


def test_options_say_what_a_file_says(here: Path) -> None:
    options = {"methods": ["exact", "heft", "spt"], "cells": ["thesis.yaml", "small"], "seeds": 5}
    by_options = read_spec(
        name="Three methods on five cells", work=1.0, optimum_work=2.0, **options
    )
    assert by_options == read_spec("sweep.yaml")
    assert read_spec("sweep.yaml", seeds=2).seeds == (0, 1)
    assert read_spec("sweep.yaml", time_limit=3.0).work is None


def test_files_are_looked_for_beside_the_one_that_names_them(
    here: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    assert list(read_spec(here / "sweep.yaml").cells)[:2] == ["thesis", "five-0"]
    with pytest.raises(CellError, match="no such file"):
        read_spec(methods=["spt"], cells=["thesis.yaml"])


def test_a_benchmark_comes_by_its_name(here: Path) -> None:
    assert list(read_spec(methods=["spt"], cells=["ft06", "ta01"]).cells) == ["ft06", "ta01"]


def test_a_bad_sweep_is_told_with_every_fault_at_its_place(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "bad.yaml").write_text(
        "format: 2\n"
        "methods: [exact, bestofn, spt, spt]\n"
        "policies: [fixd]\n"
        "cells: [thesis.yaml, nothere.yaml, ft07, 5]\n"
        "seeds: [0, -1]\n"
        "peple: []\n"
        'people: ["randm:0.5"]\n'
        "weights: [0, 1]\n"
        "work: 5\n"
        "time_limit: 3\n"
        "episodes: 1\n"
        "budget: .inf\n"
    )
    assert run(["bench", "bad.yaml", "-o", "out"]) == 3
    said = capsys.readouterr().err.splitlines()[1:]
    assert not Path("out").exists()
    for place, words in {
        "bad.yaml:1:1": "this version reads format 1",
        "bad.yaml:2:18": "no method 'bestofn'. Did you mean 'best-of-n'?",
        "bad.yaml:2:32": "'spt' is named twice",
        "bad.yaml:3:12": "no policy 'fixd'. Did you mean 'fixed'?",
        "nothere.yaml": "there is no such file",
        "bad.yaml:4:36": "no instance 'ft07'",
        "bad.yaml:4:42": "5 must be text",
        "bad.yaml:5:1": "a list of whole numbers, 0 or more",
        "bad.yaml:6:1": "no key 'peple'. Did you mean 'people'?",
        "bad.yaml:7:10": "'randm:0.5' beside 'thesis'",
        "bad.yaml:8:1": "of a second (above 0",
        "bad.yaml:10:1": "exclude each other",
        "bad.yaml:11:1": "episodes 1: must be a whole number from 2",
        "bad.yaml:12:1": "budget inf: must be a number above 0",
    }.items():
        assert [line for line in said if line.startswith(place) and words in line], (place, said)
    lines = [int(line.split(":")[1]) for line in said if line.startswith("bad.yaml")]
    assert lines == sorted(lines)


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["bench", "--method", "spt", "--cell", "no.yaml", "-o", "x"], 3, "no such file"),
        (["bench", "--method", "spd", "--cell", "thesis.yaml", "-o", "x"], 2, "mean 'spt'?"),
        (["bench", "--method", "spt", "-o", "x"], 2, "--cell: name `cells`"),
        (["bench", "--cell", "thesis.yaml", "-o", "x"], 2, "--method: name `methods`"),
        (["bench", "swep.yaml", "-o", "x"], 3, "Did you mean 'sweep.yaml'?"),
        (["bench", "sweep.yaml", "-o", "small"], 2, "holds no sweep. Name another folder"),
        (["bench", "sweep.yaml", "-o", "x", "--shard", "3/2"], 2, "'3/2' is no part of several"),
        (["bench", "show", "small"], 3, "no folder of a sweep"),
        (["bench", "show", "small", "-o", "table.doc"], 2, "ends in .md, .csv, .tex, .json"),
    ],
)
def test_wrong_usage_is_told(
    words: list[str], code: int, said: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(words) == code
    assert said in capsys.readouterr().err


def small(folder: str, **keys: Any) -> Spec:
    """A sweep of two rules on the thesis's cell, carried out."""
    usual: dict[str, Any] = {"methods": ["heft", "spt"], "cells": ["thesis.yaml"], "seeds": 2}
    spec = read_spec(**{**usual, "optimum_work": 1.0, **keys})
    assert carry_on(spec, folder) == []
    return spec


def test_a_result_that_was_changed_or_damaged_is_refused_with_the_way_out(here: Path) -> None:
    small("run")
    first, second, *_ = sorted(Path("run/jobs").iterdir())
    first.write_text("{")
    second.write_bytes(sorted(Path("run/jobs").iterdir())[2].read_bytes())
    with pytest.raises(CellError) as caught:
        read_runs(["run"])
    assert len(caught.value.faults) == 2
    assert "result of another job. Delete the file: the next call" in str(caught.value)
    first.unlink()
    second.unlink()
    small("run")
    assert read_runs(["run"])[0].records


def test_a_cell_that_was_changed_is_swept_anew(here: Path) -> None:
    small("run")
    text = Path("thesis.yaml").read_text()
    Path("thesis.yaml").write_text(text.replace("time: {robot: 7", "time: {robot: 17"))
    small("run")
    (run_,) = read_runs(["run"])
    assert len(files("run")) == 2 * len(run_.records)


def test_every_row_stands_beside_the_optimum_the_best_rule_and_random(here: Path) -> None:
    spec = small("run", cells=["thesis.yaml", FIVE], methods=["exact", "spt"])
    optimum = plan(spec.cells["five-1"], method="exhaustive", minimize="makespan")[0].makespan
    (part,) = summarised(read_runs(["run"]))["tables"]
    rows = {row["who"]: row for row in part["rows"]}
    assert list(rows) == ["exact", "spt", "best rule", "random"]
    assert [cell["bound"] for cell in part["cells"]] == [23, optimum]
    assert all(cell["proven"] for cell in part["cells"])
    exact = rows["exact"]
    assert (exact["iqm"], exact["gap"], exact["optimal"]) == (1.0, 0.0, 4)
    spt = part["cells"][1]["cost"]["spt"]
    assert rows["spt"]["worst_gap"] == pytest.approx(max(spt / optimum, 24 / 23) - 1, abs=1e-6)
    assert rows["best rule"]["gap"] <= rows["spt"]["gap"]
    assert rows["best rule"]["better_than_rule"] == 0.5
    profile = part["profiles"]["lines"]["spt"]["share"]
    assert profile[-1] == 1
    assert profile == sorted(profile)


def test_stress_can_be_weighed(here: Path) -> None:
    """The thesis's front is (23, 7), (24, 3), (34, 2): at one second for one unit, 24 + 3."""
    small("run", methods=["exact"], weights=[1, 1])
    (part,) = summarised(read_runs(["run"]))["tables"]
    assert part["cells"][0]["bound"] == part["cells"][0]["cost"]["exact"] == 27


def test_a_cell_without_any_schedule_is_told_and_left_out(here: Path) -> None:
    Path("late.yaml").write_text(
        "operators: {anna: {kind: human}}\n"
        "tasks:\n"
        "  press: {time: {anna: 5}, deadline: 6}\n"
        "  glue: {time: {anna: 5}, deadline: 6}\n"
    )
    small("run", cells=["thesis.yaml", "late.yaml"])
    (part,) = summarised(read_runs(["run"]))["tables"]
    (said,) = part["left_out"]
    assert said.startswith("late: no optimum to be held against")
    assert {row["found"] for row in part["rows"]} == {2}
    assert part["cells"][1]["bound"] is None


def test_several_runs_are_compared_on_the_cells_that_all_of_them_have(here: Path) -> None:
    small("monday", cells=["thesis.yaml", FIVE])
    small("tuesday", methods=["spt", "lpt"])
    document = summarised(read_runs(["monday", "tuesday"]))
    (part,) = document["tables"]
    # the same jobs are one row; who is in one run alone needs no run's name
    assert [row["who"] for row in part["rows"]] == ["heft", "spt", "best rule", "random", "lpt"]
    assert [cell["cell"] for cell in part["cells"]] == ["thesis"]
    assert part["left_out"] == ["five-1: not in every run, so it is left out."]
    assert [run_["run"] for run_ in document["runs"]] == ["monday", "tuesday"]
    small("wednesday", methods=["exact"], work=1.0)
    small("thursday", methods=["exact"], work=2.0)
    both = summarised(read_runs(["wednesday", "thursday"]))["tables"][0]["rows"]
    assert [row["who"] for row in both][:1] == ["exact [wednesday]"]
    assert "exact [thursday]" in [row["who"] for row in both]


def test_the_folder_holds_every_form_and_times_apart(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["bench", "--method", "spt,own_method:plan", "--cell", "thesis.yaml", "--seeds", "2"]
    sys.path.append(str(ROOT / "examples/extensions"))
    try:
        assert run([*words, "--optimum-work", "1", "-o", "run", "-q"]) == 0
    finally:
        sys.path.remove(str(ROOT / "examples/extensions"))
    shown = capsys.readouterr().out
    assert Path("run/summary.md").read_text() == shown
    document = json.loads(Path("run/summary.json").read_text())
    assert "wall" not in json.dumps(document)
    rows = list(csv.DictReader(io.StringIO(Path("run/summary.csv").read_text())))
    assert [row["who"] for row in rows] == ["spt", "own_method:plan", "best rule", "random"]
    assert float(rows[0]["iqm"]) == document["tables"][0]["rows"][0]["iqm"]
    results = list(csv.DictReader(io.StringIO(Path("run/results.csv").read_text())))
    assert len(results) == len(files("run")) == len(files("run", "times"))
    assert "cpu_s" in Path("run/times.csv").read_text()
    assert Path("run/summary.svg").read_text().startswith("<?xml")
    assert run(["bench", "show", "run", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == document


DOCUMENT: dict[str, Any] = {
    "name": "5 % & more",
    "runs": [],
    "statistics": {"draws": 10, "seed": 0},
    "tables": [
        {
            "kind": "plan",
            "left_out": [],
            "rows": [
                {
                    "who": r"my_pkg.mod:make{x}~^#$\%&|<>",
                    "found": 1,
                    "jobs": 2,
                    "iqm": 0.5,
                    "iqm_ci95": [0.25, 0.75],
                    "gap": None,
                    "gap_ci95": None,
                    "worst_gap": 0.1,
                    "optimal": 0,
                    "better_than_rule": None,
                    "better_than_rule_ci95": None,
                }
            ],
            "cells": [
                {
                    "cell": "a_b",
                    "bound": 12.345,
                    "proven": False,
                    "cost": {r"my_pkg.mod:make{x}~^#$\%&|<>": None},
                }
            ],
        }
    ],
}
"""With every sign that LaTeX and Markdown read otherwise."""


def test_tables_in_latex_are_well_formed() -> None:
    text = latex(DOCUMENT)
    assert text.count(r"\begin{tabular}") == text.count(r"\end{tabular}") == 2
    bare = re.sub(r"\\[\\&%$#_{}]", "", text.replace(r"\\" + "\n", "\n"))
    assert bare.count("{") == bare.count("}")
    for table, part in zip(tables(DOCUMENT), text.split(r"\end{table}"), strict=False):
        columns = re.search(r"\\begin\{tabular\}\{([lr]+)\}", part)
        assert columns
        assert len(columns[1]) == len(table.heads)
        lines = [line for line in part.splitlines() if line.endswith(r"\\")]
        assert {len(re.findall(r"(?<!\\)&", line)) for line in lines} == {len(table.heads) - 1}
    assert not re.search(r"booktabs|\\toprule", text)


def test_tables_in_latex_compile(tmp_path: Path) -> None:
    if shutil.which("pdflatex") is None:
        pytest.skip("pdflatex is not installed")
    (tmp_path / "tables.tex").write_text(latex(DOCUMENT))
    (tmp_path / "page.tex").write_text(
        "\\documentclass{article}\n\\begin{document}\n\\input{tables.tex}\n\\end{document}\n"
    )
    command = ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "page.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    assert (tmp_path / "page.pdf").stat().st_size > 1000


def test_a_bar_in_a_name_does_not_end_a_column_of_markdown() -> None:
    rows = [line for line in markdown(DOCUMENT).splitlines() if line.startswith("|")]
    assert {len(re.findall(r"(?<!\\)\|", row)) for row in rows[:3]} == {8}
    assert "≥ 12.35" in markdown(DOCUMENT) or "≥ 12.34" in markdown(DOCUMENT)
    assert set(FORMS) == {".md", ".csv", ".tex", ".json"}


def test_the_picture_has_a_row_and_a_line_for_everybody(here: Path) -> None:
    from tandem.draw.sweep import plot_intervals, plot_profiles

    small("run", cells=["thesis.yaml", FIVE])
    (part,) = summarised(read_runs(["run"]))["tables"]
    names = [row["who"] for row in part["rows"]]
    left = plot_intervals(part["rows"])
    assert [label.get_text() for label in left.get_yticklabels()] == names
    marks = [line.get_xdata()[0] for line in left.lines if line.get_marker() != "None"]
    assert marks == [row["iqm"] for row in part["rows"]]
    right = plot_profiles(part["profiles"], names)
    assert [text.get_text() for text in right.get_legend().get_texts()] == names


# ------------------------------------------------------------------ beside people


def test_policies_are_judged_beside_people_and_the_optimum(here: Path) -> None:
    pytest.importorskip("jax", reason="needs tandem[learn]")
    from tandem.dispatch.evaluation.trial import judge

    people = ["compliant", "random:0.5"]
    sweep = {"policies": ["fixed", "spt"], "cells": ["thesis.yaml"], "people": people}
    spec = read_spec(**sweep, seeds=[3, 4], episodes=20)
    assert carry_on(spec, "run") == []
    (part,) = summarised(read_runs(["run"]))["tables"]
    assert [cell["people"] for cell in part["cells"]] == people
    assert [row["who"] for row in part["rows"]] == ["fixed", "spt", "best rule", "random"]
    assert all(row["found"] == 4 for row in part["rows"])
    assert part["cells"][0]["bound"] == 23
    # it is the judge who speaks: the same episodes, the same numbers
    (record,) = [
        record
        for job, record in read_runs(["run"])[0].records.items()
        if (job.who, job.seed, (job.people or ("",))[0]) == ("spt", 4, "random:0.5")
    ]
    (document,) = judge(next(iter(spec.cells.values())), ["spt"], "random:0.5", 20, 4)
    assert record.cost == document["policies"][0]["makespan"]["mean"]
    assert part["cells"][1]["bound"] == pytest.approx(document["optimum"], abs=1e-4)


@pytest.mark.slow
def test_ray_gives_the_same_files(here: Path) -> None:
    pytest.importorskip("ray", reason="needs tandem[ray]")
    spec = read_spec("sweep.yaml")
    assert carry_on(spec, "ray", engine="ray", jobs=2) == []
    assert carry_on(spec, "alone") == []
    assert files("ray") == files("alone")
    assert told("ray") == told("alone")


def test_where_ray_is_missing_it_says_how_to_get_it(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)  # type: ignore[arg-type]  # as Python marks what is not there
    assert run(["bench", "sweep.yaml", "-o", "run", "--engine", "ray", "-q"]) == 2
    assert "pip install 'tandem[ray]'" in capsys.readouterr().err
    assert signal.getsignal(signal.SIGINT) is not signal.SIG_IGN


def test_learned_is_swept_by_name_each_seed_with_the_policy_of_its_training(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("jax", reason="needs tandem[learn]")
    from tests.learn.drawn import run_of

    from tandem.learn.training.evaluate import evaluate

    folder = run_of(here / "trained", (0, 1))
    asked = [
        "--cell",
        "thesis.yaml",
        "--seeds",
        "2",
        "--episodes",
        "2",
        "--optimum-work",
        "1",
        "-q",
    ]
    live = ["bench", "--policy", "learned,spt", *asked]
    assert run([*live, "--learned", "trained", "-o", "live"]) == 0
    assert "learned" in capsys.readouterr().out
    records = [json.loads(text) for text in files("live").values()]
    found = {one["job"]["seed"]: one for one in records if one["job"]["who"] == "learned"}
    for seed in (0, 1):
        line = evaluate(folder, seed=seed, episodes=2).line("greedy")
        assert (found[seed]["makespan"], found[seed]["stress"]) == (line.makespan, line.stress)
    assert found[0]["job"]["learned"] != found[1]["job"]["learned"]
    assert "path" not in found[0]["job"]
    before = files("live")
    assert run([*live, "--learned", "trained", "-o", "live"]) == 0
    assert files("live") == before
    # another training is another job
    run_of(here / "again", (5, 1))
    shutil.copy(here / "again/policy-5.safetensors", here / "trained/policy-0.safetensors")
    assert run([*live, "--learned", "trained", "-o", "live"]) == 0
    assert len(files("live")) == len(before) + 1
    assert files("live").items() > before.items()


def test_what_learned_cannot_play_is_said_at_once(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("jax", reason="needs tandem[learn]")
    from tests.learn.drawn import run_of

    run_of(here / "trained", (0,))
    run_of(here / "other", (0,))
    bench = ["bench", "-o", "live", "-q", "--policy"]
    cells = ["--cell", "thesis.yaml", "--cell", "small"]
    assert run([*bench, "learned", *cells]) == 2
    assert "Name the folders of those runs" in capsys.readouterr().err
    assert run([*bench, "spt", *cells, "--learned", "trained"]) == 2
    assert "Name that policy too" in capsys.readouterr().err
    assert run([*bench, "learned", *cells, "--learned", "trained", "--seeds", "2"]) == 2
    told = capsys.readouterr().err
    assert "has no policy of seed 1" in told
    assert "no trained policy can play 'five-0'" in told
    two = ["--learned", "trained", "--learned", "other", "--seeds", "1"]
    assert run([*bench, "learned", "--cell", "thesis.yaml", *two]) == 2
    assert "were both trained on 'thesis'" in capsys.readouterr().err
    assert run([*bench, "learned", *cells, "--learned", "small"]) == 3
