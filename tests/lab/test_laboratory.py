"""The table of systems, what each can do as found by probes, and the page that compares them."""

from __future__ import annotations

import html
import inspect
import json
from dataclasses import replace
from types import SimpleNamespace

import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

from tandem.cli.root import run
from tandem.errors import CellError, Fault
from tandem.lab import comparison, probes
from tandem.lab.antonelli2021 import experiment as antonelli2021
from tandem.lab.antonelli2021 import qlearning
from tandem.lab.kinat2023 import experiment as thesis
from tandem.lab.systems import SYSTEMS, Features, Played, System, system

PUBLISHED = [name for name, known in SYSTEMS.items() if known.published]


def refuses(cell, *_):
    raise CellError([Fault("this system knows no such thing.", ("tasks",))])


def able(**changes):
    """A system that can do everything, with some handles otherwise; `cost` minds all that a cell
    has.
    """

    def cost(cell):
        found = 0.0
        for name, task in cell.tasks.items():
            found += (
                min(mode.time for mode in cell.modes(name))
                + sum(task.difficulty.values())
                + (task.stress if isinstance(task.stress, float) else 0)
            )
            found += cell.tools[task.tool].changeover["robot"] if task.tool else 0
            found += 4 if name == "right" and task.after else 0  # waits for the other
        return found

    done = Played(7.0, (0.5,), deviations=1, undone=2)
    handles = Features(
        trains=lambda: qlearning.train,
        agents=lambda: ["robot", "human"],
        cost=cost,
        play=lambda cell, seed: done,
        carry=lambda trained_on, played_on, seed: done,
        deviate=lambda cell, seed: done,
        mistake=lambda cell, seed: done,
        exact=lambda document: [23.0],
    )
    return SimpleNamespace(
        FEATURES=replace(handles, **changes), runs_on=changes.get("cost", lambda cell: cell)
    )


def value(name, system, document=None):
    return probes.PROBES[name](system, {} if document is None else document).value


def test_a_system_that_can_do_everything_is_said_to():
    found = {name: entry.value for name, entry in probes.features(able(), {}).items()}
    assert found == {
        "objectives": "time, stress, difficulty",
        "agents": "2: robot, human",
        "algorithm": "tabular Q-learning",
        "cooperation or collaboration": "cooperation and collaboration",
        "disassembly": "yes",
        "tools": "yes",
        "human deviation": "yes",
        "real time": "yes: 0.5 ms",
        "generalises": "yes",
        "exact optimum known": "yes",
    }


@pytest.mark.parametrize(
    ("feature", "change", "entry"),
    [
        (
            "objectives",
            {
                "cost": lambda cell: sum(
                    min(m.time for m in cell.modes(name)) for name in cell.tasks
                )
            },
            "time",
        ),
        ("objectives", {"cost": lambda cell: 1.0}, "none"),
        ("agents", {"agents": lambda: ["robot"]}, "1: robot"),
        ("algorithm", {"trains": thesis.FEATURES.trains}, "PPO"),
        (
            "cooperation or collaboration",
            {"cost": lambda cell: 5.0, "play": lambda cell, seed: Played(11.0)},
            "collaboration",
        ),
        (
            "cooperation or collaboration",
            {"cost": lambda cell: 5.0, "play": lambda cell, seed: Played(None)},
            "collaboration",
        ),
        (
            "cooperation or collaboration",
            {"cost": lambda cell: refuses(cell) if cell.tasks["top"].together else 5.0},
            "cooperation",
        ),
        ("disassembly", {"mistake": None}, "no"),
        ("disassembly", {"mistake": lambda cell, seed: Played(7.0, undone=0)}, "no"),
        ("disassembly", {"mistake": lambda cell, seed: Played(None, undone=3)}, "no"),
        ("disassembly", {"mistake": refuses}, "no"),
        ("tools", {"cost": lambda cell: 5.0}, "not minded"),
        ("tools", {"cost": refuses}, "no"),
        ("human deviation", {"deviate": None}, "no"),
        ("human deviation", {"deviate": lambda cell, seed: Played(7.0, deviations=0)}, "no"),
        ("human deviation", {"deviate": lambda cell, seed: Played(None, deviations=4)}, "no"),
        ("real time", {"play": lambda cell, seed: Played(7.0)}, "no"),
        (
            "real time",
            {"play": lambda cell, seed: Played(7.0, (2000.0, 3000.0, 1500.0))},
            "no: 2e+03 ms",
        ),
        ("generalises", {"carry": None}, "no"),
        ("generalises", {"carry": refuses}, "no"),
        ("generalises", {"carry": lambda one, other, seed: Played(None)}, "no"),
        (
            "generalises",
            {
                "carry": lambda one, other, seed: Played(
                    7.0 if len(one.tasks) == len(other.tasks) else None
                )
            },
            "same size only",
        ),
        ("exact optimum known", {"exact": None}, "no"),
        ("exact optimum known", {"exact": lambda document: []}, "no"),
    ],
)
def test_an_entry_changes_when_the_code_cannot_do_it(feature, change, entry):
    assert value(feature, able()) != entry
    assert value(feature, able(**change)) == entry


def test_without_a_result_the_exact_values_are_not_claimed():
    assert probes.exact_known(able(), None).value == "not run"


def test_a_refusal_is_told_in_the_systems_own_words():
    entry = probes.tools(able(cost=refuses), {})
    assert entry.how == "refused: this system knows no such thing"


def test_antonelli_and_the_thesis_are_found_to_be_what_their_papers_say():
    """Without training: the probes that need none."""
    assert value("objectives", antonelli2021) == "time"
    assert value("objectives", thesis) == "time, stress"
    assert value("agents", thesis).startswith("2: ")
    assert value("algorithm", antonelli2021) == "tabular Q-learning"
    assert value("cooperation or collaboration", thesis) == "cooperation"
    assert value("tools", antonelli2021) == value("tools", thesis) == "no"
    assert value("disassembly", thesis) == "no"
    assert value("exact optimum known", thesis, thesis.stored()) == "yes"


def test_antonelli_takes_apart_and_copes_with_a_human_who_slips_one_operation_at_a_time():
    assert value("disassembly", antonelli2021) == "yes"
    assert value("human deviation", antonelli2021) == "yes"
    assert value("real time", antonelli2021).startswith("yes")
    assert value("cooperation or collaboration", antonelli2021) == "collaboration"
    assert value("generalises", antonelli2021) == "no"


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_system_offers_what_the_laboratory_asks(name):
    experiment = SYSTEMS[name].load()
    parameters = inspect.signature(experiment.reproduce).parameters
    assert {"folder", "quick", "seeds", "tell"} <= set(parameters)
    assert ("cases" in parameters) == SYSTEMS[name].takes_cases
    assert all(
        callable(getattr(experiment, offered)) for offered in ("stored", "table", "draw_figures")
    )
    if SYSTEMS[name].published:
        assert isinstance(experiment.FEATURES, Features)
        assert callable(experiment.FEATURES.trains())


@pytest.mark.parametrize("name", PUBLISHED)
def test_every_system_runs_on_a_cell_that_is_not_its_own_or_says_what_it_cannot_express(name):
    """The base of the probes is nobody's own cell and anybody's kind; everything else may be
    refused, but with reasons.
    """
    experiment = SYSTEMS[name].load()
    experiment.runs_on(probes.base())
    for entry in probes.other_cells(experiment, comparison.cells_to_try()).values():
        assert entry.value == "yes" or len(entry.how) > 20


def test_an_unknown_system_is_met_with_the_nearest_one(capsys):
    assert run(["reproduce", "antoneli2021"]) == 2
    assert "Did you mean 'antonelli2021'?" in capsys.readouterr().err
    assert run(["reproduce"]) == 2
    assert "or --all" in capsys.readouterr().err
    assert run(["reproduce", "thesis", "--case", "x.json"]) == 2
    assert "only `tandem reproduce cells` takes case studies" in capsys.readouterr().err
    assert system("thesis").load() is thesis


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The page of two systems: one with its stored result, one whose result is missing."""
    folder = tmp_path_factory.mktemp("all")
    lost = SimpleNamespace(
        FEATURES=able().FEATURES, runs_on=lambda cell: cell, stored=lambda: refuses(None)
    )
    systems = {
        "thesis": Quick("Kinat 2023: PPO", "tandem.lab.kinat2023.experiment"),
        "lost": Made("Nobody 2020: lost", "none", experiment=lost),
    }
    file, document = comparison.compare(folder, stored=True, systems=systems)
    return file.read_text(encoding="utf-8"), document


class Made(System):
    """A system whose module is made by a test."""

    def __init__(self, title, module, *, experiment):
        super().__init__(title, module)
        object.__setattr__(self, "experiment", experiment)

    def load(self):
        return self.experiment


class Quick(System):
    """The thesis without the trainings of its probes."""

    def load(self):
        whole = super().load()
        handles = replace(whole.FEATURES, play=lambda cell, seed: Played(7.0, (0.1,)), carry=None)
        return SimpleNamespace(
            **{
                name: getattr(whole, name)
                for name in ("stored", "table", "draw_figures", "runs_on")
            },
            FEATURES=handles,
        )


def test_the_page_holds_the_matrix_the_tables_and_the_figures(page):
    text, document = page
    shown = text.replace("<wbr>", "")  # where a long word may break
    assert [feature for feature in probes.PROBES if f">{html.escape(feature)}<" not in shown] == []
    assert "time, stress" in text
    assert "return-optimal (DP)" in text  # the thesis's own table
    assert text.count("<figure>") == len(thesis_figures := sorted(thesis_names())), thesis_figures
    assert "this system knows no such thing" in text  # why there is no result of the other
    assert document["features"]["lost"]["exact optimum known"]["value"] == "not run"
    assert document["systems"]["lost"] is None
    json.dumps(document)


def thesis_names():
    from tandem.lab.kinat2023.figures import figures

    return [name for name, _ in figures(thesis.stored())]


def test_the_page_loads_nothing_from_elsewhere(page):
    text = page[0]
    assert "default-src 'none'" in text
    assert "<script" not in text
    assert not [word for word in ('src="http', 'href="http', "url(http") if word in text]
