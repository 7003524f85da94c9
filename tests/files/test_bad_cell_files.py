"""Bad input: one message, all faults in it, each with its place; never a traceback of another
kind.
"""

from __future__ import annotations

import contextlib
import copy
import json
import os
import random
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from tests.effort import calls
from tests.strategies import cells

from tandem.errors import CellError
from tandem.files.formats.table import FORMATS
from tandem.files.load import dumps, load, loads
from tandem.files.validate import MOST, cell_of

GOOD = """\
format: 1
operators:
  robot: {kind: robot}
  human: {kind: human}
tasks:
  1: {time: {robot: 9, human: 10}, stress: 10}
  2: {time: {human: 10}, after: [1]}
"""


def told(text: str, form: str | None = None) -> list[str]:
    """The faults of a text, as a person reads them."""
    with pytest.raises(CellError) as caught:
        loads(text, form, source="cell.yaml")
    return [str(fault) for fault in caught.value.faults]


def test_the_good_file_is_good():
    assert list(loads(GOOD).tasks) == ["1", "2"]


LINES = [
    (
        "  2: {time: {human: 0}}",
        r"7:14: task '2': time of 'human' is 0, but a time is more than 0 s. Leave 'human' out",
    ),
    ("  2: {time: {human: -1.5}}", r"7:14: .*is -1.5, but a time is more than 0"),
    ("  2: {time: {human: .nan}}", r"7:14: .*is nan, but must be a number"),
    ("  2: {time: {human: -.inf}}", r"7:14: .*is -inf, but must be a number"),
    ("  2: {time: {human: 1e400}}", r"7:14: .*is inf, but must be a number"),
    ("  2: {time: {human: 99999999}}", r"7:14: .*is 99999999, but at most 10000000"),
    ("  2: {time: {human: '10'}}", r"7:14: .*is '10', which is text.* Write 10 without quotes"),
    ('  2: {time: {human: "1,5"}}', r"7:14: .*is '1,5', which is text.* Write 1.5\."),
    ("  2: {time: {human: 1,5}}", r"7:23: .*'5' stands here like a key.*decimal comma"),
    ("  2: {time: {human: ten}}", r"7:14: .*is 'ten', but a number is needed"),
    ("  2: {time: {human: true}}", r"7:14: .*is true, but a number is needed"),
    ("  2: {time: {human: }}", r"7:14: .*is empty, but a number is needed"),
    ("  2: {time: {human: [1]}}", r"7:14: .*is a list, but a number is needed"),
    (
        "  2: {time: 5}",
        r"7:7: task '2': time is 5, but a mapping is needed, such as `{robot: 9, human: 10}`",
    ),
    ("  2: {time: {human: 1}, stress: -2}", r"7:25: task '2': stress is -2, but must be 0 or more"),
    ("  2: {time: {human: 1}, stress: {human: x}}", r"7:34: task '2': stress of 'human' is 'x'"),
    ("  2: {time: {human: 1}, spread: x}", r"7:25: task '2': spread is 'x'"),
    (
        "  2: {time: {human: 1}, after: 1}",
        r"7:25: task '2': after is 1, but a list is needed, such as `after: \[1\]`",
    ),
    (
        "  2: {time: {human: 1}, after: }",
        r"7:25: task '2': after is empty, but a list is needed.* or leave the key out",
    ),
    (
        "  2: {time: {human: 1}, after: [[1]]}",
        r"7:33: task '2': after is a list, but a name is needed",
    ),
    (
        "  2: {time: {human: 1}, aftr: [1]}",
        r"7:25: task '2': 'aftr' is no key .* Did you mean 'after'",
    ),
    ("  2: {duration: {human: 1}}", r"7:7: task '2': 'duration' is no key .* Did you mean 'time'"),
    (
        "  2: {time: {human: 1}, xyz: 1}",
        r"7:25: task '2': 'xyz' is no key .* Known: label, part, time",
    ),
    (
        "  2: {time: {human: 1}, deadline: 0}",
        r"7:25: .*deadline is 0, but a deadline is later than 0 s",
    ),
    (
        "  2: {time: {human: 1}, wait: {after: 1, at_last: 4}}",
        r"7:42: task '2': wait: 'at_last' is no key .* Did you mean 'at_least'",
    ),
    (
        "  2: {time: {human: 1}, wait: {at_least: 4}}",
        r"7:25: task '2': wait: `after` is missing: which task is waited for",
    ),
    (
        "  2: {time: {human: 1}, wait: [{after: 1, between: starts}]}",
        r"7:43: task '2': wait: between is 'starts', but must be end-start or start-start",
    ),
    (
        "  2: {time: {human: 1}, wait: 40}",
        r"7:25: task '2': wait is 40, but a list is needed, such as `wait: \[{after: 1,",
    ),
    (
        "  2: {time: {human: 1}, wait: {after: 3, at_least: 4}}",
        r"7:32: task '2' waits after '3', which is no task",
    ),
    ("  2: soon", r"7:3: task '2' is the text 'soon', but a mapping is needed"),
    ("  2: {together: [{operators: [human], time: 3}]}", r"7:19: .*needs two operators at least"),
    (
        "  2: {together: [{operators: [human, robot]}]}",
        r"7:18: task '2': together: `time` is missing",
    ),
    ("  2: {together: [{operators: [human, robot], time: 0}]}", r"7:46: .*Leave the group out"),
    ("  '': {time: {human: 1}}", r"7:3: .*'' is no name"),
    (
        "  2: {time: {human: 1}}\nzones: {jig: {capacity: 0}}",
        r"8:15: zone 'jig': capacity is 0, but must be 1 or more",
    ),
    (
        "  2: {time: {human: 1}}\nzones: {jig: {capacity: 1.5}}",
        r"8:15: zone 'jig': capacity is 1.5, but a whole number is needed",
    ),
    (
        "  2: {time: {human: 1}}\nsame_operator: [[1, 2, 2]]",
        r"8:17: same_operator holds 3 values, but 2 are needed",
    ),
    (
        "  2: {time: {human: 1}}\nstress_of_set: {1: -1}",
        r"8:17: stress_of_set of '1' is -1, but must be 0 or more",
    ),
    ("  2: {time: {human: 1}}\nformat: 2", r"8:1: 'format' is stated twice, first in line 1"),
    (
        "  1: {time: {human: 1}}",
        r"7:3: '1' is stated twice, first in line 6 and again here in line 7",
    ),
    ("  2: {time: {human: 1, human: 2}}", r"7:24: 'human' is stated twice, first in line 7"),
    (
        "  2: {time: {human: 1}, after: [2.0]}",
        r"7:33: task '2' comes after '2.0', which is no task. Known: '1', '2'",
    ),
]


@pytest.mark.parametrize(("line", "sentence"), LINES, ids=[line.strip() for line, _ in LINES])
def test_a_slip_is_told_in_one_sentence_at_its_place(line, sentence):
    text = "\n".join([*GOOD.splitlines()[:-1], line])
    found = told(text)
    assert len(found) == 1, found
    with pytest.raises(CellError, match=f"cell.yaml:{sentence}"):
        loads(text, source="cell.yaml")


HEADS = [
    ("tasks: {1: {time: {h: 1}}}", ["1:1: `operators` is missing"]),
    ("operators: {h: {kind: human}}", ["1:1: `tasks` is missing"]),
    ("operators: {}\ntasks: {}", ["1:1: `operators` is empty", "2:1: `tasks` is empty"]),
    (
        "operators: {h: {}}\ntasks: {1: {time: {h: 1}}}",
        ["1:13: operator 'h': `kind` is missing. Write `kind: human`, `kind: robot` or"],
    ),
    (
        "operators: {h: {kind: Robot}}\ntasks: {1: {time: {h: 1}}}",
        [
            "1:17: operator 'h': kind is 'Robot', but must be human, robot or machine. Did you"
            " mean 'robot'"
        ],
    ),
    (
        "operators: {h: {kind: human}, p: {kind: machin, holds: [[1, 2]]}}\n"
        "tasks: {1: {time: {h: 1}}, 2: {time: {h: 1}, after: [1]}}",
        ["1:35: operator 'p': kind is 'machin', but must be human, robot or machine. Did you"],
    ),
    (
        "operators: [h]\ntasks: {1: {time: {h: 1}}}",
        ["1:1: operators is a list, but a mapping is needed"],
    ),
    ("- 1\n- 2", ["1:1: the file holds a list. A cell file is a mapping"]),
    ("just words", ["1:1: the file holds the text 'just words'"]),
    (
        "format: 2\noperators: {h: {kind: human}}\ntasks: {1: {time: {h: 1}}}",
        ["1:1: format is 2, but this version of Tandem reads format 1"],
    ),
]


@pytest.mark.parametrize(("text", "sentences"), HEADS, ids=[text[:30] for text, _ in HEADS])
def test_a_wrong_frame_is_told_without_noise_about_what_follows(text, sentences):
    found = told(text)
    assert len(found) == len(sentences), found
    assert all(
        fault.startswith(f"cell.yaml:{sentence}")
        for fault, sentence in zip(found, sentences, strict=True)
    ), found


def test_faults_of_form_and_of_fit_come_together_in_the_order_of_lines():
    found = told(
        "operators:\n"
        "  robot: {kind: robot, stress_limit: 1}\n"
        "  human: {kind: humn}\n"
        "tasks:\n"
        "  1: {time: {robot: 0}, after: [3]}\n"
        "  2: {tiem: {robot: 1}}\n"
        "  3: {time: {robto: 2}, after: [4, {}, 1]}\n"
    )
    assert [fault.split(": ")[0].removeprefix("cell.yaml:") for fault in found] == [
        "2:24",
        "3:11",
        "5:14",
        "5:33",
        "6:7",
        "7:14",
        "7:33",
        "7:36",
    ]
    assert "wait for each other" in found[3]
    assert "which is no task" in found[6]


def test_what_a_misspelled_key_should_have_said_is_not_missed_as_well():
    """No "nobody can do it" behind `tiem`, and no "never meet" behind an unreadable capacity."""
    assert len(told(GOOD + "  3: {tiem: {human: 3}}\n")) == 1
    assert (
        len(
            told(
                GOOD + "  3: {together: [{operators: [robot, human], time: 2}], zone: jig}\n"
                "zones: {jig: {capacity: two}}\n"
            )
        )
        == 1
    )
    assert len(told(GOOD + "  3: {time: {human: 0}, deadline: 5}\n")) == 1


def test_hundreds_of_faults_are_cut_to_what_a_person_reads():
    found = told(GOOD + "".join(f"  t{n}: {{time: {{human: 0}}}}\n" for n in range(200)))
    assert len(found) == MOST + 1
    assert found[-1] == "and 150 more. Mend these first."


def test_tags_anchors_aliases_and_second_documents_are_refused_together():
    found = told(
        "operators: &all {h: !!python/object/apply:os.system [echo]}\n"
        "tasks: *all\n"
        "name: !cell x\n"
        "---\n"
        "a: 1\n"
    )
    assert [fault.split(": ")[0] for fault in found] == [
        "cell.yaml:1:12",
        "cell.yaml:1:21",
        "cell.yaml:2:8",
        "cell.yaml:3:7",
        "cell.yaml:4:1",
    ]
    assert "!!python/object/apply:os.system is a tag" in found[1]
    assert "anchors; write the value out" in found[2]


def test_an_exploding_file_is_refused_at_once():
    """A billion laughs: ten levels of ten aliases each."""
    lines = ["a0: &a0 [x, x]"] + [
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 11)
    ]
    text, found = "\n".join(lines), []
    assert calls(lambda: found.extend(told(text))) < 100_000
    assert "is an anchor" in found[0]
    assert len(found) <= 20


@pytest.mark.parametrize(
    "text",
    ["[" * 100_000, "{a: " * 100_000, "- " * 50_000, '{"a":' * 100_000],
    ids=["lists", "flow", "blocks", "json"],
)
def test_a_file_nested_without_end_is_refused_at_once(text):
    found = []
    assert calls(lambda: found.extend(told(text))) < 10 * len(text)
    assert any(word in found[0] for word in ("nests deeper", "not well-formed"))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "operators:\n\th: {kind: human}\n",
            "cell.yaml:2:1: a tab stands here. YAML indents with blanks",
        ),
        ("operators: {h: {kind: human}\ntasks: {}\n", "cell.yaml:.*not well-formed YAML"),
        ("tasks: 'open", "cell.yaml:.*not well-formed YAML"),
        ("tasks: *nobody", "repeats an anchored value"),
        ("? [1, 2]\n: 3", "cell.yaml:1:3: a key must be a plain name"),
        ("", "cell.yaml: the file is empty"),
        ("  \n\n", "cell.yaml: the file is empty"),
        ("# only a remark\n", "cell.yaml: the file is empty"),
        ("a: \x07", "cell.yaml:1:4: the control character 0x07"),
        (
            '{"operators": {"h": {"kind": "human"}}, "tasks": {"1": {"time": {"h": NaN}}}}',
            "cell.yaml:1:66: .*is nan, but must be a number",
        ),
        ('{"operators": {}, "operators": {}}', "cell.yaml:1:19: 'operators' is stated twice"),
        ('{"a": 1,}', "cell.yaml:1:9: this is not well-formed JSON: a text in .quotes. is missing"),
        ('{"a": 1', "cell.yaml:1:8: .*the text ends too early"),
        ('{"a" 1}', "cell.yaml:1:6: .*a colon is missing"),
        ('{"a": [1 2]}', "cell.yaml:1:10: .*a comma or ] is missing"),
        ('{"a": 1} x', "cell.yaml:1:10: .*something follows"),
        ('{"a": tru}', "cell.yaml:1:7: .*a value is missing"),
        ('{"a": "\n"}', "cell.yaml:1:7: .*not closed"),
        ("[1, 2]", "the file holds a list"),
    ],
)
def test_what_is_not_well_formed_is_told_with_its_place(text, sentence):
    with pytest.raises(CellError, match=sentence):
        loads(text, source="cell.yaml")


def test_json_is_read_with_tabs_and_escapes():
    text = '{\n\t"operators": {"h": {"kind": "human", "label": "\\u00e9 \\"x\\"\\n"}},\n\t'
    text += '"tasks": {"1": {"time": {"h": 1.5e0}}, "2": {"time": {"h": 2}, "after": [1]}}\n}'
    cell = loads(text)
    assert cell.operators["h"].label == 'é "x"'
    assert cell.tasks["2"].after == ("1",)


@given(st.text(max_size=60))
@example("\ud800")
@example("a: &x [*x]")
def test_no_text_brings_anything_but_a_cell_error(text):
    for form in (None, *FORMATS):
        with pytest.raises(CellError):
            loads(text, form)


@given(st.data())
def test_a_damaged_file_brings_nothing_but_a_cell_error(data):
    """Signs are taken out of, or put into, a good file of each of our own forms."""
    text = data.draw(st.sampled_from([GOOD, dumps(loads(GOOD), "json")]))
    place = data.draw(st.integers(0, len(text)))
    cut = data.draw(st.integers(0, 5))
    damaged = (
        text[:place]
        + data.draw(
            st.sampled_from(["", "{", "]", ":", "-", "\t", "&a", "\x00", "'", "9", "\n", ","])
        )
        + text[place + cut :]
    )
    with contextlib.suppress(CellError):
        loads(damaged)


JUNK = st.sampled_from(
    [
        None,
        0,
        -1,
        1.5,
        1e9,
        float("nan"),
        True,
        "",
        " ",
        "x",
        "1",
        [],
        [1],
        ["x", "x"],
        [[1, 2]],
        {},
        {"x": 1},
        {"": 1},
        "1,2",
        1 / 3,
    ]
)


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every mapping or list in a value with each of its keys or places."""
    for key in list(value) if isinstance(value, dict) else range(len(value)):
        yield value, key
        if isinstance(value[key], dict | list):
            yield from places(value[key])


@given(cells(), st.data())
def test_a_cell_with_any_values_replaced_is_sound_or_refused_in_words(cell, data):
    """Through the file as well, so that each fault has its line and none of the words is
    pydantic's.
    """
    damaged = cell.to_dict()
    for _ in range(data.draw(st.integers(1, 3))):
        where, key = data.draw(st.sampled_from(list(places(damaged))))
        if data.draw(st.booleans()) or isinstance(where, list):
            where[key] = copy.deepcopy(data.draw(JUNK))  # a later step may change it
        else:
            where[data.draw(st.sampled_from(["x", "time", "stress", ""]))] = where.pop(key)
    with contextlib.suppress(CellError):
        cell_of(damaged)
    try:
        loads(json.dumps(damaged), source="x")
    except CellError as error:
        for fault in error.faults:
            assert re.match(r"x:\d+:\d+: |and \d+ more", str(fault)), str(fault)
            assert not re.search(
                r"Input should|valid (number|string|dictionary|list|tuple)|validation|Field"
                r" required",
                str(fault),
            ), str(fault)


# Files


def refused(path: Path) -> str:
    with pytest.raises(CellError) as caught:
        load(path)
    assert caught.value.exit_code == 3
    assert len(caught.value.faults) == 1
    return str(caught.value)


def test_an_empty_file(tmp_path):
    (tmp_path / "cell.yaml").write_bytes(b"")
    assert "cell.yaml: the file is empty" in refused(tmp_path / "cell.yaml")


def test_a_binary_file(tmp_path):
    path = tmp_path / "cell.yaml"
    path.write_bytes(random.Random(1).randbytes(5000))
    assert "this is a binary file" in refused(path)
    path.write_bytes(b"PK\x03\x04rest")
    assert "workbook or an archive" in refused(path)
    path.write_bytes("operators: ä".encode("latin-1"))
    assert "cell.yaml:1:12: the byte 0xe4 is not UTF-8" in refused(path)
    path.write_bytes("operators: x".encode("utf-16"))
    assert "UTF-16. Save it as UTF-8" in refused(path)


def test_a_missing_file_names_the_nearest(tmp_path):
    (tmp_path / "gearbox.yaml").write_text(GOOD, "utf-8")
    assert "there is no such file. Did you mean" in refused(tmp_path / "gearbx.yaml")
    assert "gearbox.yaml" in refused(tmp_path / "gearbx.yaml")
    assert "no folder" in refused(tmp_path / "nowhere" / "cell.yaml")
    with pytest.raises(CellError, match="cannot be read"):
        load("a\0b")


def test_a_folder(tmp_path):
    assert "this is a folder" in refused(tmp_path)


def test_a_file_without_permission(tmp_path):
    """As another user where the test runs as root, who may read everything."""
    path = tmp_path / "cell.yaml"
    path.write_text(GOOD, "utf-8")
    path.chmod(0)
    if os.geteuid() != 0:
        assert "no permission to read" in refused(path)
        return
    for folder in (tmp_path, *tmp_path.parents[:2]):
        folder.chmod(0o755)
    code = (
        "import os, sys\n"
        "from tandem.files.load import load\n"
        "from tandem.errors import CellError\n"
        "os.setgid(65534), os.setuid(65534)\n"
        "try:\n"
        "    load(sys.argv[1])\n"
        "except CellError as error:\n"
        "    print(error)\n"
        "    sys.exit(error.exit_code)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 3, done.stderr
    assert "no permission to read" in done.stdout


def test_a_spreadsheet_is_sent_to_the_import(tmp_path):
    path = tmp_path / "tasks.csv"
    path.write_text("task;robot;human\n1;2;3\n", "utf-8")
    assert "this is a spreadsheet. Import it first" in refused(path)


def test_a_file_that_is_too_large(tmp_path):
    path = tmp_path / "cell.yaml"
    with open(path, "wb") as file:
        file.truncate(21_000_000)
    assert "more than 20 MB" in refused(path)


def big(count: int) -> str:
    draw = random.Random(3)
    tasks = "".join(
        f"  t{n}: {{time: {{robot: {draw.randint(1, 9)}, human: {draw.randint(1, 99) / 10}}},"
        f" stress: 2.5, after: [{', '.join(f't{draw.randrange(n)}' for _ in range(min(n, 3)))}]}}\n"
        for n in range(count)
    )
    return "operators:\n  robot: {kind: robot}\n  human: {kind: human}\ntasks:\n" + tasks


@pytest.mark.parametrize("form", ["yaml", "json"])
def test_twice_the_tasks_are_read_with_at_most_three_times_the_effort(form):
    effort = []
    for size in (1_000, 2_000):
        text = big(size)
        if form == "json":
            text = json.dumps(loads(text).to_dict(), indent=1)
        effort.append(calls(lambda text=text: loads(text)))
    assert effort[1] < 3 * effort[0]


def test_twice_the_faulty_tasks_are_refused_with_at_most_three_times_the_effort():
    effort = []
    for size in (1_000, 2_000):
        text = big(size).replace("robot: ", "robbot: ").replace("stress: 2.5", "stres: -1")
        assert len(told(text)) == MOST + 1
        effort.append(calls(lambda text=text: told(text)))
    assert effort[1] < 3 * effort[0]
