"""Job rotation: the search beside an enumeration, its judge, and why there is none."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from random import Random

import pytest
from tests.fuzz import rotation as fuzz

from tandem.cell.crew import Crew, Person
from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, UsageError
from tandem.plan.rotation import rotate
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.rotation import (
    Period,
    Rotation,
    Shift,
    faults,
    measures_of,
    periods_of,
    rotation_measure,
    unfit,
)


def station(crew: Crew, periods: int = 4) -> Shift:
    """A hard place and an easy one: 9 and 1 points of stress a product, ten products a period."""
    cell = Cell.model_validate(
        {
            "operators": {"hard": {"kind": "human"}, "easy": {"kind": "human"}},
            "tasks": {
                "lift": {"time": {"hard": 4}, "stress": 9},
                "check": {"time": {"easy": 6}, "stress": 1},
            },
        }
    )
    schedule = Schedule((Assignment(0, 4, "lift", ("hard",)), Assignment(0, 6, "check", ("easy",))))
    return Shift(cell, schedule, (Period(1.0, 10),) * periods, crew, 6.0)


def crew(*people: Person, **limits: float) -> Crew:
    return Crew(people, {f"{k}:stress": Decimal(v) for k, v in limits.items()})


def test_two_people_take_turns_so_that_both_bear_the_same():
    shift = station(crew(Person("anna"), Person("ben")))
    dose = rotation_measure("dose:stress", shift.cell)
    found = rotate(shift, [dose])
    assert found.proven
    assert [aim.value for aim in found.aims] == [200, 0, 0]  # 2 x 90 + 2 x 10; equal; never stays
    assert faults(found.rotation) == []
    alone = rotate(shift, [dose], staying=True)
    assert alone.rotation.worst(dose) == 360


@pytest.mark.parametrize("seed", range(25))
def test_the_search_agrees_with_an_enumeration_of_all_rotations(seed):
    chance = Random(seed)
    people, roles, periods = chance.choice(fuzz.SIZES[:4])
    one = fuzz.drawn(chance, people=people, roles=roles, periods=periods)
    assert fuzz.difference(one) is None


def test_five_people_and_four_periods_are_proven_and_agree_with_the_enumeration():
    one = fuzz.drawn(Random(3), people=5, roles=2, periods=4)
    people = {name: {**who, "limits": {}, "periods": None} for name, who in one.people.items()}
    one = replace(one, products=[5] * 4, people=people, limits={}, measures=["dose:stress"])
    wanted = fuzz.best(one, with_stays=False)
    found = fuzz.searched(one)
    assert found is not None
    assert found.proven
    assert [aim.value for aim in found.aims][:2] == wanted


def test_the_judge_finds_each_fault():
    shift = station(
        crew(
            Person("anna", periods=(1,)), Person("ben", cannot=("lift",)), Person("cem"), dose=150
        ),
        periods=2,
    )
    good = Rotation(shift, ({"hard": "anna", "easy": "ben"}, {"hard": "cem", "easy": "ben"}))
    assert faults(good) == []
    for who, said in [
        (({"hard": "anna", "easy": "ben"},), "there are 1 periods"),
        (({"hard": "anna"}, good.who[1]), "the roles are"),
        (({"hard": "cem", "easy": "cem"}, good.who[1]), "'cem' has 2 roles at once"),
        (({"hard": "dan", "easy": "ben"}, good.who[1]), "'dan' is nobody"),
        ((good.who[0], {"hard": "anna", "easy": "ben"}), "period 2: 'anna' is not there"),
        (({"hard": "ben", "easy": "anna"}, good.who[1]), "'ben' cannot work as 'hard'"),
        (({"hard": "cem", "easy": "ben"}, good.who[1]), "'cem': comes to 180 of dose:stress"),
    ]:
        assert any(said in fault for fault in faults(Rotation(shift, who))), said


def test_what_cannot_be_kept_is_a_smallest_set():
    everybody = [Person("anna"), Person("ben", limits={"peak:stress": Decimal(5)}), Person("cem")]
    shift = station(crew(*everybody, dose=130))
    with pytest.raises(InfeasibleError, match="cannot be kept together") as error:
        rotate(shift, [])
    told = error.value.to_dict()["infeasible"]
    assert told["minimal"]
    # 400 points are to be borne: without ben at the hard place two people bear 360 of them
    assert {tuple(one["where"]) for one in told["together"]} == {
        ("people", "anna", "limits", "dose:stress"),
        ("people", "cem", "limits", "dose:stress"),
        ("people", "ben", "limits", "peak:stress"),
    }


def test_too_few_people_are_told_before_anything_else():
    with pytest.raises(InfeasibleError, match=r"2 roles \(hard, easy\), but there are 1 people"):
        rotate(station(crew(Person("anna"))), [])


def test_a_limit_on_the_very_value_is_kept():
    shift = station(crew(Person("anna"), Person("ben"), dose=200))
    assert rotate(shift, []).rotation.shift is shift
    with pytest.raises(InfeasibleError):
        rotate(station(crew(Person("anna"), Person("ben"), dose=199.999)), [])


def test_an_assessment_of_the_person_goes_before_that_of_the_role():
    cell = Cell.model_validate(
        {
            "operators": {"anna": {"kind": "human"}, "ben": {"kind": "human"}},
            "tasks": {
                "lift": {
                    "time": {"anna": 4, "ben": 4},
                    "ergonomics": [
                        {"method": "reba", "score": 9, "operators": ["anna"]},
                        {"method": "reba", "score": 5, "operators": ["ben"]},
                    ],
                },
            },
        }
    )
    schedule = Schedule((Assignment(0, 4, "lift", ("anna",)),))
    people = Crew((Person("anna"), Person("ben"), Person("guest")))
    shift, peak = (
        Shift(cell, schedule, (Period(60, 9),), people, 4),
        rotation_measure("peak:reba", cell),
    )
    assert [shift.each(peak, person, "anna") for person in people.people] == [9, 5, 9]
    assert rotate(shift, [peak]).rotation.who == ({"anna": "ben"},)


def test_measures_that_are_not_told_over_roles_are_refused_with_a_way_out():
    cell = station(crew()).cell
    for name, said in [
        ("stress", "Take dose:stress"),
        ("worst:dose:stress", "leave out `worst:`"),
        ("fatigue:stress:0.01:0.02", "depends on the order of tasks"),
        ("dose:rula", "no task of the cell has a value"),
    ]:
        with pytest.raises(UsageError, match=said):
            rotation_measure(name, cell)
    assert measures_of(cell) == ["dose:stress"]


def test_what_does_not_fit_the_plan_is_told_all_at_once():
    people = crew(
        Person("anna", roles=("hart",), cannot=("lifd",)), Person("ben", periods=(5,)), peek=1
    )
    told = [str(fault) for fault in unfit(station(people))]
    assert [one.partition(":")[0] for one in told] == [
        "limits.peek",
        "people.anna.roles.0",
        "people.anna.cannot.0",
        "people.ben.periods.0",
    ]
    assert "hard" in told[1]
    assert "lift" in told[2]


def test_products_are_whole_and_spread_by_minutes():
    assert [one.products for one in periods_of((120, 90), 56.0)] == [128, 96]
    assert [one.products for one in periods_of((60, 60, 60), 1.0, 10)] == [4, 3, 3]
    assert sum(one.products for one in periods_of((120, 120, 90), 1.0, 421)) == 421


def test_values_of_many_digits_are_proven_as_quickly_as_small_ones():
    """A share of 9 products in 10,800 s ends nowhere: counted in units of a millionth of a
    millionth, bounds moved in steps of one, and a crew of two was not proven within a minute.
    """
    one = fuzz.Drawn(
        tasks={"t1": ("role0", 5, 3), "t2": ("role0", 5, 3), "t3": ("role0", 3, 2)},
        products=[9, 9, 9],
        people={
            name: {"roles": None, "cannot": [], "periods": None, "limits": {}}
            for name in ("anna", "ben")
        },
        limits={},
        measures=["time-weighted:stress"],
    )
    assert fuzz.difference(one) is None
