"""A shift: product after product, told by events and steered by decisions. Journal + situation +
decider.

`Shift.take(line)` is all that happens: the line is read, judged and answered; what was taken moves
the situation on and is decided upon; before anybody hears of it, line, answer and decision are in
the journal, in one transaction. All but the wall clock is a pure function of the lines.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from typing import Any, Self

from tandem.cell.model import Cell
from tandem.dispatch.deciders.by_variant import ByVariant, order_of
from tandem.dispatch.deciders.own import Own
from tandem.dispatch.deciders.policy import Basis, Chosen, Options, Policy, basis_of, plan_of
from tandem.dispatch.deciders.table import POLICIES, policy
from tandem.dispatch.journal import Entry, Journal, JournalError
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.shift.deadline import Answered, InTime
from tandem.dispatch.shift.documents import (
    SCHEMA_VERSION,
    Document,
    digest,
    document,
    event_of,
    is_of,
    kept_event,
    named,
    over,
    told,
)
from tandem.dispatch.shift.forecast import forecast
from tandem.dispatch.situation.events import (
    LONGEST_LINE,
    MOST_BYTES,
    Event,
    EventError,
    id_of,
    read_event,
    start_of,
)
from tandem.dispatch.situation.model import TAKING_APART, Product, Situation
from tandem.dispatch.situation.objections import objections, remarks
from tandem.dispatch.situation.transitions import after, ordered
from tandem.errors import TandemError, UsageError
from tandem.extensions import is_dotted
from tandem.files.load import load
from tandem.plan.rules import SPECS
from tandem.schedule.checker import faults

RULE = "longest-tail"
"""The rule that answers when the decider cannot."""

MOST_PRODUCTS = 1_000
"""So many can be ordered when a shift begins; more by events."""

FOR_PLANNING = 0.6
"""Share of the budget that becomes work of the decider; the rest is for what takes longer than it
should.
"""


@dataclass(frozen=True)
class Settings:
    """What a shift is steered by; stands in its journal.

    Attributes:
      policy: name of the decider, from `POLICIES`.
      objective, options: handed to the decider. `options.budget_ms` is for each decision,
        `options.seed` for whatever it draws.
      taking_apart: see `TAKING_APART` in `situation/model.py`.
      products: so many of the shift's cell are ordered when it begins; more by events.
    """

    policy: str = "auto"
    objective: Objective = field(default_factory=Objective)
    options: Options = field(default_factory=Options)
    taking_apart: float = TAKING_APART
    products: int = 1

    def __post_init__(self) -> None:
        if not 0 <= self.products <= MOST_PRODUCTS:
            raise UsageError(
                f"products {self.products}: a shift begins with 0 to {MOST_PRODUCTS}; order more by"
                " the event `product`."
            )
        if not 0 < self.taking_apart < math.inf:
            raise UsageError(f"taking apart {self.taking_apart:g}: must be a share above 0.")

    def to_dict(self) -> Document:
        """As plain values."""
        made = asdict(self)
        made["options"]["prior"] = [[factor, share] for factor, share in self.options.prior.items()]
        chosen = self.options.plan
        made["options"]["plan"] = None if chosen is None else chosen.to_dict()
        return made

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of `to_dict`."""
        kept = data["options"]
        plan = None if kept.get("plan") is None else Chosen.from_dict(kept["plan"])
        options = Options(**{**kept, "prior": dict(kept["prior"]), "plan": plan})
        return cls(
            data["policy"],
            Objective(**data["objective"]),
            options,
            data["taking_apart"],
            data["products"],
        )

    def decider(
        self,
        cell: Cell,
        variants: Mapping[str, Cell] | None = None,
        *,
        own: Policy | None = None,
    ) -> InTime:
        """The decider, with the rule that stands in for it. May take seconds.

        Args:
          variants: further cells that it decides for; `options.plan` is of `cell` alone.
          own: a decider of yours for `cell`, instead of the one that is named; it knows no
            variants.
        """
        if own is not None:
            rule = policy(RULE, cell, self.objective, self.options)
            return InTime(Own(own, own.name), rule, self.options.budget_ms)
        told = replace(self.options, budget_ms=self.options.budget_ms * FOR_PLANNING)

        def made(name: str) -> Policy:
            own = policy(name, cell, self.objective, told)
            if not variants:
                return own
            others: dict[str | None, Policy] = {None: own} | {
                variant: policy(name, other, self.objective, replace(told, plan=None))
                for variant, other in variants.items()
            }
            return ByVariant(others)

        return InTime(made(self.policy), made(RULE), self.options.budget_ms)

    def beginning(self, cell: Cell, variants: Mapping[str, Cell] | None = None) -> Situation:
        """Where a shift that is steered by this begins."""
        return Situation.of(
            cell, taking_apart=self.taking_apart, variants=variants, products=self.products
        )

    def carrying_out(self, plan: Chosen | None) -> Settings:
        """The same with the plan that its decider made for itself, so that the journal keeps it."""
        if plan is None or self.options.plan is not None:
            return self
        return replace(self, options=replace(self.options, plan=plan))


class Shift:
    """A shift under way.

    Attributes:
      cell: of the products that have no variant; `variants`: the other cells by name.
      situation: where it stands.
      number: of the last entry in the journal; -1 before the opening.
      start: the moment on the wall clock that is 0 s; None while nobody has told one.
      is_resumed: the journal held it already.
      decision: the document of the last decision.
      event: the last one that was taken; None before any.
      decider: who decides; `ask`: how it is asked.
      basis: the plan that it carries out; None when it carries out none.
    """

    def __init__(
        self,
        journal: Journal,
        cell: Cell,
        settings: Settings,
        start: datetime | None,
        decider: InTime,
        variants: Mapping[str, Cell] | None = None,
    ) -> None:
        """Use `Shift.open`."""
        self.journal, self.cell, self.settings, self.start = journal, cell, settings, start
        self.decider = decider
        self.ask: Callable[[Situation], Answered] = decider.decide
        self.variants = dict(variants or {})
        self.situation = settings.beginning(cell, self.variants)
        self.number, self.is_resumed, self.decision = -1, False, Document()
        self.event: Event | None = None
        self.basis: Basis | None = None

    @classmethod
    def open(
        cls,
        cell: Cell,
        journal: Journal,
        settings: Settings,
        start: datetime | None = None,
        *,
        decider: InTime | None = None,
        variants: Mapping[str, Cell] | None = None,
    ) -> Self:
        """Opens a shift in a new journal and decides for the first time, or goes on where the
        journal ends.

        Args:
          settings: of a new shift. Those of a journal that is there must be the same.
          start: the moment on the wall clock that is 0 s, for events that tell the time; when None,
            the first event that does is at 0 s.
          decider: instead of the one that the settings name.
          variants: cells of products that differ, by the names that `product` events give. Those of
            a journal that is there must be the same, or not be given.

        Raises:
          UsageError: a variant has other operators than the cell.
          JournalError: the journal is of another cell or of other settings, or does not lead where
            it says.
          UsageError, CellError: the decider does not exist, or cannot hold the cell.
        """
        if not journal.is_new:
            stated = settings.policy
            settings, start = opened_with(journal, cell)
            if decider is None:
                named_again(journal, settings, stated)
            variants = kept_variants(journal, variants)
        fits(cell, variants or {})
        decider = decider or settings.decider(cell, variants)
        settings = settings.carrying_out(plan_of(decider.policy))
        shift = cls(journal, cell, settings, start, decider, variants)
        shift.basis = basis_of(decider.policy)
        shift.is_resumed = not journal.is_new
        if shift.is_resumed:
            shift._go_on()
        for there in shift.to_warm_up():
            decider.warm_up(there)
        if not shift.is_resumed:
            shift.begin()
        return shift

    def take(self, line: str | bytes) -> list[Document]:
        """Takes a line from the floor, as text or as the bytes that came.

        Returns:
          the answer; when the event was taken, the decision after it too. Both are in the journal
          already.

        Raises:
          JournalError: the journal cannot be written. The line counts as not taken.
        """
        answer, event = self._answered(line)
        decision, moved = None, self.situation
        if event is not None:
            moved = after(self.situation, event)
            decision = self._decided(moved)
            moved = ordered(moved, told(decision), self.number + 1)
        plain = None if event is None else event.to_dict()
        entry = Entry(
            self.number + 1, _wall_clock(), _kept(line), plain, answer, decision, digest(moved)
        )
        self.journal.append(entry, None if event is None else event.id)
        self._moved(entry, moved)
        return [answer] if decision is None else [answer, decision]

    def hello(self) -> Document:
        """What the shift is and where it stands: the first thing that the floor hears."""
        plan = self.settings.options.plan
        return {
            "type": "shift",
            "schema_version": SCHEMA_VERSION,
            "cell": self.cell.name,
            "digest": self.cell.digest,
            "policy": self.settings.policy,
            "budget_ms": self.settings.options.budget_ms,
            "seed": self.settings.options.seed,
            "weights": [self.settings.objective.time, self.settings.objective.stress],
            "plan": None if plan is None else plan.schedule.digest,
            "start": None if self.start is None else self.start.isoformat(),
            "resumed": self.is_resumed,
            "number": self.number,
            "at": self.situation.clock,
            "variants": list(self.variants),
            "product": named(self.situation),
            "products": self.situation.products_done,
            "queued": len(self.situation.queued),
            "persons": {
                human: self.situation.person(human) for human in self.situation.cell.humans
            },
            "lacking": [name for _, name in sorted(self.situation.stock)],
            "done": list(self.situation.done),
            "running": {task: list(at.operators) for task, at in self.situation.running.items()},
            "wrong": list(self.situation.wrong),
            "absent": sorted(self.situation.absent),
            "failed": sorted(self.situation.failed),
        }

    def to_warm_up(self) -> list[Situation]:
        """Where a decider should have been asked once before the shift begins: where it stands, and
        at the beginning of each of its products.
        """
        apart = self.settings.taking_apart
        begins = [Situation.of(self.cell, taking_apart=apart)] + [
            replace(Situation.of(cell, taking_apart=apart), product=Product(1, None, name))
            for name, cell in self.variants.items()
        ]
        if self.situation.is_over:
            return begins
        return [*(begins if self.variants else []), self.situation]

    def begin(self) -> None:
        """Decides for the first time and begins the journal. `open` does it where it is due."""
        decision = self._decided(self.situation)
        moved = ordered(self.situation, told(decision), 0)
        opening = Entry(0, _wall_clock(), "", None, None, decision, digest(moved))
        self.journal.begin(
            self.cell,
            self.settings.to_dict(),
            None if self.start is None else self.start.isoformat(),
            opening,
            self.variants,
        )
        self._moved(opening, moved)

    def _go_on(self) -> None:
        """Lives through the journal. Raises JournalError at an entry that does not lead on."""
        for entry in self.journal.entries():
            moved = self._led(entry)
            if moved is None or digest(moved) != entry.situation:
                raise JournalError(
                    f"{self.journal.path}: entry {entry.number} does not lead where the journal"
                    " says. It was changed, or is damaged."
                )
            self._moved(entry, moved)

    def _led(self, entry: Entry) -> Situation | None:
        """Where an entry leads; None when it tells of what cannot have happened, or been told,
        here.
        """
        moved = self.situation
        if entry.event is not None:
            event = kept_event(entry.event, moved.cell, self.variants)
            if event is None or objections(moved, event):
                return None
            moved = after(moved, event)
        if entry.decision is None:
            return moved
        choice = told(entry.decision)
        return ordered(moved, choice, entry.number) if is_of(choice, moved.cell) else None

    def _moved(self, entry: Entry, moved: Situation) -> None:
        self.situation, self.number = moved, entry.number
        self.decision = self.decision if entry.decision is None else dict(entry.decision)
        if entry.event is not None:
            self.start = self.start or start_of(entry.line)
            self.event = event_of(entry.event)

    def _answered(self, line: str | bytes) -> tuple[Document, Event | None]:
        """The answer to the line, and the event when it is taken."""
        start = self.start or start_of(line)
        if self.start is None and self.event is not None and start is not None:
            reason = (
                "the shift counts seconds and has no start on the wall clock; open it with --start"
                " to send times."
            )
            return self._answer(None, id_of(line), accepted=False, reasons=[reason]), None
        if (again := self._taken_before(line, start)) is not None:
            earlier, event = again
            return self._answer(event, event.id, accepted=True, duplicate_of=earlier), None
        try:
            event = read_event(line, self.situation.cell, start, self.variants)
        except EventError as error:
            return self._answer(None, error.id, accepted=False, reasons=list(error.reasons)), None
        if event.id is not None and (known := self.journal.with_id(event.id)) is not None:
            reason = f"the id {event.id!r} stands for another event, number {known[0]}."
            return self._answer(event, event.id, accepted=False, reasons=[reason]), None
        if reasons := objections(self.situation, event):
            return self._answer(event, event.id, accepted=False, reasons=reasons), None
        return (
            self._answer(event, event.id, accepted=True, remarks=remarks(self.situation, event)),
            event,
        )

    def _taken_before(self, line: str | bytes, start: datetime | None) -> tuple[int, Event] | None:
        """The entry under which the very same event was taken already, whichever product it was
        about.
        """
        id = id_of(line)
        known = None if id is None else self.journal.with_id(id)
        if known is None:
            return None
        number, content = known
        for cell in (self.situation.cell, self.cell, *self.variants.values()):
            with suppress(EventError):
                event = read_event(line, cell, start, self.variants)
                if event.to_dict() == content:
                    return number, event
        return None

    def _answer(self, event: Event | None, id: str | None, **rest: Any) -> Document:
        known = {"event": None if event is None else event.kind, "id": id}
        return {
            "type": "answer",
            "number": self.number + 1,
            **{key: value for key, value in known.items() if value is not None},
            **rest,
        }

    def _decided(self, situation: Situation) -> Document:
        answered = over(situation) if situation.is_over else self.ask(situation)
        ahead = forecast(
            situation,
            answered.decision,
            self.settings.options.prior,
            self.settings.objective,
            plans=self.settings.policy not in SPECS,
            order=order_of(self.decider.policy, situation),
        )
        return document(situation, answered, self.number + 1, ahead)


def opened_with(journal: Journal, cell: Cell) -> tuple[Settings, datetime | None]:
    """The settings and the stated start of the shift in the journal. Raises JournalError when it is
    of another cell, or they cannot be those.
    """
    about = journal.about()
    if about["digest"] != cell.digest:
        name = about["cell"].get("name", "")
        raise JournalError(
            f"{journal.path}: the journal is of the cell {name!r} (digest {about['digest']}), this"
            f" one is {cell.name!r} (digest {cell.digest}). Give the cell as it was when the shift"
            " began, or name another journal."
        )
    settings = kept_settings(journal)
    plan = settings.options.plan
    if wrong := [] if plan is None else faults(cell, plan.schedule):
        raise JournalError(
            f"{journal.path}: shift, settings, plan: {' '.join(wrong)} It was changed, or is"
            " damaged. Name another journal."
        )
    return settings, None if about["start"] is None else datetime.fromisoformat(about["start"])


def fits(cell: Cell, variants: Mapping[str, Cell]) -> None:
    """Raises UsageError where a variant has other operators than the cell: who is there and how
    quick they are outlives a product.
    """
    mine = {name: operator.kind for name, operator in cell.operators.items()}
    wrong = []
    for variant, other in variants.items():
        theirs = {name: operator.kind for name, operator in other.operators.items()}
        if theirs != mine:
            wrong.append(
                f"variant {variant!r}: its operators are {_listed(theirs)}, those of the shift's"
                f" cell are {_listed(mine)}. Give both the same."
            )
    if wrong:
        raise UsageError("\n".join(wrong))


def _listed(operators: Mapping[str, str]) -> str:
    return ", ".join(f"{name} ({kind})" for name, kind in operators.items())


def kept_variants(journal: Journal, given: Mapping[str, Cell] | None) -> dict[str, Cell]:
    """The variants that the shift in the journal was opened with. Raises JournalError when they are
    no cells, or others than those that are given.
    """
    kept = {}
    for name, data in journal.about()["variants"].items():
        try:
            kept[name] = load(data)
        except TandemError as error:
            raise JournalError(
                f"{journal.path}: shift, variants, {name}: {str(error).splitlines()[0]} It was"
                " changed, or is damaged. Name another journal."
            ) from None
    if given and {name: cell.digest for name, cell in given.items()} != {
        name: cell.digest for name, cell in kept.items()
    }:
        raise JournalError(
            f"{journal.path}: the shift was opened with the variants"
            f" {', '.join(kept) or '(none)'}, as they were then. Go on without --variant, or name"
            " another journal."
        )
    return kept


def kept_settings(journal: Journal) -> Settings:
    """What the shift in the journal is steered by. Raises JournalError when nothing can be."""
    try:
        settings = Settings.from_dict(journal.about()["settings"])
        if settings.policy not in POLICIES:
            raise UsageError(f"there is no policy {settings.policy!r}.")
    except UsageError as error:
        raise JournalError(
            f"{journal.path}: shift, settings: {error} It was changed, or is damaged. Name another"
            " journal."
        ) from None
    return settings


def named_again(journal: Journal, kept: Settings, stated: str) -> None:
    """No file makes code run: where a journal's decider is somebody's own, by its dotted name, that
    name is to be stated again.

    Raises UsageError when it was not.
    """
    if is_dotted(kept.policy) and kept.policy != stated:
        raise UsageError(
            f"{journal.path}: the shift was begun with {kept.policy}, which is code of your own,"
            f" and no file makes code run. Name it again with --policy {kept.policy}."
        )


def _kept(line: str | bytes) -> str | bytes:
    """The line as the journal keeps it: text where it is UTF-8, and no more of it than tells that
    it is too long.
    """
    if isinstance(line, str):
        is_longer = len(line) > LONGEST_LINE
        line = line[: LONGEST_LINE + 1].encode(errors="replace" if is_longer else "surrogatepass")
    try:
        return line.decode()[: LONGEST_LINE + 1]
    except UnicodeDecodeError:
        return line[: MOST_BYTES + 1]


def _wall_clock() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
