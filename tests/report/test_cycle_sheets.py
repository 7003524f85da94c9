"""The sheet of one steady cycle: what it says, and that it is enough. Crews who know nothing but
their rounds and their sheets' conditions keep to the cell, however late or early the others are,
and nobody waits for ever.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from functools import cache
from random import Random

import pytest
from tests.draw.cycles import bench, bench_front, bench_pattern, thesis_cycles
from tests.fuzz.cycles import drawn

from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.cycle.methods import plan_cycle
from tandem.plan.cycle.result import CycleFront
from tandem.report.cycle.sheet import Waiting, cycle_steps, sheet_columns, sheet_rules
from tandem.report.instructions import waits_of
from tandem.report.language import words
from tandem.schedule import checker
from tandem.schedule.cycle import PeriodicSchedule, copied, copy_of
from tandem.schedule.cycle_checker import faults
from tandem.schedule.measures import exact, made_ready
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.steady import rounds

PRODUCTS = 6


# --- what it says ---------------------------------------------------------------------------------


def test_a_sheet_has_the_steps_of_one_cycle_in_their_order() -> None:
    ben = cycle_steps(bench_front()[0], words("en"))["ben"]
    assert [(step.number, step.at, step.until, step.task, step.product) for step in ben] == [
        (1, 16, "18", "label", "launched a cycle ago (-1)"),
        (2, 22, "6 (next)", "check", "launched now (#1)"),
    ]
    assert [condition.says for condition in ben[1].begin] == [
        "previous step done",
        "Cobot on the rail done with screw: Drive 4 screws, same product",
    ]
    assert [condition.last for condition in ben[1].begin] == [False, True]


def test_a_sheet_says_with_whom_with_what_and_where() -> None:
    anna = cycle_steps(bench_front()[0], words("en"))["anna"]
    grease, lift = anna
    assert lift.means == ("zone jig (at most 2)", "together with Cobot on the rail")
    assert "Cobot on the rail ready too" in [condition.says for condition in lift.begin]
    assert "its product is there" in [condition.says for condition in grease.begin]
    assert "Cobot on the rail done with place: Place the housing, same product" in [
        condition.says for condition in lift.begin
    ]
    assert lift.then == ("Cobot on the rail with screw: Drive 4 screws, same product",)


def test_in_german_too() -> None:
    t = words("de")
    ben = cycle_steps(bench_front()[0], t)["ben"]
    assert (ben[0].product, ben[1].until) == ("vor einem Zyklus begonnen (-1)", "6 (nächster)")
    assert ben[1].begin[1].says == (
        "Cobot on the rail fertig mit screw: Drive 4 screws, dasselbe Produkt"
    )
    assert any(
        "Pause hält den Zyklus an" in said for said in sheet_rules(bench_front()[0], "ben", t)
    )
    assert any("rüsten, 5 s" in said for said in sheet_rules(bench_front()[0], "anna", t))


def test_only_humans_have_a_sheet() -> None:
    assert list(cycle_steps(bench_front()[0], words("en"))) == ["anna", "ben"]
    assert list(cycle_steps(thesis_cycles()[0], words("en"))) == ["human"]


def test_a_sheet_has_a_changeover_as_a_step_even_where_it_goes_around_the_cycle() -> None:
    document = bench().to_dict()
    document["operators"]["cobot"] = {**document["operators"]["cobot"], "kind": "human"}
    del document["operators"]["cobot"]["label"]
    cell = Cell.model_validate(document)
    front = replace(bench_front()[0], cell=cell)
    cobot = cycle_steps(front, words("en"))["cobot"]
    assert [(step.at, step.until, step.what) for step in cobot] == [
        (0, "6", "place"),
        (6, "11", "lift"),
        (11, "14", "change over to driver: 3 s"),
        (14, "21", "screw"),
        (22, "24", "change over to gripper: 2 s"),
    ]
    assert cobot[4].product == ""
    assert "product" in sheet_columns(cobot)


PRESS = {
    "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
    "zones": {"bench": {}},
    "tasks": {
        "place": {"time": {"cobot": 3}, "zone": "bench"},
        "screw": {"time": {"cobot": 4}, "after": ["place"]},
        "check": {"time": {"anna": 5}, "after": ["screw"], "zone": "bench"},
    },
}


def test_a_place_that_another_product_has_before_is_waited_for() -> None:
    """In a cycle of 10 s Anna checks from 13 to 18 s; the cobot places the next product from 10 to
    13 s and the one after it from 20 s on, all at the bench for one.
    """
    times = {"place": (0, 3, "cobot"), "screw": (3, 7, "cobot"), "check": (13, 18, "anna")}
    rows = (Assignment(a, b, task, (who,)) for task, (a, b, who) in times.items())
    pattern = PeriodicSchedule(Schedule(tuple(rows)), 10)
    result = replace(bench_front()[0], cell=cell_of(PRESS), periodic=pattern)
    (check,) = cycle_steps(result, words("en"))["anna"]
    assert [condition.says for condition in check.begin] == [
        "previous step done",
        "cobot done with screw, same product",
        "cobot done with place, product after (out of zone bench)",
    ]
    assert check.then == ("cobot with place, 2 products after (zone bench)",)


SHOP = {
    "operators": {
        "anna": {"kind": "human", "place": "bench"},
        "ben": {"kind": "human"},
        "press": {"kind": "machine", "holds": [["load", "unload"]]},
    },
    "tools": {"hook": {}},
    "walk": {"anna": {"bench-press": 3}},
    "tasks": {
        "load": {"time": {"ben": 2}, "place": "press"},
        "run": {"time": {"press": 4}, "after": ["load"]},
        "unload": {
            "time": {"anna": 2},
            "place": "press",
            "tool": {"anna": "hook"},
            "after": ["run"],
        },
        "pack": {
            "time": {"anna": 2},
            "place": "bench",
            "wait": {"after": "unload", "at_least": 3, "at_most": 9},
        },
    },
}


def test_a_sheet_says_where_to_walk_how_long_to_wait_and_that_a_machine_must_be_free() -> None:
    times = {
        "load": (0, 2, "ben"),
        "run": (2, 6, "press"),
        "unload": (6, 8, "anna"),
        "pack": (11, 13, "anna"),
    }
    rows = (Assignment(a, b, task, (who,)) for task, (a, b, who) in times.items())
    pattern = PeriodicSchedule(Schedule(tuple(rows)), 10)
    cell = cell_of(SHOP)
    assert faults(cell, pattern) == []
    sheets = cycle_steps(replace(bench_front()[0], cell=cell, periodic=pattern), words("en"))
    assert list(sheets) == ["anna", "ben"]
    assert [(step.at, step.until, step.what) for step in sheets["anna"]] == [
        (1, "3", "pack"),
        (3, "6", "go from bench to press: 3 s"),
        (6, "8", "unload"),
        (8, "1 (next)", "go from press to bench: 3 s"),
    ]
    pack, _, unload, _ = sheets["anna"]
    assert [one.says for one in pack.begin] == [
        "previous step done",
        "3 s after anna ended unload, same product, at the latest 9 s",
    ]
    assert unload.means == ("place press", "tool hook (only one)")
    assert unload.then == (
        "anna with pack, same product (3 s to 9 s later)",
        "ben with load, product after (machine press)",
    )
    (load,) = sheets["ben"]
    assert "anna done with unload, product before (press free)" in [one.says for one in load.begin]
    assert "press then holds the part until unload" in load.means


# --- that it is enough ----------------------------------------------------------------------------


def is_there(product: int) -> bool:
    """The product is one of those that are made."""
    return 0 <= product < PRODUCTS


class Crew:
    """Operators who do their rounds for some products and begin a task as soon as the conditions of
    the sheets allow. A step on a product that is not there, yet or any more, is left out; it counts
    as done as soon as it could have begun.
    """

    def __init__(self, cell: Cell, periodic: PeriodicSchedule, waiting: Waiting) -> None:
        self.cell, self.waiting = cell, waiting
        self.who = {a.task: a.operators for a in periodic}
        self.rows = {a.task: a for a in periodic}
        self.spans = {a.task: exact(a.end) - exact(a.start) for a in periodic}
        self.lap = {a.task: periodic.lap(a.start) for a in periodic}
        self.queues = {
            name: [
                (turn.assignment.task, cycle - turn.lap)
                for cycle in range(PRODUCTS + periodic.in_process)
                for turn in own.turns
            ]
            for name, own in rounds(cell, periodic).items()
        }
        self.free = {name: exact(cell.operators[name].setup) for name in cell.operators}
        self.done: dict[str, list[str]] = {name: [] for name in cell.operators}
        self.starts: dict[tuple[str, int], Decimal] = {}
        self.ends: dict[tuple[str, int], Decimal] = {}

    def work(self, random: Random) -> list[Assignment]:
        """What comes of it; every time is multiplied by 0.3 to 3."""
        found: list[Assignment] = []
        moments = {Decimal(0)}
        while any(self.queues.values()):
            assert moments, "somebody waits for ever"
            now = min(moments)
            moments.remove(now)
            for task, product in dict.fromkeys(q[0] for q in self.queues.values() if q):
                if self._ready(task, product, now) and not is_there(product):
                    self._passed(task, product, now)
                    moments.add(now)
                elif self._ready(task, product, now):
                    span = self.spans[task] * Decimal(random.randint(3, 30)) / 10
                    end = now + span.quantize(Decimal("0.000001"))
                    found.append(self._begun(task, product, now, end))
                    moments.add(end)
                    moments |= self._later(task, now, end)
            for name, queue in self.queues.items():
                if queue and (ready := self._able(name, queue[0][0])) > now:
                    moments.add(ready)
        return found

    def _able(self, name: str, task: str) -> Decimal:
        """When the operator can begin the task, with the walk and the changeover before it."""
        product = self.queues[name][0][1]
        if not is_there(product):
            return self.free[name]
        done = [self.rows[each] for each in [*self.done[name], task]]
        return self.free[name] + exact(made_ready(self.cell, name, done)[-1].seconds)

    def _later(self, task: str, start: Decimal, end: Decimal) -> set[Decimal]:
        """When waits after the task are over."""
        return {
            (start if wait.between == "start-start" else end) + exact(wait.at_least)
            for name in self.cell.tasks
            for wait in waits_of(self.cell, name)
            if wait.after == task
        }

    def _waited(self, task: str, product: int, now: Decimal) -> bool:
        """The waits of the task are over, as its sheets say."""
        for wait in waits_of(self.cell, task):
            moments = self.starts if wait.between == "start-start" else self.ends
            past = product + self.lap[wait.after] < 0
            since = moments.get((wait.after, product))
            least = exact(wait.at_least) if is_there(product) else 0
            if not past and (since is None or now < since + least):
                return False
        return True

    def _ready(self, task: str, product: int, now: Decimal) -> bool:
        mine = all(
            self.queues[name][:1] == [(task, product)] and self._able(name, task) <= now
            for name in self.who[task]
        )
        return (
            mine
            and self._waited(task, product, now)
            and all(
                not self._open(wait.task, product + wait.product, now)
                for wait in self.waiting.waits[task]
            )
            and all(
                sum(self._open(other, product + later, now) for _, other, later in room.before)
                <= room.queue.spare
                for room in self.waiting.rooms[task]
            )
        )

    def _open(self, task: str, product: int, now: Decimal) -> bool:
        """Not done yet; what a cycle before the first would have is."""
        past = product + self.lap[task] < 0
        return not past and not self.ends.get((task, product), now + 1) <= now

    def _passed(self, task: str, product: int, now: Decimal) -> None:
        self.starts[task, product] = self.ends[task, product] = now
        for name in self.who[task]:
            self.queues[name].pop(0)

    def _begun(self, task: str, product: int, now: Decimal, end: Decimal) -> Assignment:
        self.starts[task, product], self.ends[task, product] = now, end
        for name in self.who[task]:
            self.queues[name].pop(0)
            self.free[name] = end
            self.done[name].append(task)
        return Assignment(float(now), float(end), copy_of(task, product + 1), self.who[task])


def judged(cell: Cell, shift: list[Assignment]) -> list[str]:
    """What the checker finds, where every task took as long as it did. How long a wait may last at
    most is left out: those who are late cannot keep to it.
    """
    document = copied(cell.replace(stress_of_set=None), PRODUCTS).to_dict()
    for operator in document["operators"].values():
        for key in ("stress_limit", "limits", "breaks"):
            operator.pop(key, None)
    for a in shift:
        task = document["tasks"][a.task]
        task["tool"] = dict(cell.tools_for(a.task.rpartition(" #")[0], a.operators))
        for wait in task.get("wait", ()):
            wait.pop("at_most", None)
        task.pop("together", None)
        task.pop("stress", None)
        task.pop("ergonomics", None)
        span = float(exact(a.end) - exact(a.start))
        alone = len(a.operators) == 1
        task["time"] = {a.operators[0]: span} if alone else {}
        if not alone:
            task["together"] = [{"operators": list(a.operators), "time": span}]
    return checker.faults(Cell.model_validate(document), Schedule(tuple(shift)))


@cache
def random_fronts(seeds: range) -> list[tuple[int, CycleFront]]:
    found = []
    for seed in seeds:
        try:
            cell = cell_of(drawn(seed)[1])
            found.append((seed, plan_cycle(cell, time_limit=20, workers=1)))
        except (CellError, InfeasibleError):
            continue
    return found


def test_crews_that_work_by_their_sheets_keep_to_the_cell_whatever_the_delays() -> None:
    fronts = [(0, bench_front()), (0, thesis_cycles()), *random_fronts(range(100, 150))]
    shared = 0
    for seed, front in fronts:
        for result in front:
            waiting = Waiting(front.cell, result.periodic)
            shared += any(wait.freed for waits in waiting.waits.values() for wait in waits)
            for draw in range(2):
                shift = Crew(front.cell, result.periodic, waiting).work(Random(draw))
                assert judged(front.cell, shift) == [], (seed, result.periodic)
    assert min(len(fronts) - 20, shared - 5) > 0


def blind(waiting: Waiting, forgets: Callable[[object], bool]) -> Waiting:
    """A sheet that leaves some of what others do out."""
    waiting.waits = {
        task: tuple(wait for wait in waits if not forgets(wait))
        for task, waits in waiting.waits.items()
    }
    return waiting


@pytest.mark.parametrize("freed", [False, True])
def test_a_sheet_that_forgets_something_is_found_out(freed: bool) -> None:
    """Predecessors of others, or whoever has the tool or the place before."""
    found = 0
    for _, front in random_fronts(range(100, 150)):
        for result in front:
            waiting = Waiting(front.cell, result.periodic)
            blind(waiting, lambda wait: bool(wait.freed) == freed)  # type: ignore[attr-defined]
            shift = Crew(front.cell, result.periodic, waiting).work(Random(1))
            found += bool(judged(front.cell, shift))
    assert found > 0


def test_the_pattern_itself_is_what_the_crew_would_do_on_planned_times() -> None:
    """The conditions ask for nothing that the plan does not keep: each is true when its step
    begins.
    """
    for result in (*bench_front(), *thesis_cycles()):
        for steps in cycle_steps(result, words("en")).values():
            for step in steps:
                assert all(exact(one.moment) <= exact(step.at) for one in step.begin), step


def test_the_bench_has_a_pattern_of_its_own() -> None:
    assert bench_front()[0].periodic == bench_pattern()
