"""The table of all deciders: what each does, and where it is made."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.dispatch.deciders.policy import Options, Policy
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.errors import UsageError
from tandem.plan.rules import SPECS


@dataclass(frozen=True)
class Entry:
    """A line of the table: what the decider does, and where its maker stands (`module:function`,
    loaded when it is asked for).

    A maker takes a cell, an `Objective` and `Options`, may take seconds, which are spent before the
    shift begins, and raises CellError for a cell that the decider cannot hold. `argument` is handed
    to it first when it is given: one maker then makes several deciders. `follows`: it heeds
    `Options.plan`.
    """

    what: str
    where: str
    argument: str | None = None
    follows: bool = False

    def __call__(self, cell: Cell, objective: Objective, options: Options) -> Policy:
        module, name = self.where.split(":")
        maker = getattr(import_module(module), name)
        policy: Policy = (
            maker(cell, objective, options)
            if self.argument is None
            else maker(self.argument, cell, objective, options)
        )
        return policy


POLICIES: dict[str, Entry] = {
    "fixed": Entry(
        "the exact plan for the stated times, its order kept whatever happens",
        "tandem.dispatch.deciders.fixed:fixed",
        follows=True,
    ),
    **{
        name: Entry(rule.what, "tandem.dispatch.deciders.by_rule:by_rule", name)
        for name, rule in SPECS.items()
    },
    "replan": Entry(
        "CP-SAT plans the rest anew at each event, with the stated times; the first plan found is"
        " taken",
        "tandem.dispatch.deciders.replan:plain",
    ),
    "replan-robust": Entry(
        "as replan, with each person's estimated pace; of good plans the one that is best on"
        " average",
        "tandem.dispatch.deciders.replan:robust",
        follows=True,
    ),
    "expected": Entry(
        "exact: the least expected cost beside the human as modelled; small cells",
        "tandem.dispatch.deciders.by_value:expected",
    ),
    "minimax": Entry(
        "exact: the least cost that no human can spoil; small cells",
        "tandem.dispatch.deciders.by_value:minimax",
    ),
    "learned": Entry(
        "what `tandem train` learned, by any of its algorithms: a network in NumPy",
        "tandem.dispatch.deciders.learned:learned",
    ),
    "auto": Entry(
        "learned, else planned anew, else a rule; always answers within the budget",
        "tandem.dispatch.deciders.auto:auto",
        follows=True,
    ),
}
"""Name -> decider. A new one is a file and a line here; every rule of `plan.rules.SPECS` is one by
itself.
"""


def policy(
    name: str, cell: Cell, objective: Objective = SECONDS, options: Options | None = None
) -> Policy:
    """The decider of this name for the cell.

    Raises:
      UsageError: there is none of this name.
      CellError: it cannot hold this cell.
    """
    known = Known(POLICIES)
    if name not in known:
        raise UsageError(
            f"there is no policy {name!r}. {known.hint(name)} `tandem policies` lists them."
        )
    return POLICIES[name](cell, objective, options or Options())
