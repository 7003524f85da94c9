"""A shift is product after product: what begins when, what outlives a product, what blocks a task,
and who stands where.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from tests.dispatch.cells import GEARBOX, in_time, line

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import POLICIES, policy
from tandem.dispatch.journal import Journal, JournalError
from tandem.dispatch.shift.documents import Document, digest
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.shift.schema import decision_schema, event_schema
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.events import Event, read_event
from tandem.dispatch.situation.legal import legal
from tandem.dispatch.situation.model import Product, Situation
from tandem.dispatch.situation.pace import HALF_LIFE, estimate, learnt
from tandem.dispatch.situation.transitions import after, begun
from tandem.errors import UsageError
from tandem.files.load import load
from tandem.files.validate import cell_of
from tandem.world.randomness import Chance

THESIS = load("examples/thesis.yaml")
PRIOR = Options().prior
TWO = cell_of(
    {
        "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}},
        "tasks": {
            "lid": {"time": {"anna": 4}, "stress": 1, "part": "cover"},
            "press": {"time": {"cobot": 6, "anna": 9}, "tool": "press"},
        },
    }
)
"""A variant of the gearbox: the same operators, other tasks, a tool and a part."""


def opened(cell: Cell = GEARBOX, products: int = 1, **more: Any) -> Shift:
    return Shift.open(cell, Journal(), Settings(products=products), decider=in_time(), **more)


def told(shift: Shift, *lines: str) -> list[Document]:
    """All decisions and answers; every event is taken."""
    said = [document for text in lines for document in shift.take(text)]
    assert all(one["accepted"] for one in said if one["type"] == "answer"), said
    return said


def gearbox(at: float, pace: float = 1.0) -> list[str]:
    """One gearbox from its beginning at `at`, anna at this pace; it takes 4 + 5 pace + 4 pace."""
    return [
        line("started", at, task="base", operator="cobot"),
        line("done", at + 4, task="base"),
        line("started", at + 4, task="gear", operator="cobot"),
        line("started", at + 4, task="shaft", operator="anna"),
        line("done", at + 7, task="gear"),
        line("done", round(at + 4 + max(3, 5 * pace), 6), task="shaft"),
        line("started", round(at + 4 + max(3, 5 * pace), 6), task="cover", operator="anna"),
        line("done", round(at + 4 + max(3, 5 * pace) + 4 * pace, 6), task="cover"),
    ]


def test_a_product_that_is_ordered_early_begins_when_the_one_before_is_done() -> None:
    shift = opened()
    early = told(shift, line("product", 1, order="A-2"))[-1]
    assert (early["queued"], early["product"]["number"], early["over"]) == (1, 1, False)
    last = told(shift, *gearbox(1))[-1]
    assert last["product"] == {"number": 2, "order": "A-2", "variant": None, "began": 14.0}
    assert (last["queued"], last["over"], last["at"]) == (0, False, 14.0)
    assert [row["task"] for row in (*last["starts"], *last["asks"])] == ["base"], (
        "the next product is decided upon at once"
    )


def test_after_the_last_task_the_shift_waits_and_says_so() -> None:
    shift = opened()
    waits = told(shift, *gearbox(0))[-1]
    assert waits["over"]
    assert waits["forecast"] is None
    assert waits["why"].endswith("The next one begins with the event `product`.")
    [answer] = shift.take(line("started", 20, task="base", operator="cobot"))
    assert "task 'base' is done since 4 s" in answer["reasons"][0]
    begins = told(shift, line("product", 30, order=7))[-1]
    assert begins["product"] == {"number": 2, "order": "7", "variant": None, "began": 30.0}
    assert begins["asks"] == [{"task": "base", "operators": ["anna"]}]
    assert told(shift, *gearbox(30))[-1]["at"] == 43.0
    assert shift.situation.products_done == 2


def test_before_its_first_order_nothing_is_under_way() -> None:
    shift = opened(products=0)
    assert shift.decision["product"] is None
    assert "No product is under way. The first one begins with" in shift.decision["why"]
    [answer] = shift.take(line("started", 0, task="base", operator="cobot"))
    assert answer["reasons"] == ["no product is under way; order one with `product`."]
    assert told(shift, line("product", 5))[-1]["product"]["number"] == 1
    assert told(shift, *gearbox(5))[-1]["over"]


def test_what_belongs_to_a_product_is_put_away_and_the_rest_stays() -> None:
    shift = opened(products=2)
    told(shift, line("refused", 0, task="base", operator="anna"), *gearbox(0)[:-1])
    told(shift, line("absent", 12, operator="anna"), line("back", 12.5, operator="anna"))
    told(shift, line("failed", 12.5, operator="cobot"), line("done", 13.5, task="cover"))
    there = shift.situation
    assert (there.began, there.now, there.clock) == (13.5, 0.0, 13.5)
    assert (there.done, there.running, there.past, there.since) == ({}, {}, (), {})
    assert there.failed == {"cobot"}
    assert there.refused == {("anna", "base"): None}
    assert there.learnt["anna"].seen == 2


def test_a_refusal_and_a_release_lie_on_the_clock_of_the_shift_and_of_the_product() -> None:
    late = cell_of(
        {
            "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}},
            "tasks": {"x": {"time": {"cobot": 2}, "release": 3}, "y": {"time": {"anna": 1}}},
        }
    )
    shift = opened(late, products=2)
    told(shift, line("refused", 0, task="y", operator="anna", until=7))
    assert shift.decision["look_again"] == 3.0
    told(shift, line("started", 3, task="x", operator="cobot"), line("done", 5, task="x"))
    told(shift, line("started", 5, task="y", operator="anna"), line("done", 6, task="y"))
    assert shift.situation.product == Product(2)
    assert shift.decision["look_again"] == 9.0, "a release counts from the product's beginning"
    told(shift, line("refused", 6, task="y", operator="anna", until=7))
    assert shift.decision["look_again"] == 7.0, "a refusal ends on the shift's clock"
    assert ("y", ("anna",)) not in legal(shift.situation)
    told(shift, line("tick", 7))
    assert ("y", ("anna",)) in legal(shift.situation)


def test_a_variant_has_its_own_tasks_and_its_own_decider() -> None:
    settings = Settings(policy="longest-tail", products=0)
    shift = Shift.open(GEARBOX, Journal(), settings, variants={"two": TWO})
    first = told(shift, line("product", 0, variant="two"), line("product", 0))[-1]
    assert (first["product"]["variant"], first["queued"]) == ("two", 1)
    assert {row["task"] for row in (*first["starts"], *first["asks"])} == {"lid", "press"}
    [answer] = shift.take(line("started", 0, task="base", operator="cobot"))
    assert "the cell has no task 'base'" in answer["reasons"][0]
    told(
        shift,
        line("started", 0, task="lid", operator="anna"),
        line("started", 0, task="press", operator="cobot"),
        line("done", 4, task="lid", id="lid-1"),
        line("done", 6, task="press"),
    )
    assert shift.situation.cell is GEARBOX
    [again] = shift.take(line("done", 4, task="lid", id="lid-1"))
    assert again["duplicate_of"] == 6, "known again although this product has no such task"
    told(shift, *gearbox(6))
    assert replay(GEARBOX, shift.journal).differences == ()
    with pytest.raises(JournalError, match="opened with the variants two, as they were then"):
        Shift.open(GEARBOX, shift.journal, settings, variants={"two": GEARBOX})
    resumed = Shift.open(GEARBOX, shift.journal, settings)
    assert resumed.situation == shift.situation
    assert resumed.situation.cells.keys() == {None, "two"}


def test_a_variant_with_other_operators_is_refused() -> None:
    with pytest.raises(UsageError, match="variant 'seven': its operators are robot"):
        opened(variants={"seven": THESIS})


@pytest.mark.parametrize(
    ("events", "says"),
    [
        ((("broken", {"tool": "pres"}),), "no tool 'pres'. Did you mean 'press'?"),
        ((("missing", {}),), "give either the `part`, or the `task`"),
        ((("missing", {"part": "cover", "task": "lid"}),), "give either the `part`, or the `task`"),
        ((("broken", {"tool": "press"}),) * 2, "tool 'press' was reported as broken already"),
        ((("mended", {"tool": "press"}),), "tool 'press' was not reported as broken."),
        ((("there", {"task": "lid"}),), "what task 'lid' needs was not reported as missing."),
        ((("person", {"operator": "cobot", "person": "x"}),), "'cobot' is a robot"),
        ((("person", {"operator": "anna", "person": "anna"}),), "stands at the place of 'anna'"),
        ((("person", {"operator": "anna"}),), "`person` is missing; it must be a person"),
        ((("end", {}),) * 2, "the end of the shift was reported already."),
        ((("end", {}), ("product", {})), "the shift has ended; no further product begins."),
        ((("product", {"variant": "x"}),), "opened with no variant 'x'. None has a variant."),
        ((("product", {"order": "a\nb"}),), "1 to 200 printable characters"),
        ((("tick", {"order": "a"}),), "tick: has no key 'order'"),
    ],
)
def test_what_cannot_be_is_refused(
    events: tuple[tuple[str, dict[str, str]], ...], says: str
) -> None:
    shift = opened(TWO)
    for number, (kind, keys) in enumerate(events):
        [answer, *_] = shift.take(line(kind, number, **keys))
    assert not answer["accepted"]
    assert says in " ".join(answer["reasons"])


@pytest.mark.parametrize(
    ("gone", "back", "task", "words"),
    [
        (("broken", {"tool": "press"}), "mended", "press", "tool 'press' is broken"),
        (("missing", {"part": "cover"}), "there", "lid", "part 'cover' is missing"),
        (("missing", {"task": "lid"}), "there", "lid", "what task 'lid' needs is missing"),
    ],
)
def test_what_is_broken_or_missing_blocks_its_tasks_over_products(
    gone: tuple[str, dict[str, str]], back: str, task: str, words: str
) -> None:
    shift = opened(TWO)
    other = "lid" if task == "press" else "press"
    who = {"lid": "anna", "press": "cobot"}
    told(shift, line(gone[0], 1, **gone[1]))
    assert {name for name, _ in legal(shift.situation)} == {other}
    [answer, _] = shift.take(line("started", 2, task=task, operator=who[task]))
    assert answer["remarks"] == [f"{words}."], "whoever begins it all the same is believed"
    told(shift, line("failed", 3, task=task), line("started", 3, task=other, operator=who[other]))
    stuck = told(shift, line("done", 4, task=other))[-1]
    assert any(words in reason for reason in stuck["stuck"])
    assert stuck["forecast"]["p50"] > 60, "it is taken to be there again after a minute"
    told(shift, line("product", 5), line(back, 6, **gone[1]))
    assert {name for name, _ in legal(shift.situation)} == {task}


def test_taking_apart_needs_no_part() -> None:
    shift = opened(TWO)
    told(
        shift,
        line("started", 0, task="lid", operator="anna"),
        line("done", 4, task="lid"),
        line("wrong", 4, task="lid"),
        line("missing", 4, part="cover"),
    )
    assert ("lid", ("anna",)) in legal(shift.situation)


@pytest.mark.parametrize("name", POLICIES)
def test_every_decider_leaves_what_is_blocked(name: str) -> None:
    decider = policy(name, TWO, options=Options(budget_ms=10_000))
    for event in (
        Event("broken", 1.0, tool="press"),
        Event("missing", 1.0, part="cover"),
        Event("missing", 1.0, "lid"),
    ):
        there = after(Situation.of(TWO), event)
        blocked = "press" if event.tool else "lid"
        for now in (1.0, 75.0):
            decision = decider.decide(replace(there, now=now))
            begun_now = {task for task, _ in (*decision.starts, *decision.asks)}
            assert begun_now == {"lid", "press"} - {blocked}, decision.why


def test_the_end_of_the_shift_tells_what_is_open() -> None:
    shift = opened(products=2)
    told(shift, *gearbox(0)[:2], line("product", 4, order="A-3"))
    ended = told(shift, line("end", 5))[-1]
    assert ended["open"] == {
        "tasks": ["shaft", "gear", "cover"],
        "products": [{"order": None, "variant": None}, {"order": "A-3", "variant": None}],
    }
    assert ended["asks"] == [{"task": "shaft", "operators": ["anna"]}], (
        "the product under way may be finished"
    )
    rest = [text for text in gearbox(0)[2:] if json.loads(text)["at"] >= 5]
    told(shift, line("started", 5, task="gear", operator="cobot"))
    told(shift, line("started", 5, task="shaft", operator="anna"), *rest)
    assert shift.decision["over"]
    assert shift.decision["open"]["tasks"] == []
    assert shift.decision["why"].endswith("2 products that were ordered have not begun.")
    assert shift.situation.product == Product(1)


def test_what_is_learned_of_a_pace_stays_over_products_and_is_the_journals() -> None:
    shift = opened(products=3)
    told(shift, *gearbox(0, 1.6))
    once = estimate(shift.situation, "anna", PRIOR)
    assert (once.seen, once.mean) == (2, pytest.approx(1.6, rel=0.01))
    told(shift, *gearbox(shift.situation.clock, 1.6))
    assert estimate(shift.situation, "anna", PRIOR).seen == 4
    resumed = Shift.open(GEARBOX, shift.journal, Settings(), decider=in_time())
    assert digest(resumed.situation) == digest(shift.situation)
    assert estimate(resumed.situation, "anna", PRIOR) == estimate(shift.situation, "anna", PRIOR)


def test_what_was_seen_fades_by_half_in_a_half_life_and_the_prior_does_not() -> None:
    there = opened().situation
    for number in range(1, 2 * int(HALF_LIFE) + 1):
        there = after(there, Event("started", there.clock, "base", ("anna",)))
        slow = 9.0 if number <= HALF_LIFE else 6.0
        there = after(there, Event("done", there.clock + slow, "base"))
        there = begun(replace(there, queued=(Product(number + 1),)))
        if number == HALF_LIFE:
            half = learnt(there, "anna")
    whole = learnt(there, "anna")
    # the second half of the tasks tells as much as the first did, which counts half by now
    assert whole.precision == pytest.approx(1.5 * half.precision)
    assert estimate(there, "anna", PRIOR).mean == pytest.approx(1.5 ** (1 / 3), rel=1e-3)
    assert whole.seen == 2 * HALF_LIFE


def test_a_new_person_has_a_pace_of_their_own_and_who_comes_back_is_known() -> None:
    shift = opened(products=4)
    told(shift, line("person", 0, operator="anna", person="Berta"), *gearbox(0, 1.6))
    told(shift, line("person", 20, operator="anna", person="Carla"))
    assert estimate(shift.situation, "anna", PRIOR).seen == 0
    told(shift, *gearbox(20, 0.8)[:5], line("person", 28, operator="anna", person="Berta"))
    assert estimate(shift.situation, "anna", PRIOR).seen == 2
    told(shift, line("done", 28.5, task="shaft"))
    assert estimate(shift.situation, "anna", PRIOR).seen == 2, (
        "what two of them did tells of neither"
    )
    assert estimate(shift.situation, "anna", PRIOR).mean == pytest.approx(1.6, rel=0.01)
    told(shift, line("person", 29, operator="anna", person="anna"))
    assert shift.hello()["persons"] == {"anna": "anna"}
    assert estimate(shift.situation, "anna", PRIOR).seen == 0


def test_lines_and_documents_are_as_the_schemas_say() -> None:
    lines = Path("examples/products.jsonl").read_text().splitlines()
    settings = Settings(policy="longest-tail", products=0)
    shift = Shift.open(THESIS, Journal(), settings)
    said = [shift.hello(), shift.decision, *told(shift, *lines)]
    decisions, events = (
        jsonschema.Draft202012Validator(schema) for schema in (decision_schema(), event_schema())
    )
    for document in said:
        decisions.validate(document)
    for text in lines:
        events.validate(json.loads(text))
        assert read_event(text, THESIS).to_dict() == json.loads(text)
    assert said[-1]["product"]["order"] == "A-18"
    assert said[-1]["open"]["tasks"] == ["2", "3", "4", "5", "6", "7"]


def driven(shift: Shift, floor: SimulatedFloor, most: int = 10_000) -> None:
    for _ in range(most):
        event = floor.next(shift.situation, shift.decision["look_again"])
        if event is None:
            return
        assert shift.take(json.dumps(event.to_dict()))[0]["accepted"]


ROUGH = Chance(spread="lognormal", cv=0.3, failure_s=40, repair_s=6, absence_s=60, away_s=5)


def test_a_simulated_floor_makes_product_after_product_and_is_picked_up() -> None:
    whole, cut = opened(products=4), opened(products=4)
    people = "random:0.3+forgetful:0.2+pace:1.5"
    driven(whole, SimulatedFloor(GEARBOX, people, ROUGH, 1))
    assert whole.situation.products_done == 4
    assert whole.decision["over"]
    driven(cut, SimulatedFloor(GEARBOX, people, ROUGH, 1), most=whole.number // 2)
    assert 1 < cut.situation.products_done + 1 < 4
    floor = SimulatedFloor(GEARBOX, people, ROUGH, 1)
    floor.catch_up(cut.settings.beginning(GEARBOX), cut.journal.entries())
    driven(cut, floor)
    assert cut.situation == whole.situation
    assert replay(GEARBOX, cut.journal, decider=in_time()).differences == ()


def test_a_simulated_floor_makes_variants_by_the_same_person() -> None:
    settings = Settings(policy="longest-tail", products=1)
    shift = Shift.open(GEARBOX, Journal(), settings, variants={"two": TWO})
    told(shift, line("product", 0, variant="two"))
    driven(shift, SimulatedFloor(GEARBOX, "pace:1.6", variants={"two": TWO}))
    assert (shift.situation.cell, shift.situation.products_done) == (TWO, 2)
    assert estimate(shift.situation, "anna", PRIOR).mean == pytest.approx(1.6, rel=0.01)
