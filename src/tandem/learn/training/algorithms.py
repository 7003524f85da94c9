"""The table of algorithms."""

from __future__ import annotations

from tandem.extensions import extended, resolved
from tandem.learn.algorithm import Algorithm, Order

ALGORITHMS = extended(
    "algorithms",
    {
        "ppo": "tandem.learn.ppo.trainee:Trainee",
        "alphazero": "tandem.learn.alphazero.trainee:Trainee",
        "dqn": "tandem.learn.dqn.trainee:Trainee",
    },
)
"""Name -> the class that is made from an order, `module:class`. A new one is a line here, or an
entry point of the group `tandem.algorithms`.
"""

FORMERLY = {"response": "ppo"}
"""What runs of earlier versions call an algorithm -> what it is called now."""


def trainee(name: str) -> type[Algorithm]:
    """The algorithm of that name."""
    found: type[Algorithm] = resolved(ALGORITHMS[name])
    return found


def algorithm(order: Order) -> Algorithm:
    """The order's algorithm. Raises CellError when it cannot hold the cell."""
    return trainee(order.recipe.algorithm)(order)
