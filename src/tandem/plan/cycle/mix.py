"""Several products in each cycle: variants of a mix, or one product in several ways."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from tandem.cell.model import Cell, plain
from tandem.cell.names import Known
from tandem.errors import CellError, Fault, UsageError
from tandem.plan.cycle.methods import plan_cycle
from tandem.plan.cycle.result import CycleFront
from tandem.schedule.cycle import combined

BASE = "base"
"""What the product of the cell itself is called beside its variants."""


def product_of(cell: Cell, name: str | None) -> Cell:
    """The cell of a variant; the cell without its variants for `BASE`, where no variant is called
    so; the cell as it is for None.

    Raises UsageError when there is no variant of this name.
    """
    if name is None:
        return cell
    if name in cell.variants:
        return cell.variant(name)
    if name != BASE:
        known = Known([*cell.variants, BASE])
        raise UsageError(f"variant {name!r}: the cell has no such variant. {known.hint(name)}")
    document = cell.to_dict()
    document.pop("variants", None)
    return Cell.model_validate(document)


def plan_mix(
    cell: Cell,
    mix: Mapping[str, int],
    *,
    one_allocation: bool = False,
    minimize: Literal["front", "cycle_time", "stress"] = "front",
    on_point: Callable[[int], None] | None = None,
    **effort: Any,
) -> CycleFront:
    """The front of cycle time and stress of a station whose cycle makes so many products of each
    variant, in whatever order is best; both are those of all products of a cycle together.

    With one name alone, such as `{"base": 2}`, products take turns between several ways of sharing
    the work.

    Args:
      mix: variant, or "base" for the cell itself, -> products in each cycle, 1 or more.
      one_allocation: a task is done by the same operators in every product that has it.
      minimize, on_point, effort: as of `plan_cycle`.

    Raises:
      UsageError: no such variant, a count that is none, or an empty mix.
      CellError: the cell has a table of stress by sets; or no allocation fits all products.
      InfeasibleError, NothingFoundError: as `plan_cycle`.
    """
    if wrong := [f"{name}={count}" for name, count in mix.items() if count < 1]:
        raise UsageError(f"mix {', '.join(wrong)}: a cycle makes 1 or more of each.")
    if not mix:
        raise UsageError("an empty mix: name what a cycle makes.")
    if cell.stress_of_set is not None:
        said = (
            "says what sets of one product's tasks stress, and nothing about a mix. Leave it out."
        )
        raise CellError([Fault(said, ("stress_of_set",))])
    products = [product_of(cell, name) for name, count in mix.items() for _ in range(count)]
    together = combined(products, one_allocation=one_allocation)
    together = together.replace(name=cell.name)
    front = plan_cycle(together, minimize=minimize, on_point=on_point, **effort)
    return replace(front, mix=tuple(mix.items()))


@dataclass(frozen=True)
class Alone:
    """The least cycle times of products that are each made alone, product after product.

    Attributes:
      seconds: variant -> least cycle time.
      mean: of one product of the mix; `worst` of the slowest variant.
    """

    seconds: Mapping[str, float]
    mean: float
    worst: float

    def to_dict(self) -> dict[str, Any]:
        """As a result document holds it."""
        return {
            "cycle_time": {name: plain(time) for name, time in self.seconds.items()},
            "mean": plain(round(self.mean, 6)),
            "worst": plain(self.worst),
        }


def each_alone(cell: Cell, mix: Mapping[str, int], **effort: Any) -> Alone:
    """What each product of a mix would take in a station that makes nothing else, with an
    allocation of its own; raises as `plan_cycle`.
    """
    seconds = {
        name: plan_cycle(product_of(cell, name), minimize="cycle_time", **effort)[0].cycle_time
        for name in mix
    }
    total = sum(mix.values())
    mean = sum(seconds[name] * count for name, count in mix.items()) / total
    return Alone(seconds, mean, max(seconds.values()))


def shares(cell: Cell, most: int = 12) -> dict[str, int]:
    """The smallest mix of at most so many products whose counts are as the variants' shares; the
    nearest one where none is exactly so.
    """
    weights = {name: variant.share for name, variant in cell.variants.items()}
    total = sum(weights.values())

    def counted(products: int) -> dict[str, int]:
        return {name: max(1, round(products * share / total)) for name, share in weights.items()}

    def off(counts: dict[str, int]) -> float:
        made = sum(counts.values())
        return max(abs(counts[name] / made - share / total) for name, share in weights.items())

    tried = [counted(products) for products in range(len(weights), most + 1)]
    return min(tried, key=lambda counts: (round(off(counts), 9), sum(counts.values())))
