"""A learner of your own at the PettingZoo face, in plain NumPy: independent agents, each with a
preference for every action, moved by REINFORCE (Williams 1992, section 5), the mean as baseline.

    python examples/extensions/own_pettingzoo_learner.py examples/thesis.yaml learned.npz
    tandem simulate examples/thesis.yaml --policy own_pettingzoo_learner:make --learned learned.npz
    tandem dispatch examples/thesis.yaml --policy own_pettingzoo_learner:make --learned learned.npz

In the folder of this file, or with it on PYTHONPATH. Nothing of Tandem is changed.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

import tandem
from tandem.dispatch.deciders.at_a_face import AtPettingZoo, of_pettingzoo
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.lookahead.objective import Objective
from tandem.envs import parallel_env

Preferences = Mapping[str, np.ndarray]
"""Agent -> `[A]` float, how much it is for each action."""


def chances(preference: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """`[A]`, softmax of the preferences over the legal actions."""
    weight = np.where(mask, np.exp(preference - preference[mask > 0].max()), 0.0)
    return weight / weight.sum()


def learn(
    cell: tandem.Cell, *, episodes: int = 400, rate: float = 0.5, batch: int = 10, seed: int = 0
) -> Preferences:
    """What each agent prefers after so many episodes, all paid minus the seconds."""
    env, rng = parallel_env("events", cell), np.random.default_rng(seed)
    prefers = {agent: np.zeros(env.action_space(agent).n) for agent in env.possible_agents}
    for _ in range(episodes // batch):
        played = [one_episode(env, prefers, rng) for _ in range(batch)]
        returns = np.array([paid for paid, _ in played])
        worth = (returns - returns.mean()) / (returns.std() + 1e-9)
        for better, (_, gradients) in zip(worth, played, strict=True):
            for agent, gradient in gradients.items():
                prefers[agent] += rate / batch * better * gradient
    return prefers


def one_episode(
    env: object, prefers: Preferences, rng: np.random.Generator
) -> tuple[float, dict[str, np.ndarray]]:
    """What was paid in one episode, and each agent's gradient of the log of what it chose."""
    gradients = {agent: np.zeros_like(preference) for agent, preference in prefers.items()}
    seen, _ = env.reset(seed=int(rng.integers(2**31)))
    paid = 0.0
    while env.agents:
        actions = {}
        for agent in env.agents:
            share = chances(prefers[agent], seen[agent]["action_mask"])
            actions[agent] = int(rng.choice(len(share), p=share))
            gradients[agent] -= share
            gradients[agent][actions[agent]] += 1.0
        seen, rewards, *_ = env.step(actions)
        paid += next(iter(rewards.values()))
    return paid, gradients


def greedy(prefers: Preferences) -> Callable[[str, Mapping[str, np.ndarray]], int]:
    """Each agent's likeliest legal action."""
    return lambda agent, seen: int(np.argmax(chances(prefers[agent], seen["action_mask"])))


def make(cell: tandem.Cell, objective: Objective, options: Options) -> AtPettingZoo:
    """What `--learned FILE.npz` has learned at the PettingZoo face: an example of a learner."""
    if options.learned is None:
        raise tandem.UsageError("own_pettingzoo_learner: name its file with --learned FILE.npz.")
    with np.load(options.learned) as file:
        act = greedy(dict(file))
        return of_pettingzoo(cell, act, name="own learner", objective=objective)


def main() -> None:
    """Learns, writes what was learned, and judges it beside a rule and the plan."""
    parser = argparse.ArgumentParser(description="Independent REINFORCE in plain NumPy.")
    parser.add_argument("cell", type=Path)
    parser.add_argument("file", type=Path, help="Of what was learned, .npz.")
    parser.add_argument("--learning-episodes", type=int, default=400)
    parser.add_argument("--people", default="random:0.5")
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    cell = tandem.load(given.cell)
    prefers = learn(cell, episodes=given.learning_episodes, seed=given.seed)
    np.savez(given.file, **prefers)
    own = of_pettingzoo(cell, greedy(prefers), name="own learner")
    (document,) = tandem.judge(cell, ["fixed", "random", own], given.people, given.episodes)
    for row in document["policies"]:
        print(f"{row['policy']}: {row['makespan']['mean']} s")


if __name__ == "__main__":
    main()
