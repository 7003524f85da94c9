"""Ergonomics: from what an engineer knows about a task to a number that can be defended.

outcome = tandem.ergonomics.score("reba", {"trunk_flexion_deg": 45, ...})
outcome.score, outcome.level, outcome.outputs, outcome.steps
"""

from tandem.ergonomics.duet import DuetFacts
from tandem.ergonomics.facts import Facts, FactsError
from tandem.ergonomics.garg_energy import GargFacts
from tandem.ergonomics.hal_tlv import HalFacts
from tandem.ergonomics.lifft import LifftFacts
from tandem.ergonomics.lm_mmh import LmFacts
from tandem.ergonomics.methods import METHODS, Method, published, score
from tandem.ergonomics.niosh import NioshFacts
from tandem.ergonomics.outcome import Outcome, Reason, Step
from tandem.ergonomics.reba import RebaFacts
from tandem.ergonomics.rest_allowance import PowerFacts
from tandem.ergonomics.rsi import CosiFacts, CusiFacts, RsiFacts
from tandem.ergonomics.rula import RulaFacts
from tandem.ergonomics.shoulder_tool import ShoulderFacts
from tandem.ergonomics.strain_index_1995 import Si1995Facts

__all__ = [
    "METHODS",
    "CosiFacts",
    "CusiFacts",
    "DuetFacts",
    "Facts",
    "FactsError",
    "GargFacts",
    "HalFacts",
    "LifftFacts",
    "LmFacts",
    "Method",
    "NioshFacts",
    "Outcome",
    "PowerFacts",
    "Reason",
    "RebaFacts",
    "RsiFacts",
    "RulaFacts",
    "ShoulderFacts",
    "Si1995Facts",
    "Step",
    "published",
    "score",
]
