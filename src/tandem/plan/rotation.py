"""Job rotation by CP-SAT: the least worst person, then the least spread, then the fewest stays.

Who works where in which period is a choice; what a person bears of a measure is a sum over their
choices, or the highest. Aims are minimized one after the other, each held while the next one is
sought. Source of the aims: our own; of rotation by exposure limits Carnahan, Redfern and Norman
(2000) Ergonomics 43(4):543-560.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, Decimal
from time import monotonic
from typing import Any

from ortools.sat.python import cp_model

from tandem.cell.crew import Person
from tandem.cell.measures import Measure
from tandem.cell.written import number
from tandem.errors import InfeasibleError, NothingFoundError, UnsoundScheduleError
from tandem.plan.axes.counted import LARGEST
from tandem.plan.infeasible import Limit, minimal_core
from tandem.plan.instance import scale_of, up
from tandem.schedule.rotation import Rotation, Shift, faults, rotation_measure

WORST, SPREAD, STAYS = "worst", "spread", "stays"
MOST_VALUES = 50_000
"""Values of a sum that are told one by one."""


@dataclass(frozen=True)
class Aim:
    """One of the aims, in their order.

    Attributes:
      what: `worst` or `spread` of a measure, or `stays`.
      measure: its name; empty for stays.
      value: of the rotation found, exact.
      proven: no rotation that is as good in every aim before is better in this one.
      rounded: it was counted in rounded units, so that it is proven to twelve digits.
    """

    what: str
    measure: str
    value: Decimal
    proven: bool
    rounded: bool = False


@dataclass(frozen=True)
class Rotated:
    """A rotation and how good it is.

    Attributes:
      aims: what was sought, in the order of importance.
      wall_s: time spent, seconds.
    """

    rotation: Rotation
    aims: tuple[Aim, ...]
    wall_s: float
    seed: int

    @property
    def proven(self) -> bool:
        """Every aim is."""
        return all(aim.proven for aim in self.aims)


def rotate(
    shift: Shift,
    measures: Sequence[Measure],
    *,
    staying: bool = False,
    time_limit: float = 60.0,
    workers: int = 1,
    seed: int = 0,
) -> Rotated:
    """The rotation that is best in `worst` and `spread` of the first measure, then of the next, and
    then has the fewest stays.

    Args:
      staying: everybody keeps one role for the whole shift: what there is without rotation. The
        limits of what people bear are not asked then.
      time_limit: seconds for all aims together.

    Raises:
      InfeasibleError: no rotation keeps the limits; with a minimal set of what cannot be kept.
      NothingFoundError: none was found in the time.
    """
    begun = monotonic()
    if staying:
        shift = replace(shift, crew=shift.crew.without_limits())
    asked = _Asked(shift, tuple(measures), staying, begun + time_limit, workers, seed)
    model = _Model(shift, _everything(shift), staying)
    if (first := model.solved(asked)) is None:
        if model.status == cp_model.INFEASIBLE:
            raise _infeasible(asked)
        raise NothingFoundError(f"no rotation was found within {number(time_limit)} s.")
    rotation, aims, proven = first, [], True
    wanted = [(what, m) for m in measures for what in (WORST, SPREAD)]
    for what, measure in [*wanted, *([] if staying else [(STAYS, None)])]:
        aim, is_exact = model.aim(what, measure)
        if proven:  # what is not best in one aim is not made worse in it for the sake of the next
            better, proven = model.minimized(aim, asked)
            rotation = better or rotation
        aims.append((what, measure, proven, not is_exact))
    if wrong := faults(rotation):
        raise UnsoundScheduleError(wrong)
    told = tuple(
        Aim(what, "" if m is None else m.name, _value(rotation, what, m), proven, rounded)
        for what, m, proven, rounded in aims
    )
    return Rotated(rotation, told, monotonic() - begun, seed)


def _value(rotation: Rotation, what: str, measure: Measure | None) -> Decimal:
    if measure is None:
        return Decimal(rotation.stays)
    return rotation.worst(measure) if what == WORST else rotation.spread(measure)


@dataclass(frozen=True)
class _Asked:
    shift: Shift
    measures: tuple[Measure, ...]
    staying: bool
    until: float
    workers: int
    seed: int


@dataclass(frozen=True)
class _Values:
    """What a whole number can come to. Every value is told to the solver where they are not too
    many: bounds of numbers of twelve digits would else move in steps of one.

    Attributes:
      values: None where there are too many: all from 0 to `most`.
    """

    most: int
    values: frozenset[int] | None

    def plus(self, others: set[int]) -> _Values:
        """With one of these added."""
        most = self.most + max(others)
        if self.values is None or len(self.values) * len(others) > MOST_VALUES:
            return _Values(most, None)
        return _Values(most, frozenset(a + b for a in self.values for b in others))

    def with_(self, other: _Values) -> _Values:
        """This or the other."""
        most = max(self.most, other.most)
        if self.values is None or other.values is None:
            return _Values(most, None)
        return _Values(most, self.values | other.values)

    def differences(self) -> _Values:
        """One value less another that is not above it."""
        if self.values is None or len(self.values) ** 2 > MOST_VALUES:
            return _Values(self.most, None)
        return _Values(
            self.most, frozenset(a - b for a in self.values for b in self.values if a >= b)
        )

    def variable(self, model: cp_model.CpModel, name: str) -> cp_model.IntVar:
        """A variable that has these values alone."""
        if self.values is None:
            return model.new_int_var(0, self.most, name)
        return model.new_int_var_from_domain(cp_model.Domain.from_values(sorted(self.values)), name)


class _Model:
    """Who works where when, with some of what limits it."""

    def __init__(self, shift: Shift, kept: Iterable[Limit], staying: bool):
        self.shift, self.model = shift, cp_model.CpModel()
        self.status: Any = cp_model.UNKNOWN
        self.people = shift.crew.people
        self.periods = range(len(shift.periods))
        self.x = {
            (p, role, t): self.model.new_bool_var(f"{person.name} as {role} in {t + 1}")
            for p, person in enumerate(self.people)
            for role in shift.roles
            for t in self.periods
        }
        self._everybody_has_one_role()
        if staying:
            self._nobody_changes()
        for limit in kept:
            self._keep(limit)

    def _everybody_has_one_role(self) -> None:
        for t in self.periods:
            for role in self.shift.roles:
                self.model.add_exactly_one(self.x[p, role, t] for p in range(len(self.people)))
            for p in range(len(self.people)):
                self.model.add_at_most_one(self.x[p, role, t] for role in self.shift.roles)

    def _nobody_changes(self) -> None:
        for (p, role, t), chosen in self.x.items():
            if t:
                self.model.add(chosen == self.x[p, role, 0])

    def _keep(self, limit: Limit) -> None:
        """One thing that limits the people, by its place in their file."""
        p = next(p for p, one in enumerate(self.people) if one.name == limit.where[1])
        person, what = self.people[p], limit.where[2]
        for role in self.shift.roles:
            for t in self.periods:
                able = what not in ("roles", "cannot") or self.shift.able(person, role)
                there = what != "periods" or self.shift.there(person, t)
                if not (able and there):
                    self.model.add(self.x[p, role, t] == 0)
        if what == "limits":
            most = self.shift.crew.most(person)[limit.where[3]]
            self._bear(p, rotation_measure(limit.where[3], self.shift.cell), most)

    def _bear(self, p: int, measure: Measure, most: Decimal) -> None:
        costs = self._costs(p, measure)
        if measure.what == "peak":
            for key, value in costs.items():
                if value > most:
                    self.model.add(self.x[key] == 0)
            return
        # rounded up on the one side and down on the other: never more than the limit
        scale, _ = scale_of([*costs.values(), most], sum(costs.values(), Decimal(0)), LARGEST)
        allowed = int((most * scale).to_integral_value(ROUND_FLOOR))
        self.model.add(sum(up(c * scale) * self.x[key] for key, c in costs.items()) <= allowed)

    def _costs(self, p: int, measure: Measure) -> dict[tuple[int, str, int], Decimal]:
        person = self.people[p]
        each = {role: self.shift.each(measure, person, role) for role in self.shift.roles}
        return {
            (p, role, t): each[role] * self.shift.share(measure, t)
            for role in self.shift.roles
            for t in self.periods
            if each[role]
        }

    def aim(self, what: str, measure: Measure | None) -> tuple[cp_model.IntVar, bool]:
        """A variable of the aim, and whether nothing was rounded."""
        if measure is None:
            return self._stays(), True
        loads, values, is_exact = self._loads(measure)
        worst = values.variable(self.model, f"worst {measure.name}")
        self.model.add_max_equality(worst, loads)
        if what == WORST:
            return worst, is_exact
        least = values.variable(self.model, f"least {measure.name}")
        self.model.add_min_equality(least, loads)
        spread = values.differences().variable(self.model, f"spread {measure.name}")
        self.model.add(spread == worst - least)
        return spread, is_exact

    def _loads(self, measure: Measure) -> tuple[list[cp_model.IntVar], _Values, bool]:
        """What each person bears, in whole units, and all that anybody can come to."""
        costs = [self._costs(p, measure) for p in range(len(self.people))]
        sums = max((sum(of.values(), Decimal(0)) for of in costs), default=Decimal(0))
        scale, is_exact = scale_of([c for of in costs for c in of.values()], sums, LARGEST)
        whole = [{key: up(c * scale) for key, c in of.items()} for of in costs]
        unit = math.gcd(*(c for of in whole for c in of.values())) or 1
        loads, everything = [], _Values(0, frozenset({0}))
        for of_person in whole:
            units = {key: c // unit for key, c in of_person.items()}
            values = self._reached(units, is_peak=measure.what == "peak")
            load = values.variable(self.model, measure.name)
            terms = [c * self.x[key] for key, c in units.items()]
            if measure.what == "peak":
                self.model.add_max_equality(load, [0, *terms])
            else:
                self.model.add(load == sum(terms))
            loads.append(load)
            everything = everything.with_(values)
        return loads, everything, is_exact

    def _reached(self, units: Mapping[tuple[int, str, int], int], *, is_peak: bool) -> _Values:
        """What one person can come to, in one role at most each period."""
        if is_peak:
            return _Values(max(units.values(), default=0), frozenset({0, *units.values()}))
        found = _Values(0, frozenset({0}))
        for t in self.periods:
            found = found.plus({0, *(c for (_, _, at), c in units.items() if at == t)})
        return found

    def _stays(self) -> cp_model.IntVar:
        stays = []
        for (p, role, t), now in self.x.items():
            if not t:
                continue
            same = self.model.new_bool_var("")
            self.model.add_bool_or(same, ~now, ~self.x[p, role, t - 1])
            stays.append(same)
        total = self.model.new_int_var(0, len(stays), "stays")
        self.model.add(total == sum(stays))
        return total

    def solved(self, asked: _Asked) -> Rotation | None:
        """Any rotation; None when there is none, or none was found in time."""
        return self._solve(asked)[0]

    def minimized(self, aim: cp_model.IntVar, asked: _Asked) -> tuple[Rotation | None, bool]:
        """The best rotation in this aim, which is held from now on; and whether that is proven."""
        self.model.minimize(aim)
        found, solver = self._solve(asked)
        self.model.clear_objective()  # type: ignore[no-untyped-call]
        if found is None:
            return None, False
        self.model.add(aim <= solver.value(aim))
        self.model.clear_hints()  # type: ignore[no-untyped-call]
        for chosen in self.x.values():
            self.model.add_hint(chosen, solver.value(chosen))
        return found, self.status == cp_model.OPTIMAL

    def _solve(self, asked: _Asked) -> tuple[Rotation | None, cp_model.CpSolver]:
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = asked.workers
        solver.parameters.random_seed = asked.seed
        solver.parameters.max_time_in_seconds = max(0.0, asked.until - monotonic())
        self.status = solver.solve(self.model)
        if self.status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            return None, solver
        who: tuple[Mapping[str, str], ...] = tuple(
            {
                role: self.people[p].name
                for role in self.shift.roles
                for p in range(len(self.people))
                if solver.boolean_value(self.x[p, role, t])
            }
            for t in self.periods
        )
        return Rotation(self.shift, who), solver


# --- what limits it, and why there is none --------------------------------------------------------


def _everything(shift: Shift) -> list[Limit]:
    """All that limits who works where; each can be lifted by leaving it out of the file."""
    return [limit for person in shift.crew.people for limit in _of_person(shift, person)]


def _of_person(shift: Shift, person: Person) -> Iterable[Limit]:
    name = person.name
    if person.roles is not None:
        yield Limit(
            f"that {name!r} works as {_named(person.roles)} only", ("people", name, "roles")
        )
    if person.cannot:
        yield Limit(f"that {name!r} cannot do {_named(person.cannot)}", ("people", name, "cannot"))
    if person.periods is not None:
        periods = ", ".join(map(str, person.periods))
        yield Limit(f"that {name!r} is there in period {periods} only", ("people", name, "periods"))
    for measure, most in shift.crew.most(person).items():
        yield Limit(
            f"the limit {measure}={most:f} of {name!r}", ("people", name, "limits", measure)
        )


def _named(names: Sequence[str]) -> str:
    return " and ".join(repr(name) for name in names) or "nobody"


def _infeasible(asked: _Asked) -> InfeasibleError:
    shift, what = asked.shift, "no rotation keeps all that is stated"
    if asked.staying:
        return InfeasibleError("without rotation: nobody can stay in one role all shift")
    if len(shift.crew.people) < len(shift.roles):
        return InfeasibleError(
            f"{what}: the plan has {len(shift.roles)} roles ({', '.join(shift.roles)}), but there"
            f" are {len(shift.crew.people)} people ({_named([p.name for p in shift.crew.people])})."
        )

    def possible(limits: Sequence[Limit]) -> bool | None:
        model = _Model(shift, limits, staying=False)
        found = model.solved(asked)
        return None if found is None and model.status != cp_model.INFEASIBLE else found is not None

    core = minimal_core(_everything(shift), possible)
    names = [limit.words for limit in core.items]
    together = (
        f"{names[0]} cannot be kept."
        if len(names) == 1
        else f"{', '.join(names[:-1])} and {names[-1]} cannot be kept together."
    )
    conflict = {**core.to_dict(), "least": [], "without": []}
    reasons = [together[0].upper() + together[1:], *core.doubt(), *_least(asked, core.items)]
    return InfeasibleError(f"{what}.", reasons, conflict)


def _least(asked: _Asked, lifted: Sequence[Limit]) -> Iterable[str]:
    """What the worst person bears at least when these limits are lifted and all others kept, of
    each measure that one of them is of.
    """
    for name in dict.fromkeys(one.where[3] for one in lifted if one.where[2] == "limits"):
        measure = rotation_measure(name, asked.shift.cell)
        kept = [one for one in _everything(asked.shift) if one not in lifted]
        model = _Model(asked.shift, kept, staying=False)
        found, proven = model.minimized(model.aim(WORST, measure)[0], asked)
        if found is not None and proven:
            yield (
                f"Without {'this limit' if len(lifted) == 1 else 'these limits'}, the person who"
                f" bears most of {name} has at least {float(found.worst(measure)):.4g}."
            )
