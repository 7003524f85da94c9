"""What the server answers about plans that are there, against what the package says of the same."""

from __future__ import annotations

import shutil
from pathlib import Path

import jsonschema
import pytest

import tandem
from tandem.draw.lanes import lanes
from tandem.draw.layers import layers
from tandem.explain.waiting import waiting
from tandem.schedule import measures as of
from tandem.schedule.critical import critical_path
from tests.studio.running import Running

THESIS = Path("examples/thesis.yaml")


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    with Running(shutil.copy(THESIS, tmp_path_factory.mktemp("studio") / "cell.yaml")) as running:
        yield running


@pytest.fixture(scope="module")
def front():
    return tandem.plan(tandem.load(THESIS), time_limit=60)


def rows(result):
    return result.schedule.to_list()


def described(server, path, answer):
    """The answer, which is as the OpenAPI document says."""
    told = server.ask("GET", "/api/openapi.json").json
    schema = told["paths"][path]["post"]["responses"]["200"]["content"]["application/json"]
    jsonschema.validate(answer, {**schema["schema"], "components": told["components"]})
    return answer


def test_how_operators_fare_is_what_the_package_measures(server, front):
    body = {"assignments": rows(front[0])}
    told = described(server, "/api/measures", server.ask("POST", "/api/measures", body).json)
    cell, schedule = front.cell, front[0].schedule
    for one in told["operators"]:
        name = one["operator"]
        assert one["working"] == of.working(cell, schedule)[name]
        assert one["idle"] == of.idle(cell, schedule)[name]
        assert one["share"] == of.utilisation(cell, schedule)[name]
        spent = one["working"] + one["changing"] + one["resting"] + one["idle"]
        assert spent == front[0].makespan
    assert told["path"] == [link.assignment.task for link in critical_path(cell, schedule)]
    held = waiting(cell, schedule)
    assert {one["task"]: one["sentence"] for one in told["tasks"]} == {
        task: one.sentence("en") for task, one in held.items()
    }
    assert told["changed"] is None


def test_the_lanes_are_those_of_every_other_chart(server):
    cell = tandem.load(THESIS.with_name("control-box.yaml"))
    found = tandem.plan(cell, method="longest-tail", workers=1)[0].schedule
    body = {"cell": cell.to_dict(), "assignments": found.to_list()}
    told = described(server, "/api/measures", server.ask("POST", "/api/measures", body).json)
    drawn = lanes(cell, found, until=of.makespan(found))
    for one, lane in zip(told["lanes"], drawn, strict=True):
        assert one["operator"] == lane.look.operator
        assert (one["busy"], one["share"]) == (lane.busy, lane.utilisation)
        assert one["shaded"] == [vars(off) for off in lane.shaded]
        waits = [(bar.task, since, bar.start) for bar in lane.bars for since in bar.since]
        assert [(w["task"], w["start"], w["end"]) for w in one["waits"]] == waits
    kinds = {off["kind"] for one in told["lanes"] for off in one["shaded"]}
    assert kinds == {"changeover"}
    assert any(one["waits"] for one in told["lanes"])


def test_of_a_plan_of_other_tasks_there_are_no_lanes(server, front):
    told = server.ask("POST", "/api/measures", {"assignments": rows(front[0])[1:]}).json
    assert described(server, "/api/measures", told)["lanes"] is None


def test_the_graph_is_laid_out_as_in_every_other_picture(server):
    cell = tandem.load(THESIS.with_name("control-box.yaml"))
    body = {"after": [[name, list(task.predecessors)] for name, task in cell.tasks.items()]}
    told = described(server, "/api/graph", server.ask("POST", "/api/graph", body).json)
    drawn = layers(cell)
    assert {one["task"]: tuple(one["at"]) for one in told["at"]} == drawn.at
    assert {(one["after"], one["task"]) for one in told["arrows"]} == set(drawn.arrows)


def test_a_circle_is_opened_where_the_graph_is_drawn(server):
    body = {"after": [["a", ["c", "none"]], ["b", ["a", "b"]], ["c", ["b"]]]}
    told = described(server, "/api/graph", server.ask("POST", "/api/graph", body).json)
    assert {one["task"] for one in told["at"]} == {"a", "b", "c"}
    assert [(one["after"], one["task"]) for one in told["arrows"]] == [("c", "a"), ("a", "b")]
    wrong = server.ask("POST", "/api/graph", {"after": [["a", "b"]]})
    assert (wrong.status, "after is" in wrong.json["error"]) == (400, True)


def test_breaks_are_rest_and_not_idle(server):
    cell = {
        "operators": {"ann": {"kind": "human", "breaks": [[4, 6], [9, 30]]}},
        "tasks": {"1": {"time": {"ann": 4}}, "2": {"time": {"ann": 2}, "after": ["1"]}},
    }
    two = [("1", 0, 4), ("2", 7, 9)]
    body = {
        "cell": cell,
        "assignments": [
            {"task": task, "operators": ["ann"], "start": start, "end": end}
            for task, start, end in two
        ],
    }
    (ann,) = server.ask("POST", "/api/measures", body).json["operators"]
    assert (ann["working"], ann["resting"], ann["idle"]) == (6, 2, 1)


def test_what_differs_from_the_plan_before_is_said_in_both_languages(server, front):
    body = {"assignments": rows(front[1]), "before": rows(front[0])}
    told = server.ask("POST", "/api/measures", body).json["changed"]
    assert told["sentence"] == "2 tasks moved, 1 changed operator, +1 s, stress -4"
    assert told["tasks"] == [{"task": "5", "what": "operator"}, {"task": "7", "what": "start"}]
    german = server.ask("POST", "/api/measures", {**body, "lang": "de"}).json["changed"]
    assert german["sentence"].startswith("2 Vorgänge verschoben, 1 mit anderem Bediener")


def test_of_a_plan_that_breaks_its_cell_nothing_critical_is_claimed(server, front):
    broken = [{**row, "start": 0, "end": row["end"] - row["start"]} for row in rows(front[0])]
    told = server.ask("POST", "/api/measures", {"assignments": broken}).json
    assert described(server, "/api/measures", told)["sound"] is False
    assert (told["operators"], told["tasks"], told["path"]) == (None, None, None)


def test_why_there_is_no_plan_is_said_in_german_too(server):
    body = {"options": {"max_makespan": 22}, "lang": "de"}
    answer = server.ask("POST", "/api/plan", body)
    assert (answer.status, answer.json["exit"]) == (422, 4)
    why = answer.json["infeasible"]
    assert why["reasons"][0] == "Nicht einzuhalten: die Grenze der Dauer (22 s)."
    assert why["reasons"][1].startswith("Geht ohne dies: die Grenze der Dauer (22 s); dann 23 s")
    assert why["together"][0]["words"] == "die Grenze der Dauer (22 s)"


def test_two_cells_are_compared_key_by_key_and_point_by_point(server, front):
    cell = front.cell.to_dict()
    other = {**cell, "tasks": {**cell["tasks"], "5": {**cell["tasks"]["5"], "time": {"human": 2}}}}
    body = {
        "cell": cell,
        "other": other,
        "points": [list(point) for point in front.points],
        "other_points": [[23, 7], [30, 6]],
    }
    told = described(server, "/api/compare", server.ask("POST", "/api/compare", body).json)
    assert [one["path"] for one in told["changes"]] == [["tasks", "5", "time", "robot"]]
    assert [one["seconds"] for one in told["front_changes"]] == [0, None, None]
    wrong = server.ask("POST", "/api/compare", {"cell": cell, "other": {"tasks": {}}})
    assert wrong.status == 422


@pytest.mark.parametrize("share", [0, 0.1, 0.5, 0.85, 1])
def test_a_weighted_point_is_the_one_that_is_planned_with_these_weights(server, front, share):
    points = [list(point) for point in front.points]
    body = {"points": points, "share": share}
    told = described(server, "/api/recommend", server.ask("POST", "/api/recommend", body).json)
    planned = tandem.plan(
        front.cell, minimize="weighted", weights=tuple(told["weights"]), time_limit=60
    )
    assert [list(point) for point in planned.points] == [points[told["point"] - 1]]


def test_limits_move_the_recommended_point(server, front):
    points = [list(point) for point in front.points]

    def asked(**limits):
        return server.ask("POST", "/api/recommend", {"points": points, **limits}).json

    assert asked()["point"] == front.knee_place + 1
    assert asked(max_stress=2)["point"] == 3
    assert asked(max_makespan=23) == {"point": 1, "weights": None, "within": [1]}
    assert asked(max_makespan=20) == {"point": None, "weights": None, "within": []}


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ({"points": []}, "points is empty"),
        ({"points": [[3, 1], [2, 2]]}, "sorted by makespan"),
        ({"points": [[3, 1]], "share": 2}, "from 0 to 1"),
        ({"points": [[3]]}, "a list of [time, stress]"),
        ({}, "points is missing"),
    ],
)
def test_points_that_are_none_are_refused(server, body, says):
    answer = server.ask("POST", "/api/recommend", body)
    assert answer.status == 400
    assert says in answer.json["error"]


def test_of_a_workbook_without_a_table_its_rows_can_be_seen(server):
    book = b"Ding;wer\npress;9\nhold;8\n"
    told = server.ask("POST", "/api/import?name=t.csv", book)
    assert told.status == 422
    assert [one["header"] for one in told.json["seen"]["columns"]] == ["Ding", "wer"]
    assert told.json["seen"]["rows"] == [["press", "9"], ["hold", "8"]]
    mapped = "/api/import?name=t.csv&map=Ding%3Dtask&map=wer%3Dtime%20Anna%20%5Bs%5D"
    asked = server.ask("POST", mapped, book)
    assert asked.status == 422
    assert asked.json["seen"]["operators"] == [{"name": "Anna", "kind": "human"}]
    assert server.ask("POST", mapped + "&human=Anna", book).json["cell"]["tasks"].keys() == {
        "press",
        "hold",
    }
