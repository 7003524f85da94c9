"""The grid of Alessio, Aliev and Antonelli (2022): its layouts and rules. Face only; what is exact
is in `exact` and `tables`.
"""

from tandem.lab.alessio2022.layout import LAYOUTS, Layout, layout, random_layout
from tandem.lab.alessio2022.observations import OBSERVATIONS, observe
from tandem.lab.alessio2022.world import (
    Grid,
    Rewards,
    State,
    grid,
    is_over,
    is_success,
    legal,
    reset,
    step,
)

__all__ = [
    "LAYOUTS",
    "OBSERVATIONS",
    "Grid",
    "Layout",
    "Rewards",
    "State",
    "grid",
    "is_over",
    "is_success",
    "layout",
    "legal",
    "observe",
    "random_layout",
    "reset",
    "step",
]
