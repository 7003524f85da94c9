"""Searches find what can be worked out by hand, with a network that knows nothing and with one that
is wrong; theirs with its quirk.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from tests.learn import tiny
from tests.learn.turns import Blind, Told, Trap, Way

import tandem
from tandem.errors import UsageError
from tandem.lab.yu2020.config import YuConfig, YuSearch
from tandem.lab.yu2020.network import YuNetworks
from tandem.lab.yu2020.search import backed_up
from tandem.learn.alphazero.config import Config, EpsilonGreedy, Search
from tandem.learn.alphazero.network import Scorer
from tandem.learn.alphazero.rollout import play
from tandem.learn.alphazero.selfplay import find, play_games
from tandem.learn.alphazero.trained import Trained
from tandem.learn.cell_env import CellGame
from tandem.learn.env import many
from tandem.learn.observation import MOVE_FEATURES, WHOLE_FEATURES, Observation

SURE = {
    "gumbel": Search(simulations=16, gumbel_scale=0.0),
    # 32 leave both moves with as many visits
    "puct": Search("puct", simulations=64, noise=0.0, temperature=0.0),
}


@pytest.fixture(scope="module")
def trap():
    """Two games of `Trap`, at the start and after going left."""
    games = many(Trap.of(), 2)
    return games, Way(jnp.array([0, 1]), jnp.array([-1, 0]))


@pytest.mark.parametrize("kind", SURE)
def test_a_search_sees_through_the_trap(trap, kind):
    """Right although left costs less now, for both agents pay the same; the mask holds although
    move 2 would be free.
    """
    games, states = trap
    found = jax.jit(lambda key: find(key, Blind(3), {}, games, states, SURE[kind]))(
        jax.random.key(0)
    )
    assert found.move.tolist() == [1, 0]
    assert (found.policy[:, 2] == 0).all()
    np.testing.assert_allclose(found.policy.sum(1), 1, atol=1e-5)


def test_their_search_falls_for_its_own_quirk(trap):
    """The robot's Q leaves out the time of the move itself, and of what the other does before its
    next turn: both moves look as good (0), and the leftmost is taken. Without the quirk right is
    seen to cost least, given that the human then plays what its network likes.
    """
    games, states = trap
    knows = {
        "logits": jnp.zeros((3, 3)).at[1, 0].set(5.0).at[2, 0].set(5.0),
        "to_come": jnp.zeros(3),
    }

    def asked(quirk, key=0):
        config = YuSearch(simulations=12, depth=2, exploration=0.1, quirk=quirk)
        return jax.jit(lambda key: find(key, Told(), knows, games, states, config))(
            jax.random.key(key)
        )

    with_quirk, without = asked(True), asked(False)
    assert with_quirk.move[0] == 0
    assert with_quirk.to_come[0] == 0
    assert without.move[0] == 1
    np.testing.assert_allclose(without.to_come, [3, 5])


def test_a_path_is_backed_up_by_the_least_and_with_the_quirk_without_its_own_time():
    cost, visits, times = (
        jnp.array([9.0, 0.0, 1.0]),
        jnp.array([3.0, 0.0, 2.0]),
        jnp.array([4.0, 3.0, 2.0]),
    )
    np.testing.assert_allclose(
        backed_up(cost, visits, times, jnp.float32(5.0), quirk=False), [9, 10, 1]
    )
    np.testing.assert_allclose(backed_up(cost, visits, times, jnp.float32(5.0)), [9, 7, 1])
    np.testing.assert_allclose(backed_up(cost, visits * 0, times, jnp.float32(5.0)), [10, 7, 5])


def test_a_temperature_of_1000_draws_almost_evenly_among_what_was_looked_at():
    wide = many(Trap.of(), 512)
    states = Way(jnp.zeros(512, jnp.int32), jnp.full(512, -1))
    drawn = jax.jit(
        lambda key: find(key, Told(), Told().start(0), wide, states, YuSearch(12, 2, 0.1, 1000.0))
    )(jax.random.key(0))
    assert 200 < int((drawn.move == 1).sum()) < 312
    assert (drawn.move < 2).all()
    np.testing.assert_allclose(drawn.policy[:, :2], 0.5, atol=0.01)


@pytest.fixture(scope="module")
def untrained():
    network = Scorer(8)
    return Trained(network, network.start(jax.random.key(0)))


def test_an_untrained_search_finds_the_optimum_of_a_small_cell(untrained):
    """The thesis's cell at factor 5, where the human must wait 8 s although it could begin
    something: (24, 3) is the only optimum.
    """
    cell = tandem.load(tiny.CELL)
    game = CellGame.of(cell, time_weight=10, stress_weight=5)
    found = play(
        cell,
        game,
        untrained,
        Search("puct", simulations=400, noise=0.0, temperature=0.0, exploration=2.0),
    )[0]
    assert (found.makespan, found.stress) == (24, 3)
    assert tandem.faults(cell, found.schedule) == []


def test_the_order_of_the_moves_does_not_matter_to_the_scorer(untrained):
    """Shuffled rows give shuffled logits and the same value; rows that are not there weigh
    nothing.
    """
    numbers = np.random.default_rng(0)
    moves, there = (
        numbers.random((6, MOVE_FEATURES), np.float32),
        np.array([1, 1, 0, 1, 1, 1], bool),
    )
    whole, order = numbers.random(WHOLE_FEATURES, np.float32), numbers.permutation(6)
    lively = jax.tree.map(lambda leaf: np.asarray(leaf) * 3, untrained.parameters)
    first = untrained.network.score(np, lively, Observation(moves, there, whole), np.float32(2.0))
    second = untrained.network.score(
        np, lively, Observation(moves[order], there[order], whole), np.float32(2.0)
    )
    np.testing.assert_allclose(first.logits[order], second.logits, atol=1e-4)
    np.testing.assert_allclose(first.to_come, second.to_come, atol=1e-4)
    more = untrained.network.score(
        np, lively, Observation(np.where(there[:, None], moves, 9.0), there, whole), np.float32(2.0)
    )
    np.testing.assert_allclose(first.to_come, more.to_come, atol=1e-4)
    assert first.to_come >= 2
    under_jax = untrained.network.score(
        jnp, lively, Observation(*map(jnp.asarray, (moves, there, whole))), jnp.float32(2.0)
    )
    np.testing.assert_allclose(first.logits, under_jax.logits, atol=1e-4)


def test_their_network_is_two_convolutions_as_a_loop_would_work_them_out():
    network = YuNetworks(filters=2, dense=3)

    class OfSize:
        class layout:
            time = np.zeros((5, 6))

    parameters = jax.tree.map(np.asarray, network.start(jax.random.key(1), OfSize()))
    own = jax.tree.map(lambda leaf: leaf[1], parameters)
    board = np.random.default_rng(1).random((5, 6, 3)).astype(np.float32)

    def convolved(image, layer):
        height, width, channels = image.shape
        weight = layer["weight"].reshape(2, 2, channels, -1)
        found = np.zeros((height, width, weight.shape[-1]))
        for row in range(height):
            for column in range(width):
                for down in range(2):
                    for right in range(2):
                        if row + down < height and column + right < width:
                            found[row, column] += (
                                image[row + down, column + right] @ weight[down, right]
                            )
        found = np.maximum(found + layer["bias"], 0)
        return (
            found[: height // 2 * 2, : width // 2 * 2]
            .reshape(height // 2, 2, width // 2, 2, -1)
            .max((1, 3))
        )

    flow = convolved(convolved(board, own["first"]["0"]), own["second"]["0"]).reshape(-1)
    flow = np.maximum(flow @ own["dense"]["0"]["weight"] + own["dense"]["0"]["bias"], 0)
    seen = network.read(parameters, jnp.asarray(board), jnp.float32(0), jnp.int32(1))
    np.testing.assert_allclose(
        seen.logits, flow @ own["policy"]["0"]["weight"] + own["policy"]["0"]["bias"], atol=1e-4
    )
    np.testing.assert_allclose(
        seen.to_come,
        90 * (flow @ own["value"]["0"]["weight"] + own["value"]["0"]["bias"])[0],
        rtol=1e-4,
    )


def test_an_epsilon_greedy_player_is_legal_and_a_game_ends(trap):
    games, _ = trap
    found = play_games(jax.random.key(0), Blind(3), {}, many(Trap.of(), 64), EpsilonGreedy(1.0))
    assert found.over.all()
    assert set(found.cost.tolist()) == {6.0, 7.0, 3.0, 11.0}
    assert (found.moves[2] == -1).all()
    np.testing.assert_array_equal(
        np.asarray(play_games(jax.random.key(0), Blind(3), {}, games).cost), 6
    )


def test_a_trained_network_comes_back_whole(untrained, tmp_path):
    noted = Trained(untrained.network, untrained.parameters, {"seed": 3})
    back = Trained.load(noted.save(tmp_path / "network.safetensors"), type(untrained.network))
    assert back.network == untrained.network
    assert back.notes == {"seed": 3}
    assert all(
        np.array_equal(a, b)
        for a, b in zip(
            jax.tree.leaves(back.parameters), jax.tree.leaves(untrained.parameters), strict=True
        )
    )
    (tmp_path / "no.safetensors").write_bytes(b"not one")
    with pytest.raises(tandem.CellError, match="no network that can be read"):
        Trained.load(tmp_path / "no.safetensors", type(untrained.network))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: Search("best", simulations=0, depth=0),
            r"(?s)kind 'best'.*simulations 0.*depth 0",
        ),
        (lambda: YuSearch(simulations=0, exploration=-1), r"(?s)simulations 0.*exploration -1"),
        (lambda: Config(games=0, trust=2), r"(?s)games 0.*trust 2"),
        (lambda: YuConfig(outer=0, value_norm=(1.0, 0.0)), r"(?s)outer 0.*value_norm"),
        (lambda: EpsilonGreedy(2), "share 2: must be at most 1"),
    ],
)
def test_what_a_configuration_must_be_is_said_all_at_once(make, message):
    with pytest.raises(UsageError, match=message):
        make()
