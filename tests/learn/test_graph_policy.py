"""The policy for any cell: what it sees, what it is, how it learns, and what comes of it."""

from __future__ import annotations

import json
from dataclasses import replace
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.strategies import cells

import tandem
from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.learn.graph.candidates import ABOUT, GROUPS, Making, Sight, columns, sight
from tandem.learn.graph.drawing import Drawing, Known
from tandem.learn.graph.labels import (
    Decided,
    Looks,
    cost,
    drawn_exchange,
    label,
    layout_of,
    read,
    searched,
    told,
    written,
)
from tandem.learn.graph.making import Maker, retold
from tandem.learn.graph.network import ahead, crowd, fresh, lasting, nodes, scores
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.training_cells import FIRST_SEED, training_cell
from tandem.learn.graph.weights import SHIPPED, packed, shipped, unpacked, write_weights
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.schedule.checker import faults

EXAMPLES = sorted(Path("examples").glob("*.yaml"))


def drawn_weights(seed: int = 0) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    return fresh(lambda shape: rng.uniform(-1, 1, shape).astype(np.float32))


def outlook(cell: Cell, exchange: float = 0.5) -> Outlook:
    return Outlook.of(layout_of(cell), exchange)


# --- what it sees ---------------------------------------------------------------------------------


def turned(cell: Cell, seed: int) -> Cell:
    """The same cell, its tasks and operators in another order."""
    data, rng = cell.to_dict(), np.random.default_rng(seed)
    for key in ("operators", "tasks"):
        names = list(data[key])
        data[key] = {names[at]: data[key][names[at]] for at in rng.permutation(len(names))}
    return cell_of(data)


@pytest.mark.parametrize("seed", range(6))
def test_the_network_is_equivariant(seed: int) -> None:
    """Tasks and operators in another order: what they are found to be, in that order."""
    weights, seen = drawn_weights(seed), outlook(training_cell(seed, 20))
    rng = np.random.default_rng(seed)
    tasks, people = rng.permutation(len(seen.tasks)), rng.permutation(len(seen.operators))
    task, operator = nodes(np, weights, seen.tasks, seen.operators, seen.pairs, seen.before)
    pairs, before = seen.pairs[tasks][:, people], seen.before[tasks][:, tasks]
    turned_task, turned_operator = nodes(
        np, weights, seen.tasks[tasks], seen.operators[people], pairs, before
    )
    np.testing.assert_allclose(turned_task, task[tasks], atol=1e-4)
    np.testing.assert_allclose(turned_operator, operator[people], atol=1e-4)


@pytest.mark.parametrize("seed", range(6))
def test_the_order_in_a_cell_changes_nothing_of_what_is_seen(seed: int) -> None:
    """Two operators: the prices of more are searched, and ties in that search follow the order."""
    cell = layered(14, seed=seed)
    seen, other = outlook(cell), outlook(turned(cell, seed))
    names, theirs = seen.layout.instance, other.layout.instance
    tasks = [theirs.tasks.index(name) for name in names.tasks]
    people = [theirs.operators.index(name) for name in names.operators]
    np.testing.assert_allclose(other.tasks[tasks], seen.tasks, atol=1e-5)
    np.testing.assert_allclose(other.operators[people], seen.operators, atol=1e-5)
    np.testing.assert_allclose(other.pairs[tasks][:, people], seen.pairs, atol=1e-5)
    np.testing.assert_allclose(other.before[tasks][:, tasks], seen.before)


@pytest.mark.parametrize("times", [10, 1000])
def test_the_unit_of_time_changes_nothing(times: int) -> None:
    cell = layered(12, seed=3)
    data = cell.to_dict()
    for task in data["tasks"].values():
        task["time"] = {name: seconds * times for name, seconds in task["time"].items()}
    maker = Maker.of(drawn_weights(), outlook(cell, 0.0))
    slow = Maker.of(drawn_weights(), outlook(cell_of(data), 0.0))
    mine, theirs = maker.build(), slow.build()
    assert mine is not None
    assert theirs is not None
    assert theirs.makespan == mine.makespan * times
    assert theirs.way == mine.way


def test_features_are_bounded_numbers_to_the_end() -> None:
    making = Making.of(outlook(training_cell(2, 25)))
    while making.left:
        choices = making.choices()
        seen = sight(making, choices)
        for array in (seen.features, seen.about):
            assert np.isfinite(array).all()
            assert np.abs(array).max() <= 8
        making.put(int(choices.rows[-1]), int(choices.starts[-1]))


@pytest.mark.parametrize("number", range(8))
def test_prices_bound_every_schedule(number: int) -> None:
    """Makespan and stress of any schedule come to no less than the cheapest work at the prices."""
    seen = outlook(training_cell(number, 12))
    assert seen.price.sum() == pytest.approx(1)
    for seed in range(3):
        state = Maker.of(drawn_weights(seed), seen).build()
        assert state is not None
        assert cost(state, seen.exchange) >= seen.cheapest.sum() - 1e-6


# --- what it is -----------------------------------------------------------------------------------


def test_jax_and_numpy_see_the_same() -> None:
    jnp = pytest.importorskip("jax.numpy", reason="training needs the extra tandem[learn]")
    weights, seen = drawn_weights(1), outlook(training_cell(5, 20))
    making = Making.of(seen)
    choices = making.choices()
    now, table, found = sight(making, choices), seen.steps, []
    for xp in (np, jnp):
        task, operator = nodes(xp, weights, seen.tasks, seen.operators, seen.pairs, seen.before)
        steps = lasting(xp, weights, task[table.task], seen.share @ operator, table.fixed)
        of_pairs, own, share = ahead(xp, weights, task, operator, seen.pairs)
        stand = (own + of_pairs.mean(0))[None]
        rows = steps[choices.rows] + crowd(xp, weights, stand, now.about, share[None])
        found.append(np.asarray(scores(xp, weights, now.features, rows)))
    np.testing.assert_allclose(found[0], found[1], atol=1e-4)


def test_a_batch_is_judged_as_its_cells_are() -> None:
    """Padding changes nothing, and what was kept of a decision is all that the network sees."""
    pytest.importorskip("jax", reason="training needs the extra tandem[learn]")
    from tandem.learn.graph.pool import DECISIONS, SIZES, Seen, batch
    from tandem.learn.graph.training import likely

    weights, pool = drawn_weights(2), [list[Seen]() for _ in SIZES]
    for number in range(12):
        look = outlook(training_cell(number, 30), 0.3)
        maker, making, found = Maker.of(weights, look), Making.of(look), list[Decided]()
        while making.left:
            choices = making.choices()
            if len(choices.rows) > 1:
                rounded = (array.astype(np.float16) for array in sight(making, choices)[:2])
                seen = Sight(*(array.astype(np.float32) for array in rounded), choices, choices)
                likes = maker.judged(making, seen, choices)
                chances = likes - np.log(np.exp(likes).sum())
                found.append(Decided(seen, choices.rows, chances, making.unplaced > 0))
            making.put(int(choices.rows[0]), int(choices.starts[0]))
        one = Seen.of(told(number, 30, 0.3, found), look)
        pool[one.size].append(one)
    for seed in range(4):
        drawn = batch(pool, np.random.default_rng(seed), 3)
        count = 3 * DECISIONS
        real = drawn["decision"] < count
        chances = np.asarray(likely(packed(weights), drawn, count))
        np.testing.assert_allclose(chances[real], drawn["loss"][real], atol=1e-3)


def test_the_shipped_weights_are_small_and_those_of_this_network() -> None:
    weights = packed(shipped())
    like = packed(drawn_weights())
    assert {name: part.shape for name, part in weights.items()} == {
        name: part.shape for name, part in like.items()
    }
    assert sum(part.size for part in weights.values()) <= 200_000
    file = Path(tandem.learn.__file__ or "").parent / "graph" / SHIPPED
    assert file.stat().st_size < 2**20


def test_weights_are_read_as_they_were_written(tmp_path: Path) -> None:
    weights = drawn_weights(4)
    write_weights(tmp_path / "w.npz", weights)
    with np.load(tmp_path / "w.npz", allow_pickle=False) as file:
        again = unpacked({name: file[name] for name in file.files})
    assert json.dumps(sorted(packed(again))) == json.dumps(sorted(packed(weights)))
    for name, part in packed(weights).items():
        np.testing.assert_array_equal(packed(again)[name], part)


# --- what comes of it -----------------------------------------------------------------------------


@settings(max_examples=40, deadline=None)
@given(cells(), st.integers(0, 1000))
def test_whatever_it_makes_keeps_the_cell(cell: Cell, seed: int) -> None:
    layout = Layout.of(Instance.of(cell))
    if layout.impossible() or layout.instance.has_most_lags:
        return
    maker = Maker.of(drawn_weights(seed), Outlook.of(layout, 0.3))
    for random in (None, np.random.default_rng(seed)):
        state = maker.build(random)
        if state is None:
            continue
        schedule = layout.instance.schedule(state.starts())
        wrong = [fault for fault in faults(cell, schedule) if "deadline" not in fault]
        assert wrong == []


@settings(max_examples=60, deadline=None)
@given(cells(), st.integers(0, 1000), st.sampled_from([0.0, 0.3, 20.0]))
def test_no_schedule_is_below_the_bounds_of_its_choices(
    cell: Cell, seed: int, exchange: float
) -> None:
    layout = Layout.of(Instance.of(cell))
    if layout.impossible() or layout.instance.stress_of_set is not None:
        return
    seen, random = Outlook.of(layout, exchange), np.random.default_rng(seed)
    maker, making = Maker.of(drawn_weights(seed), seen), Making.of(seen)
    units, told = sum(layout.easiest), list[tuple[float, float, float]]()
    while making.left:
        choices = making.choices()
        if not len(choices.rows):
            return
        found, at = sight(making, choices), maker.chosen(making, choices, random, 5.0)
        row = choices.rows[at]
        worth = found.worth[at] * seen.scale + exchange * units
        units += seen.harder[row]
        told.append((found.makespan[at] * seen.scale, units, worth))
        making.put(int(row), int(choices.starts[at]))
    makespan, stress = making.state.makespan, making.state.stress
    assert units == stress
    for ticks, least, worth in told:
        assert ticks <= makespan + 0.01
        assert least <= stress
        assert worth <= (makespan + exchange * stress) * (1 + 1e-6) + 0.01


@pytest.mark.parametrize("seed", range(4))
def test_drawn_to_the_end_it_is_the_optimum(seed: int) -> None:
    """Nothing is given up that could be better, and what is exhausted ends the drawing."""
    layout = layout_of(cell := layered(7, 1 + seed % 2, 1, seed=seed))
    drawing = Drawing.of(Maker.of(drawn_weights(seed), Outlook.of(layout, 0.0)), random_of(seed))
    made = [state.makespan for state in drawing.drawn(100_000)]
    assert made == sorted(set(made), reverse=True)
    best = tandem.plan(cell, minimize="makespan")[0].makespan
    assert layout.instance.seconds(made[-1]) == best


@pytest.mark.parametrize("seed", range(3))
def test_a_front_that_is_drawn_to_the_end_is_the_exact_one(seed: int) -> None:
    layout = layout_of(cell := layered(6, 1, 1, seed=seed))
    maker = Maker.of(drawn_weights(seed), Outlook.of(layout, 0.5))
    drawing = Drawing(maker, random_of(seed), 2.0, Known(whole=True))
    starts = [tuple(state.starts()) for state in drawing.drawn(100_000)]
    assert len(set(starts)) == len(starts)
    instance = layout.instance
    found = {(instance.seconds(t), instance.stress(u)) for t, u in drawing.known.points}
    assert found == set(tandem.plan(cell).points)


def test_the_greedy_schedule_is_not_drawn_again() -> None:
    layout = layout_of(layered(5, 1, 1, seed=2))
    maker = Maker.of(drawn_weights(), Outlook.of(layout, 0.0))
    drawing = Drawing(maker, random_of(0), 3.0, Known(whole=True))
    greedy, chance = drawing.greedy()
    assert greedy is not None
    assert greedy.starts() == maker.build().starts()
    assert 0 < chance <= 1
    assert all(state.starts() != greedy.starts() for state in drawing.drawn(10_000))


def random_of(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize("number", range(6))
def test_a_schedule_is_retold_to_its_end(number: int) -> None:
    """Each decision has its choice among those that are looked at, and what comes of it is no
    longer.
    """
    seen = outlook(training_cell(number, 12))
    starts = searched(seen.layout, seen.exchange, 20_000, 0)
    told = []
    for making, choices, which in retold(seen, starts):
        assert set(which) <= set(range(len(choices.rows)))
        assert which
        told.append(making)
    assert len(told) == len(seen.tasks)
    making = told[-1]  # the same one all along
    ends = [
        start + seen.layout.instance.ways[task][way].ticks
        for task, (way, start) in enumerate(starts)
    ]
    assert making.left == 0
    assert making.state.makespan <= max(ends)


def test_exact_losses_lead_to_the_optimum() -> None:
    """Whoever always takes a choice that loses nothing ends where another exact method ends."""
    from tandem.learn.graph.optimum import Search

    for number in range(8):
        cell = training_cell(number, 9)
        layout = layout_of(cell)
        exchange, instance = drawn_exchange(number, layout), layout.instance
        weights = (1.0, exchange * instance.per_stress / instance.per_second)
        seen = Outlook.of(layout, exchange)
        search, making, lost = Search(seen), Making.of(seen), list[float]()
        while making.left:
            choices = making.choices()
            losses = search.losses(making, choices.rows, choices.starts, np.inf, 1_000_000)
            assert losses is not None
            at = int(losses.argmin())
            lost.append(losses[at])
            making.put(int(choices.rows[at]), int(choices.starts[at]))
        (found,) = plan(cell, Question("weighted", weights), method="exhaustive")
        best = found.makespan * instance.per_second + exchange * found.stress * instance.per_stress
        assert cost(making.state, exchange) == pytest.approx(best)
        assert lost == [0.0] * len(seen.tasks)


def test_search_sees_what_choices_lose_where_it_can_be_proven() -> None:
    """Nothing is thought to be better than it is, the best choice is known, and others nearly."""
    from tandem.learn.graph.near_optimum import NearSearch
    from tandem.learn.graph.optimum import Search

    off, missed = list[float](), list[bool]()
    for number in range(6):
        layout = layout_of(training_cell(number, 12))
        seen = Outlook.of(layout, drawn_exchange(number, layout))
        near = NearSearch(seen, searched(layout, seen.exchange, 2000, number), number)
        search, making = Search(seen), Making.of(seen)
        while making.left:
            choices = making.choices()
            exact = search.losses(making, choices.rows, choices.starts, np.inf, 1_000_000)
            assert exact is not None
            near.improve(making, 1000)
            found = near.losses(making, choices.rows, choices.starts, 200)
            missed.append(exact[int(found.argmin())] > 1e-6)
            off += np.abs(
                np.minimum(found / seen.scale, 1) - np.minimum(exact / seen.scale, 1)
            ).tolist()
            # on the way also what loses a little
            at = int(exact.argsort()[min(1, len(exact) - 1)])
            making.put(int(choices.rows[at]), int(choices.starts[at]))
    assert np.mean(missed) <= 0.05
    assert np.mean(off) < 0.02
    assert np.quantile(off, 0.95) < 0.05


def test_a_policy_can_be_taught_by_its_own_best_schedules() -> None:
    weights = drawn_weights(3)
    told = label(weights, 2, 12, Looks(own=4))
    assert told is not None
    ends = np.cumsum(told[0].sizes)
    for begin, end in zip([0, *ends[:-1]], ends, strict=True):
        assert set(told[0].losses[begin:end].tolist()) <= {0.0, 1.0}
        assert 0.0 in told[0].losses[begin:end]


def test_one_right_choice_is_one_alone() -> None:
    jnp = pytest.importorskip("jax.numpy", reason="training needs the extra tandem[learn]")
    from tandem.learn.graph.training import wanted

    losses = jnp.array([0.3, 0.0, 0.0, 0.0, 1.0, 0.0])
    decision = jnp.array([0, 0, 0, 1, 1, 2])
    assert wanted(losses, decision, 2, -1.0).tolist() == [0, 1, 0, 1, 0, 1]
    soft = wanted(losses, decision, 2, 0.1)
    np.testing.assert_allclose(soft[1:3], 1 / (2 + np.exp(-3)), rtol=1e-5)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_no_answer_is_worse_than_the_best_rule(path: Path) -> None:
    from tandem.learn.baseline import best_rule

    cell = tandem.load(path)
    question = Question(minimize="makespan")
    rule = best_rule(cell, lambda makespan, stress: makespan, question=question)
    (found,) = tandem.plan(cell, question, method="learned")
    assert rule is not None
    assert found.makespan <= rule.result.makespan
    assert faults(cell, found.schedule) == []


def test_the_front_of_the_thesis_is_met() -> None:
    front = tandem.plan(tandem.load("examples/thesis.yaml"), method="learned")
    assert front.points == [(23, 7), (24, 3), (34, 2)]
    assert not front.complete
    assert front.method == "learned"


def test_it_repeats_for_a_seed_and_keeps_limits() -> None:
    cell = layered(15, seed=8)
    one, two = (tandem.plan(cell, method="learned", seed=5) for _ in range(2))
    assert one.points == two.points
    assert [a.schedule.digest for a in one] == [b.schedule.digest for b in two]
    most = sorted(stress for _, stress in one.points)[0]
    limited = tandem.plan(cell, Question(max_stress=most), method="learned")
    assert all(stress <= most for _, stress in limited.points)


def test_so_many_schedules_are_drawn_as_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    from tandem.errors import UsageError

    made = list[PartialSchedule | None]()
    looked = list[int]()
    make, look = Drawing._made, Drawing._seen
    monkeypatch.setattr(Drawing, "_made", lambda *given: (made.append(make(*given)), made[-1])[1])
    monkeypatch.setattr(Drawing, "_seen", lambda *given: (looked.append(1), look(*given))[1])
    cell, question = layered(12, seed=1), Question(minimize="makespan")
    tandem.plan(cell, question, method="learned", samples=5)
    assert 1 <= sum(state is not None for state in made) <= 5
    assert 12 < len(looked) <= 6 * 12
    with pytest.raises(UsageError, match=r"samples 5: method 'spt' draws no schedules.*learned"):
        tandem.plan(cell, question, method="spt", samples=5)
    with pytest.raises(UsageError, match=r"samples 0: must be 1 or more"):
        tandem.plan(cell, question, method="learned", samples=0)


# --- how it learns --------------------------------------------------------------------------------


def test_the_cells_that_are_trained_on_are_drawn_apart_from_those_of_tests() -> None:
    """By seeds, and by what they are."""
    from benchmarks.graph_policy import unseen_cells

    tested = {json.dumps(cell.to_dict()["tasks"]) for _, cell in unseen_cells([10], 2, 30)}
    trained = {json.dumps(training_cell(number, 10).to_dict()["tasks"]) for number in range(200)}
    assert len(tested) == 30
    assert not tested & trained
    assert FIRST_SEED > 100_000
    assert training_cell(3, 20) == training_cell(3, 20)


def test_both_kinds_of_weight_are_drawn() -> None:
    layout = layout_of(training_cell(0, 10))
    drawn = [drawn_exchange(number, layout) for number in range(60)]
    assert 10 < sum(not one for one in drawn) < 40
    assert len({one for one in drawn if one}) > 5


def test_labels_are_read_as_they_were_written() -> None:
    told = [label(None, number, 8, Looks()) for number in range(4)]
    labels = [one[0] for one in told if one is not None]
    for one, again in zip(labels, read(written(labels)), strict=True):
        for field in ("number", "exchange", "sizes", "seen", "rows", "losses"):
            np.testing.assert_array_equal(getattr(one, field), getattr(again, field))


def test_a_short_training_learns_and_goes_on_to_the_bit(tmp_path: Path) -> None:
    pytest.importorskip("jax", reason="training needs the extra tandem[learn]")
    from tandem.errors import UsageError
    from tandem.learn.graph.training import Config, Told, train

    config = Config(
        first=22, first_large=2, small=8, first_steps=60, rounds=2, drawn=3, drawn_large=1,
        most_tasks=12, looks=Looks(known=100, each=20), steps=10, batch=8,
    )  # fmt: skip
    told: list[Told] = []
    whole = train(config, tmp_path / "whole", told.append)
    assert [one.round for one in told] == [0, 1, 2]
    assert told[-1].labels == 32

    class Stopped(Exception):
        pass

    def stop(one: Told) -> None:
        if one.round == 1:
            raise Stopped

    with pytest.raises(Stopped):
        train(config, tmp_path / "parts", stop)
    # the rest by two processes
    again = train(config, tmp_path / "parts", told.append, workers=2)
    for name, part in packed(whole).items():
        np.testing.assert_array_equal(packed(again)[name], part)
    with pytest.raises(UsageError, match="another configuration"):
        train(replace(config, seed=1), tmp_path / "parts", told.append)
    # better than weights that prefer nothing, on the cells that were imitated
    gaps = {"fresh": 0.0, "trained": 0.0}
    for number in range(24):
        layout = layout_of(training_cell(number, 8))
        seen = Outlook.of(layout, drawn_exchange(number, layout))
        for name, weights in (("fresh", drawn_weights()), ("trained", whole)):
            state = Maker.of(weights, seen).build()
            assert state is not None
            gaps[name] += cost(state, seen.exchange) / seen.scale
    assert gaps["trained"] < gaps["fresh"]


def test_what_is_left_out_is_never_seen(tmp_path: Path) -> None:
    pytest.importorskip("jax", reason="training needs the extra tandem[learn]")
    from tandem.learn.graph.training import Config, train

    blind = columns(GROUPS["bounds"])
    # the bounds beside the best choice's, two of them as shares of what is left, and the best
    assert blind == (5, 6, 7, 8, 16, 17, 23, 24, 25, 26)
    config = Config(
        first=6, first_large=0, small=8, first_steps=5, rounds=0, batch=4, blind=blind,
        looks=Looks(known=50, each=10),
    )  # fmt: skip
    weights = train(config, tmp_path, lambda told: None)["choice"]["0"]["weight"]
    seen = [row for row in range(len(weights)) if row not in blind]
    assert not np.abs(weights[list(blind)]).any()
    assert np.abs(weights[seen]).any(1).all()
    weights = train(replace(config, blind=(), crowd=False), tmp_path / "alone", lambda told: None)
    assert not weights["operators"]["0"]["weight"][:ABOUT].any()
    assert not any(part.any() for part in weights["ahead"]["1"].values())


def test_each_ablation_leaves_out_one_thing_and_labels_as_many_cells() -> None:
    pytest.importorskip("jax", reason="training needs the extra tandem[learn]")
    from benchmarks.graph_training import BY_PPO, ablations

    configs = {one.name: one.config for one in ablations()}
    whole = configs.pop("nothing")
    assert configs.pop("ppo") == BY_PPO  # it looks nothing up
    cells = whole.first + whole.first_large + whole.rounds * (whole.drawn + whole.drawn_large)
    for config in configs.values():
        drawn = config.rounds * (config.drawn + config.drawn_large)
        assert config.first + config.first_large + drawn == cells
        assert config.first_steps + config.rounds * config.steps == 1400
        assert config != whole
    assert len(set(configs.values())) == len(configs) == 8


def test_the_page_tells_the_numbers_that_are_kept() -> None:
    kept = json.loads(Path("benchmarks/results/graph_policy.json").read_text())
    page = Path("docs/one-policy.md").read_text()
    names = {
        "cells": "{tasks} tasks",
        "cells of 50": "{tasks} tasks",
        "three operators": "{tasks} tasks, three operators",
        "four operators": "{tasks} tasks, four operators",
        "rich": "{tasks} tasks, joint ways, tools, a zone",
        "large": "{tasks} tasks, best of 16",
        "public": "{set}",
        "case studies": "{set}",
        "boards": "{set}",
    }
    for key, name in names.items():
        for row in kept[key]["rows"]:
            most = f"best of {kept[key]['samples']}"
            told = [f"{row[of]['gap']:g}" for of in ("greedy", most, "best-of-n")]
            begin = f"| {name.format(**row)} |"
            (line,) = (line for line in page.splitlines() if line.startswith(begin))
            assert all(f" {number} " in line for number in told), line
    desk = kept["boards"]["rows"][0]["desk"]
    assert f"the desk {desk['greedy']:g} s and {desk['best of 64']:g} s" in page
    front = kept["fronts"]
    assert f"all points of {front['all points']:g} %" in page
    assert f"hypervolume {front['hypervolume']:.1f} %" in page
    left_out = json.loads(Path("benchmarks/results/graph_ablations.json").read_text())
    for row in left_out["rows"]:
        gaps = [f"{row[of]['gap']:g} ± {row[of]['half']:g}" for of in ("greedy", "best of 16")]
        assert f"| {row['without']} | {' | '.join(gaps)} | {row['cpu_s']:g} s |" in page


@pytest.mark.parametrize(
    "of",
    ["first_incumbent", "first_incumbent_clock", "first_incumbent_crews", "first_incumbent_fronts"],
)
def test_the_page_tells_what_the_exact_planner_gains(of: str) -> None:
    from benchmarks.first_incumbent import tables

    kept = json.loads(Path(f"benchmarks/results/{of}.json").read_text())
    weights = files("tandem.learn.graph").joinpath(SHIPPED).read_bytes()
    assert kept["weights"] == sha256(weights).hexdigest()[:12]
    assert "\n".join(tables(kept)) in Path("docs/one-policy.md").read_text()
