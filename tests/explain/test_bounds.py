"""The chain of proofs: sums that can be checked by hand, and who took over."""

from __future__ import annotations

import json

import pytest
from tests.schedule.cells import thesis

from tandem.cli.root import run
from tandem.explain.bounds import ProofChain, Reckoned
from tandem.files.validate import cell_of
from tandem.plan.methods import METHODS, plan

THESIS = "examples/thesis.yaml"


def test_the_thesis_in_words() -> None:
    """Task 1 takes 9 s at best, then 4 in 2 s, 6 in 3 s and 7 in 2 s: 16 s."""
    said = ProofChain.of(plan(thesis(), workers=1)).sentences()
    assert said[1].strip() == (
        "critical path: at least 16 s, because tasks 1, 4, 6 and 7 must follow one another"
        " (9 + 2 + 3 + 2 s in the quickest ways)"
    )
    assert "  least stress: at least 2, every task done by whoever it strains least" in said
    assert said[said.index("point 3: 34 s, stress 2") + 2] == (
        "  no gentler in so little time: 2 by least stress; so this is proven"
    )
    assert said[-1].endswith("32 partial schedules: there is none.")


def test_releases_and_waits_stand_in_the_chain() -> None:
    cell = cell_of(
        {
            "operators": {"arm": {"kind": "robot"}},
            "tasks": {
                "glue": {"time": {"arm": 4}, "release": 10},
                "press": {"time": {"arm": 6}, "wait": [{"after": "glue", "at_least": 30}]},
            },
        }
    )
    found = Reckoned.of(cell)
    assert (found.chain, found.begin, found.chain_s) == ({"glue": 4, "press": 6}, 10, 50)
    front = plan(cell, workers=1)
    assert front[0].makespan == 50
    said = ProofChain.of(front).sentences()
    assert "(4 + 6 s in the quickest ways from 10 s on, and 30 s of waits between them)" in said[1]


def test_what_is_open_is_said_to_be_open() -> None:
    said = ProofChain.of(METHODS["longest-tail"](thesis())).sentences()
    assert any("was found, the rest is open" in line for line in said)
    assert said[-1] == "Not everything is proven, so there is nothing to confirm."


def test_the_command_prints_the_chain_and_the_document_holds_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(["plan", THESIS, "--explain-bound", "--no-risk", "-q", "--lang", "de"]) == 0
    assert "Punkt 3: 34 s, Belastung 2" in capsys.readouterr().out
    assert run(["plan", THESIS, "--explain-bound", "--no-risk", "-q", "--json"]) == 0
    bounds = json.loads(capsys.readouterr().out)["bounds"]
    assert bounds["reckoned"]["critical path"]["makespan"] == 16
    assert bounds["points"][2]["stress"] == [{"by": "least stress", "value": 2}]
    assert bounds["points"][2]["makespan"][-1] == {
        "by": "cp-sat, confirmed by dynamic programming",
        "value": 34,
    }


def test_cycles_have_no_such_chain(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", THESIS, "--explain-bound", "--cycle"]) == 2
    assert "--explain-bound: asks about one product alone" in capsys.readouterr().err


def test_the_report_says_who_proved() -> None:
    from tandem.report.language import words
    from tandem.report.tables import status

    front = plan(thesis(), workers=1)
    assert [status(result, words("en")) for result in front][1:] == [
        "proven by CP-SAT, confirmed by dynamic programming",
        "makespan proven by CP-SAT, confirmed by dynamic programming, stress by least stress",
    ]
