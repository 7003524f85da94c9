"""The table of all deciders: what each does, and where it is made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.dispatch.deciders.own import FORM, made_by
from tandem.dispatch.deciders.policy import Options, Policy
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.errors import UsageError
from tandem.extensions import Table, resolved
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
        maker = resolved(self.where)
        policy: Policy = (
            maker(cell, objective, options)
            if self.argument is None
            else maker(self.argument, cell, objective, options)
        )
        return policy


@dataclass(frozen=True)
class Theirs:
    """A line that others add: a maker, which takes a cell, an `Objective` and `Options`, or a
    decider that is made already.

    Attributes:
      home: where it stands, `module:attribute`; its name for one that was handed in.
      source: the maker or the decider.
      follows: it heeds `Options.plan`, as its maker says by an attribute `follows`.
    """

    home: str
    source: Any

    @property
    def what(self) -> str:
        """The first line of what it says of itself."""
        said = (getattr(self.source, "__doc__", None) or "").strip().partition("\n")[0]
        return said or f"a decider of your own, {self.home}"

    @property
    def follows(self) -> bool:
        return bool(getattr(self.source, "follows", False))

    def __call__(self, cell: Cell, objective: Objective, options: Options) -> Policy:
        return made_by(self.source, self.home, cell, objective, options)


def theirs(home: str, source: Any) -> Entry | Theirs:
    """The line that others add. Raises UsageError for what makes no decider and is none."""
    if isinstance(source, Entry | Theirs):
        return source
    if not callable(source) and not callable(getattr(source, "decide", None)):
        raise UsageError(f"{home}: is {source!r}, and no policy. {FORM}")
    return Theirs(home, source)


POLICIES: Table[Entry | Theirs] = Table(
    "policies",
    {
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
            "CP-SAT plans the rest anew at each event, with the stated times; the first plan found"
            " is taken",
            "tandem.dispatch.deciders.replan:plain",
        ),
        "replan-robust": Entry(
            "as replan, with each person's estimated pace; of good plans the one that is best on"
            " average",
            "tandem.dispatch.deciders.robust:robust",
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
            "what `tandem train` learned, by any of its algorithms: a network in NumPy; without a"
            " file, the best schedule of the rest by the one network for all cells",
            "tandem.dispatch.deciders.learned:learned",
        ),
        "auto": Entry(
            "learned where a file is given, else exact values of all choices, or the network where"
            " too many are open, else a rule; answers within the budget",
            "tandem.dispatch.deciders.auto:auto",
            follows=True,
        ),
    },
    theirs,
)
"""Name -> decider. A new one is a file and a line here, an entry point of the group
`tandem.policies`, or anybody's by its dotted name; every rule of `plan.rules.SPECS` is one by
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
    if name not in POLICIES:
        raise UsageError(
            f"there is no policy {name!r}. {Known(POLICIES).hint(name)} `tandem policies` lists"
            " them."
        )
    return POLICIES[name](cell, objective, options or Options())
