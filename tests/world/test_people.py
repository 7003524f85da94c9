"""What people choose, what they are called, and files of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.world.arrays import Arrays, Names
from tandem.world.behaviour import KINDS, person, traits
from tandem.world.people import Answer, choose, crew, of, rested, time_factor, tired
from tandem.world.population import crowd, load
from tandem.world.state import legal, legal_of, reset


@pytest.fixture(scope="module")
def station(thesis: Cell) -> tuple[Names, Arrays]:
    names = Names.of(thesis)
    return names, names.arrays()


def answer(
    station: tuple[Names, Arrays],
    spec: str,
    suggested: str | None,
    *,
    mood: tuple[float, float, float] = (0.5, 0.5, 0.5),
) -> Answer:
    """What the human of the thesis's cell says at the start, where tasks 1, 2 and 3 are legal."""
    names, arrays = station
    state = reset(arrays)
    human = np.int32(names.operators.index("human"))
    mine = legal_of(arrays, legal(arrays, state), human)
    way = np.int32(-1 if suggested is None else names.way(suggested, ["human"]))
    return choose(
        arrays,
        state,
        person(traits(spec, names), names, arrays),
        human,
        mine,
        way,
        np.True_,
        np.array(mood, np.float32),
    )


def task(station: tuple[Names, Arrays], found: Answer) -> str | None:
    return None if found.way < 0 else station[0].ways[int(found.way)][0]


def test_the_compliant_one_does_what_is_asked_and_waits_when_asked(
    station: tuple[Names, Arrays],
) -> None:
    assert task(station, answer(station, "compliant", "2")) == "2"
    assert task(station, answer(station, "compliant", None)) is None


@pytest.mark.parametrize(
    "spec", ["random:1", "prefers:3", "adversarial", "utility:stress=1,follow=0"]
)
def test_those_who_go_their_own_way_never_wait(station: tuple[Names, Arrays], spec: str) -> None:
    assert task(station, answer(station, spec, None)) is not None


def test_the_random_one_tosses_a_coin_and_picks_every_task_alike(
    station: tuple[Names, Arrays],
) -> None:
    picks = [
        task(station, answer(station, "random:0.5", "1", mood=(0.4, (pick + 0.5) / 300, 0.5)))
        for pick in range(300)
    ]
    assert [picks.count(name) for name in ("1", "2", "3")] == [100, 100, 100]
    assert task(station, answer(station, "random:0.5", "1", mood=(0.6, 0.9, 0.5))) == "1"


def test_a_list_of_preferences_is_kept(station: tuple[Names, Arrays]) -> None:
    assert task(station, answer(station, "prefers:7,3,1", "1")) == "3", "7 is not legal yet"


def test_likings_weigh_stress_time_and_tasks_against_the_suggestion(
    station: tuple[Names, Arrays],
) -> None:
    assert task(station, answer(station, "utility:stress=1,follow=0", "1")) == "3", (
        "stress 2 instead of 10 and 11"
    )
    assert task(station, answer(station, "utility:time=1,follow=0", "3")) == "2", (
        "8 s instead of 10"
    )
    assert task(station, answer(station, "utility:stress=1,follow=5", "1")) == "1"
    assert task(station, answer(station, "utility:follow=0.5,task.2=1", "1")) == "2"
    assert task(station, answer(station, "utility:follow=0.5", None)) is None, (
        "whoever follows waits when asked"
    )


def test_the_adversary_takes_what_the_robot_does_better(station: tuple[Names, Arrays]) -> None:
    """Task 3 only the human can do: whoever harms leaves it alone."""
    assert task(station, answer(station, "adversarial", "3")) != "3"


def test_a_refusal_is_for_good_where_others_can_do_it(station: tuple[Names, Arrays]) -> None:
    refused = answer(station, "refusing:0.3", "1", mood=(0.5, 0.5, 0.2))
    assert (task(station, refused), bool(refused.refuses)) == (None, True)
    put_off = answer(station, "refusing:0.3", "3", mood=(0.5, 0.5, 0.2))
    assert (task(station, put_off), bool(put_off.refuses)) == (
        None,
        False,
    ), "only the human can do task 3"
    assert task(station, answer(station, "refusing:0.3", "1", mood=(0.5, 0.5, 0.4))) == "1"
    assert task(station, answer(station, "postponing:0.3", "1", mood=(0.5, 0.5, 0.2))) is None


def test_pace_learning_and_fatigue_multiply(station: tuple[Names, Arrays]) -> None:
    names, arrays = station
    quick = person(traits("learning:0.32193", names), names, arrays)
    assert time_factor(quick, 0.0, 1) == pytest.approx(0.8, rel=1e-4), "the second takes 80 %"
    weak = person(traits("tiring:weak,slows=0.5", names), names, arrays)
    strong = person(traits("tiring:strong,slows=0.5", names), names, arrays)
    hard = np.arange(len(arrays.way_ticks)) == names.way("2", ["human"])
    minute = 60 * names.per_second
    assert tired(weak, 0.0, hard, minute) == pytest.approx(1 - np.exp(-1.2 * 0.15), rel=1e-3)
    assert tired(strong, 0.0, hard, minute) == pytest.approx(1 - np.exp(-0.8 * 0.15), rel=1e-3)
    assert rested(weak, 0.5, minute) == pytest.approx(0.5 * np.exp(-0.05), rel=1e-3)
    assert time_factor(weak, 0.5, 0) == pytest.approx(1.25)
    assert person(traits("tiring:weak,after=10", names), names, arrays).fatigue > 0.3


def test_a_crew_is_the_person_at_each_human_and_robots_that_obey(rich: Cell) -> None:
    names = Names.of(rich)
    arrays = names.arrays()
    team = crew(arrays, person(traits("pace:2+random:0.5", names), names, arrays))
    assert team.pace.tolist() == [1, 1, 2, 2]
    assert of(team, np.int32(2)).random == 0.5
    assert of(team, np.int32(0)).random == 0.0


def test_every_kind_has_an_example_that_can_be_read(station: tuple[Names, Arrays]) -> None:
    names, arrays = station
    for name, kind in KINDS.items():
        assert kind.example.split(":")[0] == name
        assert np.isfinite(person(traits(kind.example, names), names, arrays).taste).all()


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        ("compliantt", "no such kind of person. Did you mean 'compliant'"),
        ("random", "random: p is missing. Write 'random:0.5'"),
        ("random:1.5", "p is 1.5; it goes from 0 to 1"),
        ("random:many", "'many', which is no number and no range"),
        ("prefers:3,nine", "there is no task 'nine'"),
        ("tiring:week", "there is no worker 'week'. Did you mean 'weak'"),
        ("pace:2+pace:3", "'pace' stands there twice"),
        ("prefers:1+adversarial", "each say what the person likes"),
        (
            "utility:speed=1",
            "'speed=1' says nothing here. It takes time, stress|It takes stress, time, follow",
        ),
        ("utility:task.99=1", "there is no task '99'"),
        ("compliant:5", "It takes nothing"),
        ("rendom:2+pace:0", r"(?s)'random'.*factor is 0"),
    ],
)
def test_what_cannot_be_read_is_said_with_the_way_out(
    station: tuple[Names, Arrays], spec: str, said: str
) -> None:
    with pytest.raises(UsageError, match=said):
        crowd(spec, *station)


def test_ranges_are_drawn_per_person(station: tuple[Names, Arrays]) -> None:
    people = crowd("pace:0.5..2", *station)
    pace = people.draw(np.random.default_rng(0), 400).pace
    assert (pace.min() >= 0.5, pace.max() <= 2, np.unique(pace).size > 300) == (True, True, True)
    np.testing.assert_array_equal(pace, people.draw(np.random.default_rng(0), 400).pace)


def test_the_example_population_keeps_its_parts_apart(station: tuple[Names, Arrays]) -> None:
    held_out = crowd("population:examples/people/day-shift.yaml", *station)
    train = crowd("population:examples/people/day-shift.yaml:train", *station)
    assert {group.spec for group in held_out.groups}.isdisjoint(
        group.spec for group in train.groups
    )
    assert held_out.draw(np.random.default_rng(0), 50).taste.shape == (
        50,
        len(station[1].way_ticks),
    )
    assert held_out.makes_mistakes


def test_a_population_file_is_read_strictly(station: tuple[Names, Arrays], tmp_path: Path) -> None:
    file = tmp_path / "people.yaml"
    file.write_text(
        "trian:\n"
        '  - {person: "compliant"}\n'
        "train:\n"
        '  - {person: "rendom:0.5", shares: 2}\n'
        "held_out:\n"
        "  - {person: 5}\n"
    )
    with pytest.raises(CellError) as error:
        load(str(file), station[0])
    said = str(error.value)
    for place, part in (
        (":1:1", "'trian' is no key"),
        (":4:", "Did you mean 'random'"),
        (":4:", "'shares'"),
        (":6:", "says who it is in words"),
    ):
        assert any(place in line and part in line for line in said.splitlines()), (
            place,
            part,
            said,
        )
    file.write_text('train:\n  - {person: "compliant"}\nheld_out:\n  - {person: "compliant"}\n')
    with pytest.raises(CellError, match="must not be trained with"):
        load(str(file), station[0])
    with pytest.raises(
        CellError, match=r"cannot be read: No such file.*Did you mean '.*people.yaml'"
    ):
        load(str(tmp_path / "poeple.yaml"), station[0])
