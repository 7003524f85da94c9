"""The table of methods, and how they are asked: `score("reba", {...})`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, Literal

from tandem.ergonomics import (
    duet,
    exposure,
    garg_energy,
    hal_tlv,
    kim_lhc,
    lifft,
    lm_mmh,
    niosh,
    ocra,
    reba,
    rest_allowance,
    rsi,
    rula,
    shoulder_tool,
    ssm,
    strain_index_1995,
    task_times,
)
from tandem.ergonomics.facts import Facts, call, read
from tandem.ergonomics.outcome import Outcome, Published
from tandem.errors import UsageError

Scale = Literal["ordinal", "index", "dose"]


@dataclass(frozen=True, slots=True)
class Method:
    """One method, as it scores one task and side.

    Attributes:
      scale: ordinal scores only rank, indices have rules of their own for several tasks, doses are
        added.
      model: the facts of one task and side.
      run: facts to outcome.
      functions: every published step, by its published name; the first is asked when none is named.
      score: the output that is the score.
      region: of the body, that doses are added for.
      sided: left and right are scored apart.
    """

    scale: Scale
    model: type[Facts]
    run: Callable[[Any], Outcome]
    functions: Mapping[str, Published]
    score: str
    region: str
    sided: bool


METHODS: dict[str, Method] = {
    "rula": Method(
        "ordinal", rula.RulaFacts, rula.assess, rula.FUNCTIONS, "grand", "upper_body", True
    ),
    "reba": Method(
        "ordinal", reba.RebaFacts, reba.assess, reba.FUNCTIONS, "reba", "whole_body", True
    ),
    "niosh": Method("index", niosh.NioshFacts, niosh.rwl, niosh.FUNCTIONS, "LI", "low_back", False),
    "rsi": Method("index", rsi.RsiFacts, rsi.assess, rsi.FUNCTIONS, "RSI", "hand", True),
    "lifft": Method(
        "dose", lifft.LifftFacts, lifft.assess, lifft.FUNCTIONS, "CD", "low_back", False
    ),
    "duet": Method("dose", duet.DuetFacts, duet.assess, duet.FUNCTIONS, "CD", "hand", True),
    "shoulder_tool": Method(
        "dose", shoulder_tool.ShoulderFacts, shoulder_tool.assess, shoulder_tool.FUNCTIONS,
        "CD", "shoulder", True,
    ),
    "strain_index_1995": Method(
        "index", strain_index_1995.Si1995Facts, strain_index_1995.assess,
        strain_index_1995.FUNCTIONS, "SI", "hand", True,
    ),
    "hal_tlv": Method(
        "index", hal_tlv.HalFacts, hal_tlv.assess, hal_tlv.FUNCTIONS, "ratio", "hand", True
    ),
    "lm_mmh": Method(
        "index", lm_mmh.LmFacts, lm_mmh.limits, lm_mmh.FUNCTIONS, "ratio", "whole_body", False
    ),
    "garg_energy": Method(
        "dose", garg_energy.GargFacts, garg_energy.assess, garg_energy.FUNCTIONS,
        "kcal", "whole_body", False,
    ),
    "rest_allowance": Method(
        "index", rest_allowance.PowerFacts, rest_allowance.rest, rest_allowance.FUNCTIONS,
        "rest_min", "whole_body", False,
    ),
}  # fmt: skip
"""Name -> method; the names are those of the published worked examples' files."""

UNVERIFIED = {ocra.METHOD: ocra.FUNCTIONS, kim_lhc.METHOD: kim_lhc.FUNCTIONS}
"""Methods whose tables or limits were recalled, not read: single steps alone, on request."""

OTHERS = {
    exposure.METHOD: exposure.FUNCTIONS,
    ssm.METHOD: ssm.FUNCTIONS,
    task_times.METHOD: task_times.FUNCTIONS,
    **UNVERIFIED,
}
"""Published steps beside those of the methods."""

LICENSED = {
    "eaws": "EAWS", "mtm": "MTM", "most": "MOST", "ocra": "OCRA", "kim": "KIM",
    "kim_lhc": "KIM-LHC",
}  # fmt: skip
"""Methods that score no tasks here: licensed ones, and those whose tables were only recalled."""


def method_named(name: str) -> Method:
    """The method of that name. Raises UsageError with the nearest known one."""
    if name in METHODS:
        return METHODS[name]
    raise UsageError(unknown(name))


def unknown(name: str) -> str:
    """What to say of a method that is not in the table."""
    if name.casefold() in LICENSED:
        return (
            f"{LICENSED[name.casefold()]} scores no tasks here: its tables are licensed, or not"
            " verified. State its number as `stress` in the cell file, or score with one of"
            f" {', '.join(METHODS)}."
        )
    near = get_close_matches(name.casefold(), METHODS, n=1, cutoff=0.6)
    hint = f"Did you mean {near[0]!r}?" if near else f"Known: {', '.join(METHODS)}."
    return f"there is no method {name!r}. {hint}"


def score(name: str, facts: Mapping[str, Any] | Facts) -> Outcome:
    """What a method says about one task and side.

    Raises:
      UsageError: there is no such method.
      FactsError: the facts are out of its range, unknown or missing; with every fault.
    """
    method = method_named(name)
    return method.run(read(method.model, facts, name))


def published(name: str, step: str, facts: Mapping[str, Any]) -> Outcome | dict[str, Any]:
    """One published step: an outcome, or its named outputs.

    Raises:
      UsageError: there is no such method or step.
      FactsError: as `score`.
    """
    functions = functions_of(name)
    if step not in functions:
        near = get_close_matches(step, functions, n=1, cutoff=0.5)
        hint = f"Did you mean {near[0]!r}?" if near else f"Known: {', '.join(functions)}."
        raise UsageError(f"{name} has no step {step!r}. {hint}")
    found = functions[step]
    if found.model is not None:
        result = found.run(read(found.model, facts, name))
    else:
        result = call(found.run, facts, name)
    return result if isinstance(result, Outcome | dict) else {"value": result}


def functions_of(name: str) -> Mapping[str, Published]:
    """The published steps of a method, or of the aggregation. Raises UsageError."""
    return OTHERS[name] if name in OTHERS else method_named(name).functions
