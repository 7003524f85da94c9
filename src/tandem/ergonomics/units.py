"""Units in which engineers state facts, and what one is in another."""

from __future__ import annotations

from typing import NamedTuple


class Unit(NamedTuple):
    """What a unit measures, and how much of the first unit of its kind it is."""

    measures: str
    size: float


UNITS: dict[str, Unit] = {
    "deg": Unit("angle", 1.0),
    "rad": Unit("angle", 57.29577951308232),
    "kg": Unit("mass", 1.0),
    "g": Unit("mass", 0.001),
    "lb": Unit("mass", 0.45359237),
    "kgf": Unit("mass", 1.0),
    "N": Unit("mass", 1 / 9.80665),
    "cm": Unit("length", 1.0),
    "mm": Unit("length", 0.1),
    "m": Unit("length", 100.0),
    "in": Unit("length", 2.54),
    "s": Unit("time", 1.0),
    "min": Unit("time", 60.0),
    "h": Unit("time", 3600.0),
    "1/min": Unit("rate", 1.0),
    "1/s": Unit("rate", 60.0),
    "1/h": Unit("rate", 1 / 60),
    "1/day": Unit("a day", 1.0),
    "%": Unit("share", 1.0),
    "kcal/min": Unit("power", 1.0),
    "m/s": Unit("speed", 1.0),
}
"""A force in N is told as the mass that weighs so much, as the methods' loads are."""

SPELLINGS = {
    "°": "deg", "degree": "deg", "degrees": "deg", "grad": "deg", "radian": "rad",
    "radians": "rad", "bogenmass": "rad", "lbs": "lb", "pound": "lb", "pounds": "lb",
    "inch": "in", "inches": "in", "zoll": "in", "n": "N", "newton": "N", "gramm": "g",
    "kilogramm": "kg", "sek": "s", "sec": "s", "std": "h", "stunden": "h", "minuten": "min",
    "/min": "1/min", "per min": "1/min", "pro min": "1/min", "hz": "1/s", "/s": "1/s", "/h": "1/h",
    "prozent": "%", "per cent": "%", "/day": "1/day", "/tag": "1/day", "1/tag": "1/day",
    "/schicht": "1/day", "1/schicht": "1/day", "/shift": "1/day", "1/shift": "1/day",
}  # fmt: skip
"""Other spellings, casefolded."""


def unit_named(text: str) -> str | None:
    """The unit that a text names; None when it is none."""
    plain = " ".join(text.split())
    if plain in UNITS:
        return plain
    folded = plain.casefold().rstrip(".")
    return folded if folded in UNITS else SPELLINGS.get(folded)


def converted(value: float, given: str, wanted: str) -> float:
    """The value in another unit of the same kind, to twelve digits.

    Raises:
      ValueError: the two measure different things.
    """
    one, other = UNITS[given], UNITS[wanted]
    if one.measures != other.measures:
        raise ValueError(f"{given} measures {one.measures}, but {wanted} is needed")
    return value if given == wanted else float(f"{value * one.size / other.size:.12g}")
