"""The tables of algorithms, and of who decides with what they learned."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import ConfigDict, Field

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.extensions import extended, resolved
from tandem.learn.algorithm import Algorithm, Learnt, Reader, TrainingOrder
from tandem.learn.forms import Form
from tandem.learn.tensors import read_tensors

ALGORITHMS = extended(
    "algorithms",
    {
        "ppo": "tandem.learn.ppo.trainee:Trainee",
        "alphazero": "tandem.learn.alphazero.trainee:Trainee",
        "dqn": "tandem.learn.dqn.trainee:Trainee",
        "graph": "tandem.learn.graph.trainee:Trainee",
    },
)
"""Name -> the class that is made from an order, `module:class`. A new one is a line here, or an
entry point of the group `tandem.algorithms`.
"""

DECIDERS = extended(
    "deciders",
    {
        "ppo": "tandem.learn.ppo.decider:learnt",
        "alphazero": "tandem.learn.alphazero.decider:learnt",
        "dqn": "tandem.learn.dqn.decider:learnt",
    },
)
"""Algorithm -> its `Reader`, `module:function`, which needs no JAX. One more is a line here, or an
entry point of the group `tandem.deciders`. One whose policies know a world of their own only has
none.
"""

FORMERLY = {"response": "ppo"}
"""What runs of earlier versions call an algorithm -> what it is called now."""


def trainee(name: str) -> type[Algorithm]:
    """The algorithm of that name."""
    found: type[Algorithm] = resolved(ALGORITHMS[name])
    return found


def algorithm(order: TrainingOrder) -> Algorithm:
    """The order's algorithm. Raises CellError when it cannot hold the cell."""
    return trainee(order.recipe.algorithm)(order)


def decider_of(path: Path, cell: Cell) -> Learnt:
    """The policy in the file as it decides on the cell, whichever algorithm it comes from.

    Raises:
      CellError: the file is no policy.
      UsageError: it cannot be dispatched, or does not fit the cell.
    """
    name, recipe = origin_of(path)
    if name == "graph":
        raise UsageError(
            f"{path}: is the network for all cells, which plans the rest at each event and takes no"
            " turns. It decides by tandem dispatch or tandem simulate --policy learned."
        )
    if name not in DECIDERS:
        recipe = f"the recipe {recipe!r}" if recipe else "another recipe"
        raise UsageError(
            f"{path}: was trained by {recipe}, whose world knows no events. Train one for dispatch"
            " with: tandem train CELL"
        )
    reader: Reader = resolved(DECIDERS[name])
    return reader(path, cell)


def origin_of(path: Path) -> tuple[str, str]:
    """The algorithm that the policy in the file comes from, and its recipe; empty where it does not
    say. Raises CellError when the file is no policy.
    """
    _, said = read_tensors(path, _Said, "policy")
    made_by = said.notes.kind or OF_NETWORKS.get(said.network, said.network)
    return FORMERLY.get(made_by, made_by), said.notes.recipe


OF_NETWORKS = {"scorer": "alphazero", "values": "dqn"}
"""The form of a network -> the algorithm, for files of earlier versions, which do not say it."""


class _Source(Form):
    """What a policy's notes say of where it comes from."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")

    kind: str = ""
    recipe: str = ""


class _Said(Form):
    """As much of the document in a policy's file as tells whose it is."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")

    format: Literal["tandem policy 1", "tandem network 1"]
    network: str = ""
    notes: _Source = Field(default_factory=_Source)
