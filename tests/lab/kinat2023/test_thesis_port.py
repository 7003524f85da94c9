"""Two readings of appendix E, one imperative and one vectorised, agree on random play: state, done
and both rewards, in every tick.
"""

from __future__ import annotations

import jax
import numpy as np
import pytest
from tests.lab.conftest import THESIS, cell_of, random_cell
from tests.lab.kinat2023.thesis_port import ThesisPort

from tandem.lab.kinat2023 import legal, reset, reward_set, station, step

CELLS = {
    "thesis, appendix": (cell_of(THESIS), "appendix", 2500),
    "thesis, table 5-2": (cell_of(THESIS), "table_5_2", 1500),
    "one task": (cell_of({"1": ({"robot": 3, "human": 5}, 2, [])}), "table_5_2", 1000),
    "random 3": (random_cell(3, 3, 4), "appendix", 2000),
    "random 4": (random_cell(4, 4, 6), "table_5_2", 2000),
    "random 9": (random_cell(9, 9, 5), "appendix", 1500),
}
REWARDS = {
    "appendix": reward_set("appendix", stress_factor=1.0, stage=1),
    "table_5_2": reward_set("table_5_2", stress_factor=5.0, stage=1),
}
LIMIT = 150


def test_enough_trajectories_are_played():
    assert sum(count for _, _, count in CELLS.values()) >= 10_000


def drawn(rng, mask):
    """`[N, 2]` actions: three in four are legal, half of these a task wherever one is; the rest is
    anything.
    """
    weight = mask * rng.random(mask.shape)
    weight[..., 0] *= np.where(rng.random(mask.shape[:2]) < 0.5, 1.0, 1e-3)
    return np.where(
        rng.random(mask.shape[:2]) < 0.75,
        weight.argmax(axis=-1),
        rng.integers(0, mask.shape[-1], mask.shape[:2]),
    )


@pytest.mark.parametrize("name", CELLS)
def test_random_trajectories_are_identical(name):
    cell, kind, count = CELLS[name]
    data, paid = station(cell), REWARDS[kind]
    ports = [
        ThesisPort(data.time[0], data.time[1], data.stress, data.needs, paid._asdict())
        for _ in range(count)
    ]
    for port in ports:
        port.reset()
    first = reset(data)
    state = type(first)(*(np.repeat(np.asarray(part)[None], count, axis=0) for part in first))
    play = jax.jit(jax.vmap(step, in_axes=(None, None, 0, 0)))
    mask = jax.jit(jax.vmap(legal, in_axes=(None, 0)))
    rng, alive, ended = np.random.default_rng(0), np.arange(count), 0
    for _ in range(LIMIT):
        actions = drawn(rng, np.asarray(mask(data, state)))
        state, reward, done, _ = jax.tree.map(np.asarray, play(data, paid, state, actions))
        expected = [ports[i].step(actions[i]) for i in alive]
        np.testing.assert_array_equal(reward[alive], [r for r, _ in expected])
        np.testing.assert_array_equal(done[alive], [d for _, d in expected])
        same_state(data, state, [ports[i] for i in alive], alive)
        ended += sum(d for _, d in expected)
        alive = alive[~done[alive]]
        if not alive.size:
            break
    assert ended > 0.9 * count


def same_state(data, state, ports, alive):
    np.testing.assert_array_equal(state.time[alive], [port.t for port in ports])
    np.testing.assert_array_equal(state.doing[alive], [port.task for port in ports])
    np.testing.assert_array_equal(state.ended[alive], [port.ended for port in ports])
    np.testing.assert_array_equal(
        data.needs[None] & ~state.ended[alive][:, None, :], [port.C.astype(bool) for port in ports]
    )
    np.testing.assert_array_equal(state.clock[alive], [port.clock for port in ports])
    np.testing.assert_array_equal(state.stress[alive], [port.stress for port in ports])


@pytest.mark.parametrize("kind", REWARDS)
def test_the_same_lines_in_numpy_agree_with_the_port(thesis, kind):
    """The faces play in NumPy, training in JAX: one source, so one more trajectory each shows that
    both namespaces carry it.
    """
    data, paid, rng = station(thesis), REWARDS[kind], np.random.default_rng(1)
    for _ in range(50):
        port = ThesisPort(data.time[0], data.time[1], data.stress, data.needs, paid._asdict())
        port.reset()
        state, done = reset(data), False
        while not done and port.clock < LIMIT:
            action = drawn(rng, legal(data, state)[None])[0]
            state, reward, done, _ = step(data, paid, state, action)
            expected, port_done = port.step(action)
            np.testing.assert_array_equal(reward, expected)
            assert done == port_done
            assert isinstance(state.time, np.ndarray)
        same_state(
            data, type(state)(*(np.asarray(part)[None] for part in state)), [port], np.array([0])
        )
