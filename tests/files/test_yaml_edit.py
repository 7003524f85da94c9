"""What a save leaves of a YAML file that somebody wrote by hand."""

from __future__ import annotations

import copy
import random
from pathlib import Path

import pytest

import tandem
from tandem.files.load import loads
from tandem.files.validate import cell_of
from tandem.files.yaml_edit import changed

WRITTEN = """\
# Our press, as measured in May
name: press   # the old one
operators:
  # who is there
  human: {kind: human}   # Anna or Ben
  robot: {kind: robot}
tasks:
  # first the frame
  "1": {stress: 10, time: {robot: 9, human: 10}}  # heavy
  # then the lid
  2:
    time: {human: 8, robot: 7}  # measured
    # as ergonomics says
    stress: 4
    after: [1]
  3: {time: {human: 3}, after: [1, 2], stress: 1}
# the end
"""


def after(text: str, change) -> str:
    """The text when the cell in it has been changed by `change`, which gets its plain values."""
    before = loads(text).to_dict()
    document = copy.deepcopy(before)
    change(document)
    cell = cell_of(document)
    new = changed(text, before, cell)
    assert loads(new) == cell
    assert list(loads(new).tasks) == list(cell.tasks)
    return new


def test_nothing_changed_leaves_every_byte():
    assert after(WRITTEN, lambda cell: None) == WRITTEN


def test_a_time_is_changed_where_it_stands():
    def quicker(cell):
        cell["tasks"]["2"]["time"]["robot"] = 5.5

    assert after(WRITTEN, quicker) == WRITTEN.replace("robot: 7}  #", "robot: 5.5}  #")


def test_a_task_that_is_gone_takes_its_own_comment_with_it():
    def without(cell):
        del cell["tasks"]["2"]
        cell["tasks"]["3"]["after"] = ["1"]

    new = after(WRITTEN, without)
    assert "then the lid" not in new
    assert "# measured" not in new
    for kept in ("# first the frame", "# heavy", "# the end", "# Anna or Ben", "in May"):
        assert kept in new


def test_a_new_task_and_a_new_key_stand_where_they_belong():
    def more(cell):
        cell["tasks"]["4"] = {"time": {"human": 2}, "after": ["3"]}
        cell["tasks"]["1"]["label"] = "Frame"
        cell["tasks"]["2"]["label"] = "Lid: upper"

    new = after(WRITTEN, more)
    assert "  4: {time: {human: 2}, after: [3]}\n# the end" in new
    assert "robot: 9, human: 10}" in new
    assert WRITTEN.count("#") == new.count("#")


def test_tasks_in_another_order_take_their_lines_along():
    def swapped(cell):
        tasks = cell["tasks"]
        cell["tasks"] = {key: tasks[key] for key in ("2", "1", "3")}

    new = after(WRITTEN, swapped)
    assert new.index("# then the lid") < new.index("# heavy")
    assert new.index("# heavy") > new.index("# as ergonomics says")


def test_a_list_on_several_lines_becomes_one_and_the_rest_stays():
    text = WRITTEN.replace("    after: [1]\n", "    after:\n      - 1\n")

    def free(cell):
        cell["tasks"]["2"]["after"] = []

    new = after(text, free)
    assert "- 1" not in new
    assert "# as ergonomics says" in new


def test_line_ends_and_the_mark_of_windows_stay():
    text = "\ufeff" + WRITTEN.replace("\n", "\r\n")

    def more(cell):
        cell["tasks"]["4"] = {"time": {"human": 2}}
        cell["tasks"]["2"]["stress"] = 5

    new = after(text, more)
    assert new.startswith("\ufeff# Our press")
    assert new.count("\n") == new.count("\r\n")


def test_an_unsound_file_is_mended_where_it_is_wrong():
    text = WRITTEN.replace("after: [1, 2]", "after: [1, 9]")
    before = {
        **loads(WRITTEN).to_dict(),
        "tasks": {
            **loads(WRITTEN).to_dict()["tasks"],
            "3": {"time": {"human": 3}, "after": ["1", "9"], "stress": 1},
        },
    }
    assert changed(text, before, loads(WRITTEN)) == WRITTEN


def test_what_cannot_be_changed_in_place_is_written_anew():
    assert loads(changed("[1, 2]", {}, loads(WRITTEN))) == loads(WRITTEN)


EXAMPLES = [
    *sorted(Path("examples").glob("*.yaml")),
    Path("examples/ergonomics/thesis-with-facts.yaml"),
]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_any_change_of_an_example_gives_the_cell_that_was_wanted(path):
    """Times, stress, labels, tasks that come and go, in a random order of random ones."""
    text = path.read_text(encoding="utf-8")
    base = loads(text, source=str(path)).to_dict()
    chance = random.Random(path.stem)
    comments = text.count("# ")
    done = 0
    for _ in range(12):
        document = copy.deepcopy(base)
        for _ in range(chance.randint(1, 3)):
            change(document, chance)
        try:
            cell = cell_of(document)
        except tandem.CellError:
            continue
        new = changed(text, base, cell)
        assert loads(new) == cell
        assert list(loads(new).tasks) == list(cell.tasks)
        if len(cell.tasks) >= len(base["tasks"]):
            assert new.count("# ") >= comments
        done += 1
    assert done > 3


def change(document, chance) -> None:
    tasks = document["tasks"]
    name = chance.choice(list(tasks))
    task = tasks[name]
    kind = chance.choice(["time", "label", "new", "gone", "order"])
    if kind == "time" and task.get("time"):
        task["time"][chance.choice(list(task["time"]))] = chance.choice([3, 4.25, 17])
    elif kind == "label":
        task["label"] = chance.choice(["Lid: upper", "# no comment", "'quoted'", "7"])
    elif kind == "new":
        tasks["added"] = {"time": {next(iter(document["operators"])): 5}}
    elif kind == "gone":
        del tasks[name]
    else:
        names = list(tasks)
        chance.shuffle(names)
        document["tasks"] = {key: tasks[key] for key in names}
