"""Joint angles frame by frame, as a camera or a suit records them, to three postures: the median
one, the 95th percentile and the peak of each joint.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tandem.cell.stated import Conditions, Given, entry, meanings, with_unit
from tandem.ergonomics.facts import FactsError, about
from tandem.ergonomics.methods import method_named
from tandem.ergonomics.tasks import TaskFacts
from tandem.ergonomics.units import converted
from tandem.errors import Fault

NEUTRAL = {"lower_arm_flexion_deg": 80.0}
"""Where a joint is at its best, degrees; 0 for all others. How far it is from there counts."""
POSTURES = ("median", "95th percentile", "peak")
MOST_FRAMES = 1_000_000
MOST_FAULTS = 20


def load_angles(
    path: Path, method: str, rest: Mapping[str, Any], whole: Conditions
) -> list[TaskFacts]:
    """Three tasks of one recording: its median posture, and of each joint the 95th percentile and
    the peak of the way from neutral. Each is an angle that was recorded; those of different joints
    need not have come together, so that the last two are rather too high than too low.

    Args:
      path: CSV with a heading for each joint, such as `trunk [deg]`; other columns are left.
      rest: the facts that are no angles, such as the load.

    Raises:
      FactsError: the file cannot be read, or facts are wrong; with every fault at its place.
      UsageError: there is no such method.
    """
    angles = {
        name
        for name, field in method_named(method).model.model_fields.items()
        if about(field)["unit"] == "deg"
    }
    if not angles:
        raise FactsError([Fault(f"{method} takes no angles of joints.", place=str(path))])
    series = _series(path, angles, method)
    faults: list[Fault] = []
    found: list[TaskFacts] = []
    for posture in POSTURES:
        row = {name: Given(value, str(path)) for name, value in rest.items()}
        for name, values in series.items():
            value = _of(values, posture, NEUTRAL.get(name, 0.0))
            row[name] = Given(value, str(path), None, {"source": "video"})
        row["method"] = Given(method, str(path))
        one, wrong = entry(f"{path.stem}: {posture}", row, str(path), whole)
        found += [one] if one is not None else []
        faults = faults or wrong  # the same for each posture, but for angles out of range
    if faults:
        raise FactsError(faults)
    return found


def _of(values: list[float], posture: str, neutral: float) -> float:
    """A recorded value: the middle one, or by its distance from neutral (nearest rank)."""
    if posture == "median":
        return sorted(values)[(len(values) - 1) // 2]
    ranked = sorted(values, key=lambda value: abs(value - neutral))
    place = len(ranked) if posture == "peak" else math.ceil(0.95 * len(ranked))
    return ranked[place - 1]


def _series(path: Path, angles: set[str], method: str) -> dict[str, list[float]]:
    try:
        text = path.read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        said = getattr(error, "strerror", None) or "it is not UTF-8"
        raise FactsError([Fault(f"cannot be read: {said.lower()}.", place=str(path))]) from error
    lines = text.splitlines()
    separator = max(";\t,", key=lines[0].count) if lines else ","
    rows = list(csv.reader(lines[: MOST_FRAMES + 1], delimiter=separator))
    columns = _columns(rows[0] if rows else [], angles)
    if not columns or len(rows) < 2:
        raise FactsError(
            [
                Fault(
                    f"no column is an angle of {method}, or no frame follows. Head columns by"
                    f" {', '.join(sorted(angles))}, or as in `trunk [deg]`.",
                    place=str(path),
                )
            ]
        )
    found: dict[str, list[float]] = {name: [] for name, _ in columns.values()}
    faults: list[Fault] = []
    for number, row in enumerate(rows[1:], 2):
        for index, (name, unit) in columns.items():
            written = row[index].strip() if index < len(row) else ""
            value = _angle(written)
            if value is None:
                faults.append(
                    Fault(
                        f"{name} is {written!r}, but a number is needed in every frame. Correct it,"
                        " or take the frame out.",
                        place=f"{path}:{number}:{index + 1}",
                    )
                )
                continue
            found[name].append(converted(value, unit, "deg"))
        if len(faults) >= MOST_FAULTS:
            break
    if faults:
        raise FactsError(faults)
    return found


def _columns(heads: list[str], angles: set[str]) -> dict[int, tuple[str, str]]:
    found: dict[int, tuple[str, str]] = {}
    for index, head in enumerate(heads):
        name, unit = with_unit(head)
        fits = [meaning for meaning in meanings(name) if meaning in angles]
        if fits and fits[0] not in {known for known, _ in found.values()}:
            found[index] = (fits[0], unit or "deg")
    return found


def _angle(text: str) -> float | None:
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        return None
    return value if math.isfinite(value) else None
