"""The server of the studio as programs outside rely on it: a real process, asked by its socket."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import jsonschema
import pytest

import tandem
from tandem.files.load import load
from tests.studio.running import Running, until

THESIS = Path("examples/thesis.yaml")
STATIC = Path("src/tandem/studio/static")
LARGE = {
    "operators": {"ann": {"kind": "human"}, "bob": {"kind": "human"}, "cob": {"kind": "robot"}},
    "tasks": {
        f"t{n}": {
            "time": {"ann": 5 + n * 7 % 11, "bob": 4 + n * 5 % 13, "cob": 6 + n * 3 % 17},
            "stress": {"ann": n * 7 % 9, "bob": n * 5 % 8},
            **({"after": [f"t{n - 7}"]} if n > 7 and n % 3 else {}),
        }
        for n in range(1, 81)
    },
}
"""A cell whose front takes far longer to prove than any test waits."""


@pytest.fixture(scope="module")
def cell_file(tmp_path_factory):
    return Path(shutil.copy(THESIS, tmp_path_factory.mktemp("studio") / "thesis.yaml"))


@pytest.fixture(scope="module")
def server(cell_file):
    with Running(cell_file) as running:
        yield running


@pytest.fixture(scope="module")
def plan(server):
    answer = server.ask("POST", "/api/plan", {"options": {"time_limit": 60}})
    assert answer.status == 200
    return answer.json


@pytest.fixture
def own(tmp_path):
    """A server of its own, on a copy that may be changed."""
    file = Path(shutil.copy(THESIS, tmp_path / "cell.yaml"))
    with Running(file) as running:
        running.file = file
        yield running


# --- start and end --------------------------------------------------------------------------------


def test_one_line_is_printed_and_ctrl_c_ends_with_0(own):
    assert own.line.startswith(f"http://127.0.0.1:{own.port}/#token=")
    assert own.ask("GET", "/api/health", token=None).json == {
        "status": "ok",
        "version": tandem.__version__,
    }
    code, out, err = own.end()
    assert (code, out, err) == (0, "", "")


def test_sigterm_is_an_orderly_end_too(own):
    assert own.end(signal.SIGTERM)[0] == 0


@pytest.mark.parametrize(
    ("place", "code", "says"),
    [
        ("nothing-here.yaml", 3, "cannot be read"),
        ("tasks.xlsx", 3, "tandem import"),
    ],
)
def test_what_cannot_be_opened_is_said_at_once(tmp_path, place, code, says):
    (tmp_path / "tasks.xlsx").write_bytes(b"PK\x03\x04")
    done = _tandem("studio", str(tmp_path / place), "--no-browser")
    assert (done.returncode, done.stdout) == (code, "")
    assert says in done.stderr
    assert "Traceback" not in done.stderr


def test_a_port_that_is_in_use_is_refused(server, cell_file):
    done = _tandem("studio", str(cell_file), "--port", str(server.port), "--no-browser")
    assert done.returncode == 2
    assert "in use" in done.stderr


def test_without_the_extra_one_sentence_says_how_to_get_it():
    code = (
        "import sys; sys.modules['starlette'] = None; from tandem.cli import main;"
        " main(['studio', 'examples/thesis.yaml'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert "pip install 'tandem[studio]'" in done.stderr
    assert done.stderr.count("\n") == 1


def test_tandem_alone_loads_no_server():
    code = (
        "import sys, tandem, tandem.cli.root; tandem.load('examples/thesis.yaml');"
        "print([name for name in ('starlette', 'uvicorn', 'anyio') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


# --- the cell -------------------------------------------------------------------------------------


def test_the_cell_is_the_document_that_a_json_file_holds(server, cell_file):
    told = server.ask("GET", "/api/cell", token=None).json
    assert told["cell"] == load(cell_file).to_dict()
    assert (told["name"], told["format"]) == ("thesis.yaml", 1)
    assert int(told["version"], 16)


def test_a_save_changes_the_line_and_keeps_the_comments(own):
    text = own.file.read_text() + "# measured in May\n"
    own.file.write_text(text)
    told = own.ask("GET", "/api/cell").json
    told["cell"]["tasks"]["6"]["time"]["human"] = 4
    saved = own.ask("PUT", "/api/cell", {"cell": told["cell"], "version": told["version"]})
    assert saved.status == 200
    assert saved.json["version"] != told["version"]
    assert own.ask("GET", "/api/cell").json["version"] == saved.json["version"]
    new = own.file.read_text()
    differ = [
        pair for pair in zip(text.splitlines(), new.splitlines(), strict=True) if pair[0] != pair[1]
    ]
    assert len(differ) == 1
    assert load(own.file).tasks["6"].time["human"] == 4


def test_two_tabs_do_not_overwrite_each_other(own):
    first = own.ask("GET", "/api/cell").json
    second = own.ask("GET", "/api/cell").json
    first["cell"]["tasks"]["1"]["stress"] = 1
    second["cell"]["tasks"]["1"]["stress"] = 2
    body = {"cell": first["cell"], "version": first["version"]}
    version = own.ask("PUT", "/api/cell", body).json["version"]
    late = own.ask("PUT", "/api/cell", {"cell": second["cell"], "version": second["version"]})
    assert late.status == 409
    assert late.json["version"] == version
    assert late.json["cell"] == first["cell"]
    assert load(own.file).to_dict() == first["cell"]
    # who has read what is there now may write
    again = {"cell": second["cell"], "version": late.json["version"]}
    assert own.ask("PUT", "/api/cell", again).status == 200


def test_a_file_that_was_changed_outside_is_not_overwritten(own):
    told = own.ask("GET", "/api/cell").json
    own.file.write_text(own.file.read_text().replace("human: 3", "human: 5"))
    late = own.ask("PUT", "/api/cell", {"cell": told["cell"], "version": told["version"]})
    assert late.status == 409
    assert late.json["cell"]["tasks"]["6"]["time"]["human"] == 5


def test_each_fault_of_a_cell_is_at_its_place(server):
    cell = server.ask("GET", "/api/cell").json["cell"]
    assert server.ask("POST", "/api/check", {"cell": cell}).json == {"errors": []}
    cell["tasks"]["3"]["time"]["human"] = -1
    cell["tasks"]["7"]["after"] = ["66"]
    found = {tuple(error["place"]): error for error in _errors(server, cell)}
    assert set(found) == {("tasks", "3", "time", "human"), ("tasks", "7", "after", "0")}
    assert found["tasks", "3", "time", "human"]["value"] == -1
    assert "more than 0 s" in found["tasks", "3", "time", "human"]["message"]
    refused = server.ask("PUT", "/api/cell", {"cell": cell, "version": "0"})
    assert refused.status == 422
    assert refused.json["errors"] == _errors(server, cell)


def _errors(server, cell):
    return server.ask("POST", "/api/check", {"cell": cell}).json["errors"]


def test_a_cell_that_is_not_sound_is_opened_to_be_mended(tmp_path):
    file = tmp_path / "wrong.yaml"
    file.write_text(THESIS.read_text().replace("after: [1, 2]", "after: [1, 22]"))
    with Running(file) as running:
        told = running.ask("GET", "/api/cell").json
        assert told["errors"][0]["place"] == ["tasks", "4", "after", "1"]
        assert told["errors"][0]["where"].startswith("wrong.yaml:")
        cell = told["cell"]
        cell["tasks"]["4"]["after"][1] = "2"
        body = {"cell": cell, "version": told["version"]}
        assert running.ask("PUT", "/api/cell", body).status == 200
        assert load(file) == load(THESIS)


def test_what_was_not_saved_is_kept_at_the_end_and_offered_again(own):
    told = own.ask("GET", "/api/cell").json
    told["cell"]["tasks"]["1"]["stress"] = 99
    own.ask("POST", "/api/draft", {"cell": told["cell"], "version": told["version"]})
    before = own.file.read_bytes()
    code, _, err = own.end()
    assert code == 0
    assert "cell.yaml.draft.json" in err
    assert own.file.read_bytes() == before
    with Running(own.file) as again:
        draft = again.ask("GET", "/api/cell").json["draft"]
        assert draft == {"cell": told["cell"], "version": told["version"]}
        assert again.ask("PUT", "/api/cell", draft).status == 200
        assert "draft" not in again.ask("GET", "/api/cell").json
        assert again.end()[0] == 0
    assert load(own.file).tasks["1"].stress == 99
    assert not own.file.with_name("cell.yaml.draft.json").exists()


def test_an_empty_folder_is_a_place_to_begin(tmp_path):
    with Running(tmp_path) as running:
        assert running.ask("GET", "/api/files").json == {"files": []}
        nothing = running.ask("GET", "/api/cell")
        assert nothing.status == 404
        assert "Import a workbook" in nothing.json["error"]
        cell = load(THESIS).to_dict()
        assert running.ask("PUT", "/api/cell?file=first.yaml", {"cell": cell}).status == 200
        assert running.ask("GET", "/api/cell").json["cell"] == cell


def test_a_folder_lists_its_cells_and_a_new_one_can_be_saved(tmp_path):
    (tmp_path / "line").mkdir()
    shutil.copy(THESIS, tmp_path / "line" / "a.yaml")
    shutil.copy("examples/pump.yaml", tmp_path / "b.yaml")
    (tmp_path / "plan.json").write_text('{"front": []}')
    (tmp_path / ".hidden.yaml").write_text("x")
    with Running(tmp_path) as running:
        listed = running.ask("GET", "/api/files").json["files"]
        assert [file["name"] for file in listed] == ["b.yaml", "line/a.yaml"]
        assert running.ask("GET", "/api/cell").json["name"] == "b.yaml"
        cell = running.ask("GET", "/api/cell?file=line/a.yaml").json["cell"]
        assert cell == load(THESIS).to_dict()
        assert running.ask("PUT", "/api/cell?file=c.json", {"cell": cell}).status == 200
        assert load(tmp_path / "c.json") == load(THESIS)
        # a new file is none that was there
        assert running.ask("PUT", "/api/cell?file=b.yaml", {"cell": cell}).status == 409
        assert running.ask("GET", "/api/cell?file=none.yaml").status == 404


# --- planning -------------------------------------------------------------------------------------


def test_the_plan_is_the_document_of_the_command_line(server, cell_file, plan):
    done = _tandem("plan", str(cell_file), "--json", "-q")
    document = json.loads(done.stdout)
    for told in (plan, document):
        for key in ("wall_s", "source", "confirmation"):
            told.pop(key, None)
    assert plan == document
    assert [(p["makespan"], p["stress"]) for p in plan["front"]] == [(23, 7), (24, 3), (34, 2)]


def test_options_are_those_of_the_command_line(server):
    asked = {"minimize": "makespan", "max_stress": 5, "force": ["6=human"], "time_limit": 60}
    answer = server.ask("POST", "/api/plan", {"options": asked}).json
    assert [(p["makespan"], p["stress"]) for p in answer["front"]] == [(24, 3)]
    weighted = server.ask("POST", "/api/plan", {"options": {"weights": [1, 5]}}).json
    assert weighted["question"]["weights"] == [1, 5]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"time_limt": 3}, "time_limit"),
        ({"time_limit": 0}, "more than 0"),
        ({"time_limit": "soon", "seed": 0.5}, "seed is 0.5"),
        ({"minimize": "cost"}, "worst-stress"),
        ({"minimize": "stress", "weights": [1, 1]}, "exclude each other"),
        ({"method": "os:system"}, "there is no method"),
        ({"weights": [1]}, "two numbers"),
    ],
)
def test_options_that_are_wrong_are_refused_with_the_remedy(server, options, says):
    answer = server.ask("POST", "/api/plan", {"options": options})
    assert answer.status == 400
    assert says in answer.json["error"]


def test_the_risk_of_each_point_is_told_when_it_is_asked(server):
    pytest.importorskip("jax", reason="pip install 'tandem[learn]'")
    answer = server.ask("POST", "/api/plan", {"options": {"cv": 0.2, "robust": True, "work": 1}})
    assert answer.json["recommended_by"] == "p95"
    assert all(point["risk"]["fixed"]["p95"] > point["makespan"] for point in answer.json["front"])


def test_what_cannot_be_is_said_with_the_exit_code_and_the_reasons(server):
    asked = {"options": {"max_makespan": 10, "time_limit": 60}}
    answer = server.ask("POST", "/api/plan", asked)
    assert (answer.status, answer.json["exit"]) == (422, 4)
    assert answer.json["infeasible"]["reasons"]
    events = list(server.stream("max_makespan=10&time_limit=60"))
    assert [event for event, _ in events][-1] == "failed"
    assert events[-1][1]["exit"] == 4
    assert events[-1][1]["infeasible"] == answer.json["infeasible"]
    assert events[-1][1]["message"]


def test_the_stream_tells_points_as_they_are_found_and_ends_with_the_document(server, plan):
    events = list(server.stream("time_limit=60"))
    assert events[0][0] == "started"
    assert events[-1][0] == "done"
    for event, data in events[1:-1]:
        assert event == "progress"
        assert 0 <= data["open"] <= 1
        assert data["front"]
    assert events[-1][1]["front"] == plan["front"]


def test_a_cell_that_is_not_saved_is_planned_as_a_draft(server):
    cell = server.ask("GET", "/api/cell").json["cell"]
    cell["tasks"]["6"]["time"]["human"] = 1
    number = server.ask("POST", "/api/draft", {"cell": cell}).json["draft"]
    document = list(server.stream(f"draft={number}&time_limit=60"))[-1][1]
    assert document["cell_document"] == cell
    assert server.ask("POST", "/api/draft", {"file": "thesis.yaml"}).json == {"draft": None}
    assert server.ask("GET", f"/api/plan/stream?token={server.token}&draft={number}").status == 400


def test_a_long_search_blocks_nothing_and_keeps_what_it_has_when_stopped(own):
    number = own.ask("POST", "/api/draft", {"cell": LARGE}).json["draft"]
    stream = own.stream(f"draft={number}&time_limit=600")
    events = iter(stream)
    kind, started = next(events)
    assert kind == "started"
    event, data = next(events)
    assert (event, bool(data["front"])) == ("progress", True)
    # meanwhile all else answers, a second search included
    assert own.ask("GET", "/api/health").status == 200
    assert own.ask("POST", "/api/plan", {"options": {"time_limit": 60}}).json["complete"]
    assert own.ask("POST", "/api/plan/stop").json == {"stopped": [started["run"]]}
    for event, data in events:
        last = event, data
    assert last[0] == "done"
    assert last[1]["interrupted"] is True
    assert last[1]["front"]
    assert own.ask("POST", "/api/plan/stop").json == {"stopped": []}


def test_a_page_that_is_closed_stops_its_search(own):
    number = own.ask("POST", "/api/draft", {"cell": LARGE}).json["draft"]
    streams = [own.stream(f"draft={number}&time_limit=600") for _ in range(2)]
    for stream in streams:
        assert next(iter(stream))[0] == "started"
        stream.close()
    # both places are free again
    assert own.ask("POST", "/api/plan", {"options": {"time_limit": 60}}).json["complete"]


def test_ctrl_c_during_a_search_keeps_what_was_found(own):
    told = own.ask("GET", "/api/cell").json
    body = {"cell": LARGE, "version": told["version"]}
    assert own.ask("PUT", "/api/cell", body).status == 200
    stream = own.stream("time_limit=600")
    events = iter(stream)
    assert [next(events)[0] for _ in range(2)] == ["started", "progress"]
    code, out, err = own.end()
    assert (code, out) == (0, "")
    assert "cell.interrupted.json" in err
    kept = json.loads(own.file.with_name("cell.interrupted.json").read_text())
    assert kept["interrupted"] is True
    assert kept["front"]


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are looked up in /proc")
def test_a_search_that_is_slow_to_end_is_kept_too(own):
    """As on a busy machine: what searches gets no processor for a while after Ctrl-C."""
    told = own.ask("GET", "/api/cell").json
    body = {"cell": LARGE, "version": told["version"]}
    assert own.ask("PUT", "/api/cell", body).status == 200
    events = iter(own.stream("time_limit=600"))
    assert [next(events)[0] for _ in range(2)] == ["started", "progress"]
    children = _children(own.process.pid)
    for pid in children:
        os.kill(pid, signal.SIGSTOP)
    own.process.send_signal(signal.SIGINT)
    time.sleep(2)
    for pid in children:
        os.kill(pid, signal.SIGCONT)
    _, err = own.process.communicate(timeout=60)
    assert "cell.interrupted.json" in err
    assert json.loads(own.file.with_name("cell.interrupted.json").read_text())["front"]


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are looked up in /proc")
def test_no_search_outlives_a_server_that_was_killed(own):
    number = own.ask("POST", "/api/draft", {"cell": LARGE}).json["draft"]
    events = iter(own.stream(f"draft={number}&time_limit=600"))
    assert [next(events)[0] for _ in range(2)] == ["started", "progress"]
    children = _children(own.process.pid)
    assert children
    own.process.kill()
    own.process.wait()
    until(lambda: not any(_lives(pid) for pid in children), "the search ends with its server")


def _children(parent: int) -> list[int]:
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                rest = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if int(rest[1]) == parent:
                found.append(int(entry.name))
    return found


def _lives(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


# --- questions about a plan -----------------------------------------------------------------------


def test_a_dragged_bar_is_worth_what_the_checker_says(server, cell_file, plan):
    rows = plan["front"][0]["assignments"]
    body = {"assignments": rows, "task": "6", "operators": ["robot"], "start": 18}
    told = server.ask("POST", "/api/place", body).json
    cell = load(cell_file)
    there = tandem.Schedule.from_list(told["assignments"])
    assert (told["allowed"], told["reasons"]) == (True, [])
    assert told["faults"] == tandem.faults(cell, there)
    assert told["makespan"] == 28
    refused = server.ask("POST", "/api/place", {**body, "task": "3"}).json
    assert refused["allowed"] is False
    assert refused["reasons"] == ["task '3': robot cannot do it; human can."]


def test_the_rest_is_solved_again_around_what_is_kept(server, cell_file, plan):
    rows = plan["front"][0]["assignments"]
    body = {
        "assignments": rows,
        "keep": ["1"],
        "place": {"task": "6", "operators": ["robot"], "start": 18},
    }
    told = server.ask("POST", "/api/replan", {**body, "time_limit": 60}).json
    point = told["point"]
    assert tandem.faults(load(cell_file), tandem.Schedule.from_list(point["assignments"])) == []
    now = {row["task"]: row for row in point["assignments"]}
    was = {row["task"]: row for row in rows}
    assert (now["6"]["operators"], now["6"]["start"]) == (["robot"], 18)
    assert now["1"] == was["1"]
    assert [change["task"] for change in point["changed"]] == ["7"]
    assert told["sentence"] == "1 task moved, none changed operator, +7 s, stress -1"
    german = server.ask("POST", "/api/replan", {**body, "time_limit": 60, "lang": "de"}).json
    assert german["sentence"].startswith("1 Vorgang verschoben")
    early = {**body, "place": {"task": "3", "operators": ["robot"], "start": 0}}
    assert server.ask("POST", "/api/replan", early).json["faults"] == [
        "task '3': robot cannot do it; human can."
    ]


def test_why_not_the_robot_is_answered_with_numbers(server, plan):
    body = {"assignments": plan["front"][0]["assignments"], "task": "6", "time_limit": 60}
    told = server.ask("POST", "/api/explain", body).json
    (task,) = told["document"]["tasks"]
    assert task["alternatives"][0]["at_same_stress"]["seconds"] == 7
    assert told["sentences"] == task["sentences"]
    assert "instead robot (10 s): +7 s" in told["sentences"][1]


@pytest.mark.parametrize(
    ("form", "begins"),
    [("html", b"<!DOCTYPE html>"), ("csv", b"point,"), ("xlsx", b"PK"), ("svg", b"<?xml")],
)
def test_a_report_is_made_of_the_plan_that_is_sent(server, plan, form, begins):
    answer = server.ask("POST", "/api/report", {"plan": plan, "point": 2, "form": form})
    assert answer.status == 200
    assert answer.body.startswith(begins)
    assert answer.headers["content-disposition"] == f'attachment; filename="plan.{form}"'


def test_the_first_page_names_all_that_it_needs_and_each_of_it_is_asked_for_once(server):
    first = server.ask("GET", "/")
    assert first.headers["cache-control"] == "no-cache"
    named = set(re.findall(r'(?:href|src)="(/static/[^"]+)"', first.body.decode()))
    files = {path.rpartition("/")[2] for path in named}
    assert {path.name for path in STATIC.rglob("*.js")} < files
    assert {"studio.css", "words_en.json", "words_de.json"} < files
    (version,) = {path.split("/")[2] for path in named}
    for path in named:
        answer = server.ask("GET", path)
        assert answer.status == 200
        assert "immutable" in answer.headers["cache-control"]
        other = server.ask("GET", path.replace(version, "0" * len(version)))
        assert (other.status, "cache-control" in other.headers) == (404, False)


@pytest.mark.parametrize(
    ("chart", "says"),
    [("front", "Belastung"), ("gantt", "task 6 human"), ("graph", "7 Vorgänge; längste Kette")],
)
def test_a_chart_alone_is_a_picture_in_the_language_of_the_page(server, plan, chart, says):
    body = {"plan": plan, "point": 1, "form": "svg", "chart": chart, "lang": "de"}
    answer = server.ask("POST", "/api/report", body)
    assert answer.status == 200
    assert says in answer.body.decode()
    assert f'filename="{chart}.svg"' in answer.headers["content-disposition"]
    none = server.ask("POST", "/api/report", {**body, "form": "csv"})
    assert (none.status, "a picture's name ends in" in none.json["error"]) == (400, True)


def test_a_plan_that_breaks_its_cell_is_no_report(server, plan):
    wrong = json.loads(json.dumps(plan))
    wrong["front"][0]["assignments"][0]["start"] += 1
    answer = server.ask("POST", "/api/report", {"plan": wrong, "form": "csv"})
    assert (answer.status, answer.json["exit"]) == (422, 6)
    assert answer.json["faults"]
    assert "/tmp" not in answer.body.decode()


def test_a_workbook_is_read_with_what_was_understood(server, tmp_path):
    book = tmp_path / "tasks.xlsx"
    _tandem("template", "-o", str(book))
    answer = server.ask("POST", "/api/import?name=tasks.xlsx", book.read_bytes())
    assert answer.status == 200
    told = answer.json
    assert tandem.Cell.model_validate(told["cell"]).tasks.keys() == load(THESIS).tasks.keys()
    meanings = {column["header"]: column["meaning"] for column in told["columns"]}
    assert meanings["time robot [s]"] == "time of robot, s"
    mapped = server.ask(
        "POST", "/api/import?name=tasks.xlsx&map=stress%3Dignore", book.read_bytes()
    ).json
    assert all("stress" not in task for task in mapped["cell"]["tasks"].values())
    csv = b"task,time Anna [s],after\n1,5,\n2,x,1\n"
    wrong = server.ask("POST", "/api/import?name=t.csv&human=Anna", csv)
    assert wrong.status == 422
    assert any("C3" in error["where"] or "B3" in error["where"] for error in wrong.json["errors"])


# --- the page and the package ---------------------------------------------------------------------


def test_the_page_loads_only_what_the_package_holds(server):
    page = server.ask("GET", "/", token=None)
    assert page.headers["content-type"].startswith("text/html")
    named = re.findall(r'(?:src|href)="([^"]+)"', page.body.decode())
    assert named
    for name in named:
        assert not name.startswith(("http:", "https:", "//"))
        if not name.startswith("data:"):
            assert server.ask("GET", "/" + name.removeprefix("/"), token=None).status == 200


def test_the_wheel_holds_every_file_of_the_page(tmp_path):
    pytest.importorskip("hatchling", reason="pip install hatchling")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, check=True, capture_output=True, timeout=120)
    (wheel,) = tmp_path.glob("*.whl")
    files = {path.relative_to("src").as_posix() for path in STATIC.rglob("*") if path.is_file()}
    assert "tandem/studio/static/index.html" in files
    assert files <= set(zipfile.ZipFile(wheel).namelist())


def test_every_address_stands_on_the_page_of_the_studio():
    text = Path("docs/studio.md").read_text(encoding="utf-8")
    from tandem.studio.routes import ROUTES

    assert [route.path for route in ROUTES if f"`{route.method} {route.path}" not in text] == []


# --- the OpenAPI document -------------------------------------------------------------------------


def test_the_openapi_document_says_what_every_route_answers(server, plan, tmp_path):
    """Walks the document: each operation is asked rightly, and each with something wrong; what is
    answered has the shape that is stated for its status.
    """
    document = server.ask("GET", "/api/openapi.json").json
    book = tmp_path / "tasks.xlsx"
    _tandem("template", "-o", str(book))
    cell = server.ask("GET", "/api/cell").json
    rows = plan["front"][0]["assignments"]
    place = {"task": "6", "operators": ["robot"], "start": 18}
    right = {
        ("put", "/api/cell"): {"cell": cell["cell"], "version": cell["version"]},
        ("post", "/api/check"): {"cell": {"tasks": {}}},
        ("post", "/api/draft"): {"cell": cell["cell"]},
        ("post", "/api/plan"): {"options": {"time_limit": 60}},
        ("post", "/api/plan/stop"): {},
        ("post", "/api/place"): {"assignments": rows, **place},
        ("post", "/api/replan"): {"assignments": rows, "place": place, "time_limit": 60},
        ("post", "/api/measures"): {"assignments": rows, "before": rows},
        ("post", "/api/compare"): {"other": load(THESIS).to_dict()},
        ("post", "/api/graph"): {"after": [["1", []], ["2", ["1"]]]},
        ("post", "/api/recommend"): {"points": [[23, 7], [24, 3]], "share": 0.5},
        ("post", "/api/explain"): {"assignments": rows, "task": "6"},
        ("post", "/api/report"): {"plan": plan, "form": "csv"},
        ("post", "/api/import"): book.read_bytes(),
    }
    walked = 0
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            body = right.get((method, path))
            if isinstance(body, dict):
                content = operation["requestBody"]["content"]["application/json"]
                _valid(body, content["schema"], document)
            token = f"?token={server.token}" if path.endswith("stream") else ""
            answer = server.ask(method.upper(), path + token, body)
            assert answer.status == 200, (method, path, answer.body[:300])
            _fits(answer, operation, document)
            if method != "get":
                assert operation["security"] == [{"token": []}]
                _fits(server.ask(method.upper(), path, body, token=None), operation, document)
                _fits(server.ask(method.upper(), path, b"[1"), operation, document)
                _fits(server.ask(method.upper(), path, {"none": 1}), operation, document)
            walked += 1
    from tandem.studio.routes import ROUTES

    assert walked == len(ROUTES)


def _fits(answer, operation, document) -> None:
    told = operation["responses"].get(str(answer.status))
    assert told, (answer.status, answer.body[:300], list(operation["responses"]))
    (kind,) = told["content"]
    if kind == "application/json":
        assert answer.headers["content-type"] == "application/json"
        _valid(answer.json, told["content"][kind]["schema"], document)


def _valid(value, schema, document) -> None:
    jsonschema.validate(value, {**schema, "components": document["components"]})


def _tandem(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "tandem", *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, "NO_COLOR": "1"},
        timeout=120,
    )
