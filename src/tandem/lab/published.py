"""What is published of each system, feature by feature, with its source: beside it stands what the
system can do as it is rebuilt here, which the probes find out.

Nobody here has read the full texts of the four papers. What is not in the sources named is "not
known", which is not "no".
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Claim(NamedTuple):
    """What a system can do by what is published of it, and where that stands."""

    value: str
    source: str


UNKNOWN = Claim("not known", "")
THESIS = "Kinat 2023, chapters 5 and 6"
REVIEW = "Kinat 2023, chapter 4"
CODE = "the authors' code"
ABSTRACT = "abstract"
SECOND_HAND = "abstract, second hand"

PUBLISHED: Mapping[str, Mapping[str, Claim]] = {
    "thesis": {
        "objectives": Claim("time, stress", THESIS),
        "agents": Claim("2: robot, human", THESIS),
        "algorithm": Claim("PPO for each", THESIS),
        "cooperation or collaboration": Claim("cooperation", THESIS),
        "disassembly": Claim("no: nothing is done again", THESIS),
        "tools": Claim("no", THESIS),
        "human deviation": Claim("no: times and people are exact", THESIS),
        "generalises": Claim("no: one cell, never another", THESIS),
    },
    "yu2020": {
        "objectives": Claim("time", CODE),
        "agents": Claim("2: robot, human", CODE),
        "algorithm": Claim("tree search and network, after AlphaGo Zero", ABSTRACT),
        "cooperation or collaboration": Claim("cooperation", CODE),
        "disassembly": Claim("no", CODE),
        "tools": Claim("no", CODE),
        "human deviation": Claim("no: neither mistakes of people nor failures", REVIEW),
        "real time": Claim("yes; figures not public", REVIEW),
        "exact optimum known": Claim("by enumeration in the code; not public of the paper", CODE),
    },
    "yu2021": {
        "algorithm": Claim("DQN for each agent", SECOND_HAND),
        "agents": Claim("several; their number varies", SECOND_HAND),
        "tools": Claim("no", "told us by a reader of the paper"),
        "exact optimum known": Claim("compared with dynamic programming", SECOND_HAND),
    },
    "antonelli2021": {
        "objectives": Claim("time", REVIEW),
        "agents": Claim("1: robot", REVIEW),
        "algorithm": Claim("tabular Q-learning", REVIEW),
        "cooperation or collaboration": Claim("collaboration", REVIEW),
        "disassembly": Claim("yes", REVIEW),
        "human deviation": Claim("yes; too much of it may defeat the policy", REVIEW),
        "real time": Claim("the aim: the sequence is made online", ABSTRACT),
    },
    "alessio2022": {
        "objectives": Claim("the right terminal state; idling and leaving the grid cost", REVIEW),
        "agents": Claim("2: robot, human as adversary", ABSTRACT),
        "algorithm": Claim("PPO", REVIEW),
        "cooperation or collaboration": Claim("neither: they move in turns", REVIEW),
        "human deviation": Claim("yes: an adversary, random aims", ABSTRACT),
        "exact optimum known": Claim("no: the result is qualitative", ABSTRACT),
    },
    "zhang2022": {
        "objectives": Claim("time, difficulty", REVIEW),
        "agents": Claim("2: robot, human", REVIEW),
        "algorithm": Claim("DDPG made into a dual-agent actor-critic", REVIEW),
        "cooperation or collaboration": Claim("cooperation and collaboration", REVIEW),
        "tools": Claim("yes", REVIEW),
        "human deviation": Claim("yes: noise in the human's actor; another sequence", ABSTRACT),
        "real time": Claim("shown on a display in real time", REVIEW),
        "generalises": Claim("not known; larger products are future work", REVIEW),
    },
}
"""System -> feature -> what is published; what is missing is not known."""


def published(system: str, feature: str) -> Claim:
    """What is published of a system's feature."""
    return PUBLISHED.get(system, {}).get(feature, UNKNOWN)
