"""`tandem reproduce yu2020`: the code of the long run at a size that fits here, and what its stored
result says.
"""

from __future__ import annotations

import json
from functools import partial

import numpy as np
import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

from tests.lab.changed_records import refuses_changed_records

import tandem
from tandem.errors import CellError
from tandem.lab.records import read_record
from tandem.lab.yu2020 import experiment, games, layout, runs
from tandem.lab.yu2020.board import desk, random_board
from tandem.lab.yu2020.pictures import film
from tandem.lab.yu2020.play import follow, play


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("yu")
    return folder, experiment.reproduce(folder, quick=True)


def test_a_quick_run_says_that_it_is_one_and_holds_every_player(quick):
    folder, document = quick
    assert json.loads((folder / "yu2020.json").read_text()) == json.loads(json.dumps(document))
    players = {(row["player"], row["trained_on"]) for row in document["summary"]}
    assert {
        ("longest-tail", None),
        ("random, best of 10", None),
        ("exact, no waiting", None),
        ("exact, with waiting", None),
    } <= players
    assert {
        ("ours, search", "nothing"),
        ("ours, network", "boards"),
        ("ours, search", "boards"),
        ("as described, search", "desk"),
    } <= players
    table = experiment.table(document)
    assert "not public" in table
    assert "quick run" in table


def test_nobody_is_faster_than_the_proven_optimum(quick):
    document = quick[1]
    exact = document["exact"]["test"]["no_waiting"]["makespans"]
    assert exact == [games.optimum(random_board(seed=seed)).makespan for seed in range(1000, 1004)]
    took = [row["boards"] for row in document["plain"]]
    took += [
        makespans
        for record in document["records"]
        for makespans in (record["boards"] or {}).values()
    ]
    assert all((np.array(one) >= exact).all() for one in took)
    assert (
        min(min(row["desk"]) for row in document["summary"])
        == document["exact"]["desk"]["no_waiting"]["makespan"]
        == 94
    )


def test_the_films_replay_to_what_the_records_say(quick):
    document = quick[1]
    for recipe, place in runs.QUICK.trainings:
        (record,) = [
            one
            for one in document["records"]
            if (one["recipe"], one["trained_on"]) == (recipe, place)
        ]
        columns = document["films"][f"{recipe}, search, trained on {place}"]
        assert [play(desk(), follow(columns)).makespan] == record["desk"]["search"]
    assert play(desk(), follow(document["films"]["exact, no waiting"])).makespan == 94


def test_trouble_costs_everyone_and_all_meet_the_same(quick):
    rows = quick[1]["troubles"]
    assert {row["decider"] for row in rows} == {
        "random",
        "longest-tail",
        "ours, network",
        "ours, search",
        "exact, proven anew",
    }
    mean = {
        (row["decider"], row["troubles"]): np.mean(row["rough"]) - np.mean(row["calm"])
        for row in rows
    }
    assert all(mean[decider, "much"] > mean[decider, "some"] > 0 for decider, _ in mean)
    first, again = (games.fates(range(3), games.TROUBLES["much"], 2, seed=1) for _ in range(2))
    assert all((a == b).all() for a, b in zip(first, again, strict=True))
    assert first.repair.shape == (3, 2, *layout(random_board(seed=0)).time.shape)


def test_a_run_that_was_stopped_goes_on_with_the_records_that_are_there(quick, monkeypatch):
    folder, document = quick
    monkeypatch.setattr(
        "tandem.lab.yu2020.board_training.train", lambda *_, **__: pytest.fail("trained again")
    )
    files = list(runs.run_all(folder / "records", range(1), [], runs.QUICK, lambda _: None))
    assert [read_record(file) for file in files] == [
        record for record in document["records"] if record["trained_on"] != "nothing"
    ]


def test_a_changed_record_stops_the_reproduction(quick, tmp_path, capfd):
    refuses_changed_records(["reproduce", "yu2020", "--quick"], quick[0], tmp_path, capfd)


def test_the_figures_are_drawn(quick, tmp_path, monkeypatch):
    # a frame of 53 pieces costs half a second: two a film show as much as twelve
    monkeypatch.setattr("tandem.lab.yu2020.figures.film", partial(film, count=2))
    files = experiment.draw_figures(quick[1], tmp_path)
    films = {
        "film-exact-no-waiting",
        "film-ours-search-trained-on-boards",
        "film-as-described-search-trained-on-desk",
    }
    assert {file.stem for file in files} == {
        "board-desk",
        "board-demonstration",
        "gaps",
        "troubles",
        "learning-curves",
        *films,
    }
    assert all(file.stat().st_size > 2000 for file in files)


def test_no_board_is_both_trained_on_and_played():
    seeds = [*games.FIRST, *games.TEST, *games.HELD, *games.TRAINING]
    assert len(seeds) == len(set(seeds))
    assert min(games.TEST) >= 1000
    assert len(games.TEST) == 100


def test_a_cell_that_is_no_board_is_refused():
    with pytest.raises(CellError, match="knows no stress"):
        experiment.runs_on(tandem.load("examples/thesis.yaml"))
    assert len(experiment.runs_on(desk().to_cell()).pieces) == 53


def test_the_stored_long_run_is_complete_and_shows_what_it_must():
    document = experiment.stored()
    assert not document["quick"]
    assert document["exact"]["test"]["seeds"] == list(range(1000, 1100))
    assert (
        document["exact"]["desk"]["no_waiting"]["makespan"]
        == document["exact"]["desk"]["waiting"]["makespan"]
        == 94
    )
    assert experiment.summary(document) == document["summary"]
    rows = {(row["player"], row["trained_on"]): row for row in document["summary"]}
    ours, tail, luck = (
        rows["ours, search", "boards"],
        rows["longest-tail", None],
        rows["random, best of 100", None],
    )
    assert ours["gap"]["mean"] < luck["gap"]["mean"] < tail["gap"]["mean"]
    assert rows["ours, search", "desk"]["desk"] == [94] * len(document["seeds"])
    assert min(tail["desk"]) == 95
    assert {row["recipe"] for row in experiment.changes(document)} == {
        *runs.OURS,
        "as described",
        *runs.CHANGES,
    }
    assert document["exact"]["first"]["no_waiting"]["makespans"][:3] == [135, 129, 142]
    assert {(record["recipe"], record["trained_on"]) for record in document["records"]} >= set(
        runs.EVERYTHING
    )
    assert document["decisions"]["ours, search"] < 50
