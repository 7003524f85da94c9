"""A cell as a workbook that planners can fill in and that `tandem import` reads back: the template,
and the export of any cell.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell, plain
from tandem.cell.parts import KINDS, Task
from tandem.cell.walking import SPEED
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.files.spreadsheet.draft import read_book
from tandem.files.spreadsheet.form import (
    CHECKS,
    EXAMPLE,
    HEADERS,
    HELP,
    OPERATOR_COLUMNS,
    SHEETS,
    Language,
    OperatorColumn,
)
from tandem.files.spreadsheet.no_work import reads_like_no_work
from tandem.files.spreadsheet.outline import LEADING
from tandem.files.spreadsheet.references import unquoted
from tandem.files.spreadsheet.rows import is_total
from tandem.files.spreadsheet.stand_ins import looks_like_a_stand_in
from tandem.files.spreadsheet.struck import odd_marks
from tandem.files.spreadsheet.vocabulary import Meaning, meaning, own_tool
from tandem.files.spreadsheet.waits import waits_text
from tandem.files.spreadsheet.walking import rows_of
from tandem.files.spreadsheet.workbook import unpacked

if TYPE_CHECKING:
    from openpyxl import Workbook
    from openpyxl.worksheet.worksheet import Worksheet

SPARE_ROWS = 200
"""Empty rows below the tasks in which the sheet still checks what is typed."""


@dataclass(frozen=True)
class Field:
    """One column of the task sheet.

    Attributes:
      header: as written above it.
      of: task -> what stands in the sheet; None leaves the cell empty.
      check: "number" for 0 or more, "tool", "zone" or "place" for a list, "text" for what Excel
        must not turn into numbers or dates.
      width: in characters.
    """

    header: str
    of: Callable[[str, Task], Any]
    check: str = ""
    width: float = 14


def write_template(path: str | Path, *, lang: Language = "en") -> None:
    """A workbook with a filled example, checks on what is typed, and a help sheet.

    Raises:
      OSError: it could not be written; an older file is then as it was.
      UsageError: there is no such language.
    """
    store(path, to_workbook(Cell.model_validate(EXAMPLE), lang=lang, every_column=True))


def export_cell(cell: Cell, path: str | Path, *, lang: Language = "en") -> tuple[str, ...]:
    """Writes the cell in the template's form, and returns what that form could not keep: sentences,
    none when importing gives the same cell.

    Raises:
      OSError: it could not be written; an older file is then as it was.
      UsageError: there is no such language.
    """
    content = to_workbook(cell, lang=lang)
    store(path, content)
    return lost(cell, content)


def lost(cell: Cell, content: bytes) -> tuple[str, ...]:
    """What importing the workbook does not give back: read again, compared key by key."""
    draft = read_book(unpacked(Path("export.xlsx"), content))
    if draft.faults:
        return tuple(f"the sheet cannot be imported again: {fault}" for fault in draft.faults)
    return tuple(_differences((), _compared(cell), _compared(draft.cell())))


def _compared(cell: Cell) -> dict[str, Any]:
    """The cell as a file holds it, but for walks, whose pairs a sheet may state the other way
    round.
    """
    data = cell.to_dict()
    if "walk" in data:
        data["walk"] = {
            who: {f"{one}-{other}": seconds for (one, other), seconds in times.items()}
            for who, times in cell.walking.items()
        }
    return data


def _differences(path: tuple[str, ...], before: Any, after: Any) -> Iterable[str]:
    if isinstance(before, dict) and isinstance(after, dict):
        for key in dict.fromkeys([*before, *after]):
            yield from _differences((*path, str(key)), before.get(key), after.get(key))
        if (
            list(before) != list(after)
            and set(before) == set(after)
            and path in (("operators",), ("tasks",))
        ):
            yield f"{'.'.join(path)}: the order {', '.join(before)} becomes {', '.join(after)}."
    elif before != after and not (before in (None, {}) and after in (None, {})):
        # a table that names nobody says the same as none
        yield (
            f"{'.'.join(path)}: {before!r} becomes {after!r}."
            if after is not None
            else f"{'.'.join(path)}: {before!r} has no place in the sheet."
        )


def to_workbook(cell: Cell, *, lang: Language = "en", every_column: bool = False) -> bytes:
    """The cell as the bytes of an xlsx file in the template's form.

    Args:
      every_column: with the columns that planners often need, even if this cell leaves them empty.

    Raises:
      UsageError: there is no such language.
    """
    import openpyxl

    if lang not in HEADERS:
        raise UsageError(f"there is no language {lang!r}: choose en or de.")
    book = openpyxl.Workbook()
    book.properties.title = cell.name or "Tandem cell"
    book.properties.creator = "Tandem"
    _tasks(book, cell, lang, every_column)
    _operators(book, cell, lang, every_column)
    _things(book, cell, lang, every_column)
    _places_and_walking(book, cell, lang, every_column)
    _assessments(book, cell, lang)
    _sets_and_name(book, cell, lang)
    _help(book, lang)
    return workbook_bytes(book)


def workbook_bytes(book: Workbook) -> bytes:
    """The workbook as an xlsx file, the same bytes every time: without the moment of writing."""
    written, steady = io.BytesIO(), io.BytesIO()
    book.save(written)
    with (
        zipfile.ZipFile(written) as source,
        zipfile.ZipFile(steady, "w", zipfile.ZIP_DEFLATED) as target,
    ):
        for name in source.namelist():
            content = source.read(name)
            if name == "docProps/core.xml":
                content = re.sub(rb">\d{4}-\d\d-\d\dT[\d:]+Z<", b">2000-01-01T00:00:00Z<", content)
            target.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return steady.getvalue()


# --- tasks ----------------------------------------------------------------------------------------


def _tasks(book: Workbook, cell: Cell, lang: Language, every: bool) -> None:
    sheet = book.active
    sheet.title = SHEETS[lang]["tasks"]
    fields = _fields(cell, lang, every)
    _header(sheet, [field.header for field in fields], [field.width for field in fields])
    for row, (name, task) in enumerate(cell.tasks.items(), 2):
        for column, field in enumerate(fields, 1):
            _put(sheet, row, column, field.of(name, task))
    last = len(cell.tasks) + 1 + SPARE_ROWS
    _checks(sheet, fields, last, lang)
    sheet.freeze_panes = "B2"


def _fields(cell: Cell, lang: Language, every: bool) -> list[Field]:
    words = HEADERS[lang]
    tasks = tuple(cell.tasks.values())

    def any_task(has: Callable[[Task], Any]) -> bool:
        return any(has(task) for task in tasks)

    codes = {name: found[1] if (found := LEADING.match(name)) else name for name in cell.tasks}
    above = {code[: dot.start()] for code in codes.values() for dot in re.finditer(r"\.", code)}
    fields = [
        Field(
            words["name"],
            lambda name, task: (
                _spelled(name) if _looks_like_no_task(name, task, codes[name], above) else name
            ),
            "name",
            10,
        )
    ]
    if every or any_task(lambda t: t.label):
        fields.append(Field(words["label"], lambda name, task: task.label, "", 34))
    if any_task(lambda t: t.part):
        fields.append(Field(words["part"], lambda name, task: task.part, "", 18))
    for who in cell.operators:
        fields.append(
            Field(
                _headed(words["time"], "time", (who,), cell),
                _beyond_doubt(_entry("time", who)),
                "number",
                16,
            )
        )
    groups = list(
        {
            frozenset(joint.operators): joint.operators
            for task in reversed(tasks)
            for joint in reversed(task.together)
        }.values()
    )[::-1]
    for group in groups:
        fields.append(
            Field(
                _headed(words["time"], "time", group, cell),
                _beyond_doubt(_joint_time(group)),
                "number",
                22,
            )
        )
    fields += _stress_fields(cell, words, groups, every)
    fields.append(Field(words["after"], lambda name, task: _list(task.after), "text", 20))
    if any_task(lambda t: t.wait):
        fields.append(Field(words["wait"], lambda name, task: waits_text(task.wait), "text", 24))
    fields += _where_and_with_what(cell, words, groups, every)
    if every or any_task(lambda t: t.release):
        fields.append(
            Field(words["release"], lambda name, task: task.release or None, "number", 16)
        )
    if every or any_task(lambda t: t.deadline is not None):
        fields.append(Field(words["deadline"], lambda name, task: task.deadline, "number", 16))
    fields += _operator_fields(cell, words)
    return fields


def _where_and_with_what(
    cell: Cell, words: Mapping[str, str], groups: list[tuple[str, ...]], every: bool
) -> list[Field]:
    tasks = cell.tasks.values()
    fields = []
    if every or any(isinstance(task.tool, str) for task in tasks):
        fields.append(Field(words["tool"], lambda name, task: _one_tool(task.tool), "tool", 14))
    for who in _named(cell, (task.tool for task in tasks)):
        header = _tool_headed(words["tool of"], (who,), cell)
        fields.append(Field(header, _share("tool", who), "tool", 16))
    for group in groups:
        tools = [_joint_tool(task, group) for task in tasks]
        if any(isinstance(tool, str) or tool == {} for tool in tools):
            header = _tool_headed(words["tool of"], group, cell)
            fields.append(Field(header, _tool_of_group(group), "tool", 22))
        for who in _named(cell, tools):
            others = " + ".join(_spelled(other) for other in group if other != who)
            header = words["joint tool of"].format(one=_spelled(who), others=others)
            fields.append(Field(header, _tool_in_group(group, who), "tool", 26))
    for what in ("zone", "place"):
        if every or any(getattr(task, what) for task in tasks):
            fields.append(Field(words[what], _value(what), what, 14))
    return fields


def _one_tool(tool: Any) -> str | None:
    return tool if isinstance(tool, str) else None


def _joint_tool(task: Task, group: tuple[str, ...]) -> Any:
    """What the group states for itself; None where it needs what the task says."""
    return next((joint.tool for joint in task.together if set(joint.operators) == set(group)), None)


def _tool_of_group(group: tuple[str, ...]) -> Callable[[str, Task], Any]:
    def of(name: str, task: Task) -> str | None:
        tool = _joint_tool(task, group)
        return "-" if tool == {} else _one_tool(tool)

    return of


def _tool_in_group(group: tuple[str, ...], who: str) -> Callable[[str, Task], Any]:
    return lambda name, task: _of(_joint_tool(task, group), who)


def _tool_headed(pattern: str, who: tuple[str, ...], cell: Cell) -> str:
    """The header in plain words, or with the names in quotes where plain words would be misread."""
    simple = pattern.format(who=" + ".join(who))
    if meaning(simple, tuple(cell.operators)) is None and own_tool(
        simple, tuple(cell.operators)
    ) == Meaning("tool", who):
        return simple
    return pattern.format(who=" + ".join(map(_spelled, who)))


def _stress_fields(
    cell: Cell, words: Mapping[str, str], groups: list[tuple[str, ...]], every: bool
) -> list[Field]:
    tasks = cell.tasks.values()
    fields = []
    if every or any(not isinstance(task.stress, Mapping) and task.stress for task in tasks):
        fields.append(
            Field(words["stress"], lambda name, task: _for_all(task.stress), "number", 12)
        )
    for who in _named(cell, (task.stress for task in tasks)):
        header = _headed(words["stress of"], "stress", (who,), cell)
        fields.append(Field(header, _share("stress", who), "number", 16))
    for group in groups:
        values = [
            joint.stress
            for task in tasks
            for joint in task.together
            if set(joint.operators) == set(group)
        ]
        if any(value is not None and not isinstance(value, Mapping) for value in values):
            fields.append(
                Field(
                    _headed(words["joint stress"], "stress", group, cell),
                    _joint_stress(group, None),
                    "number",
                    22,
                )
            )
        for who in _members_named(cell, group, values):
            others = " + ".join(_spelled(other) for other in group if other != who)
            header = words["joint stress of"].format(human=_spelled(who), others=others)
            fields.append(Field(header, _joint_stress(group, who), "number", 26))
    return fields


def _value(key: str) -> Callable[[str, Task], Any]:
    """Reads a key of a task."""
    return lambda name, task: getattr(task, key)


def _entry(key: str, who: str) -> Callable[[str, Task], Any]:
    """Reads an operator's entry in a table of a task; None when it has none."""
    return lambda name, task: getattr(task, key).get(who)


def _beyond_doubt(of: Callable[[str, Task], Any]) -> Callable[[str, Task], Any]:
    """Times with their unit behind them where the bare number would be taken for "cannot"."""

    def time(name: str, task: Task) -> Any:
        seconds = of(name, task)
        bare = "" if seconds is None else f"{seconds:.15g}"
        return f"{bare} s" if looks_like_a_stand_in(bare) else seconds

    return time


def _share(key: str, who: str) -> Callable[[str, Task], Any]:
    """Reads what of a task's number, which may be one for all, is that operator's by name."""
    return lambda name, task: _of(getattr(task, key), who)


def _operator_fields(cell: Cell, words: Mapping[str, str]) -> list[Field]:
    tasks = cell.tasks.values()
    fields = []
    for who in _named(cell, (task.difficulty for task in tasks)):
        header = _headed(words["difficulty"], "difficulty", (who,), cell)
        fields.append(Field(header, _entry("difficulty", who), "number", 18))
    if any(not isinstance(task.spread, Mapping) and task.spread for task in tasks):
        fields.append(
            Field(words["spread"], lambda name, task: _for_all(task.spread), "number", 12)
        )
    for who in _named(cell, (task.spread for task in tasks)):
        header = _headed(words["spread of"], "spread", (who,), cell)
        fields.append(Field(header, _share("spread", who), "number", 16))
    if cell.same_operator:
        partners = {
            name: [other for one, other in cell.same_operator if one == name] for name in cell.tasks
        }
        fields.append(
            Field(words["same operator"], lambda name, task: _list(partners[name]), "text", 20)
        )
    return fields


def _named(cell: Cell, values: Iterable[Any]) -> list[str]:
    """The operators for whom one of the values has a number of their own, in the cell's order."""
    named = {who for value in values if isinstance(value, Mapping) for who in value}
    return [who for who in cell.operators if who in named]


def _members_named(cell: Cell, group: tuple[str, ...], values: list[Any]) -> list[str]:
    """The humans of a group who need a column of their own; all of them where a table names nobody,
    so that its 0 is written down.
    """
    if any(isinstance(value, Mapping) and not value for value in values):
        return [who for who in cell.humans if who in group]
    return _named(cell, values)


def _of(value: Any, who: str) -> Any:
    return value.get(who) if isinstance(value, Mapping) else None


def _for_all(value: Any) -> float | None:
    return None if isinstance(value, Mapping) or not value else value


def _joint_time(group: tuple[str, ...]) -> Callable[[str, Task], Any]:
    return lambda name, task: next(
        (joint.time for joint in task.together if set(joint.operators) == set(group)), None
    )


def _joint_stress(group: tuple[str, ...], who: str | None) -> Callable[[str, Task], Any]:
    def of(name: str, task: Task) -> float | None:
        stress = next(
            (joint.stress for joint in task.together if set(joint.operators) == set(group)), None
        )
        if who is None:
            return None if isinstance(stress, Mapping) else stress
        return 0.0 if isinstance(stress, Mapping) and not stress else _of(stress, who)

    return of


def _headed(pattern: str, what: str, who: tuple[str, ...], cell: Cell) -> str:
    """The header in plain words, or with the names in quotes where plain words would be misread."""
    simple = pattern.format(who=" + ".join(who))
    # the sheets beside the tasks know no operators
    readings = [meaning(simple, known) for known in (tuple(cell.operators), ())]
    if all(
        found is not None
        and (found.what, found.who, found.human, found.per_piece) == (what, who, "", False)
        for found in readings
    ):
        return simple
    return pattern.format(who=" + ".join(map(_spelled, who)))


def _spelled(name: str) -> str:
    return f'"{name}"'


def _looks_like_no_task(name: str, task: Task, code: str, above: set[str]) -> bool:
    """A row that an import would take for a total, a break or the head of a group of tasks, or a
    name that is in quotes itself or looks struck through.
    """
    return (
        is_total(name)
        or is_total(task.label or "")
        or reads_like_no_work(task.label or name, numbered=bool(task.label)) is not None
        or code.rstrip(".") in above
        or unquoted(name) != name
        or odd_marks(name) is not None
    )


def _list(names: Iterable[str]) -> str | None:
    listed = list(names)
    return (
        "; ".join(_spelled(name) if len(listed) > 1 and ";" in name else name for name in listed)
        or None
    )


# --- the other sheets -----------------------------------------------------------------------------


def _operators(book: Workbook, cell: Cell, lang: Language, every: bool) -> None:
    from openpyxl.worksheet.datavalidation import DataValidation

    words = HEADERS[lang]
    sheet = book.create_sheet(SHEETS[lang]["operators"])
    columns = [
        column
        for column in OPERATOR_COLUMNS
        if every or cell.place_names or column.key not in ("place", SPEED)
    ]
    _header(
        sheet,
        [words["operator"], *(words[column.word] for column in columns)],
        [18, *(column.width for column in columns)],
    )
    for row, name in enumerate(cell.operators, 2):
        for place, value in enumerate(
            [name, *(_of_operator(cell, name, column, words) for column in columns)], 1
        ):
            _put(sheet, row, place, value)
    for place, column in enumerate(columns, 2):
        as_text = column.holds in ("breaks", "pairs", "limits")
        for row in range(2, len(cell.operators) + 12) if as_text else ():
            sheet.cell(row, place).number_format = "@"
    kinds = DataValidation(
        type="list",
        formula1=f'"{",".join(words[kind] for kind in KINDS)}"',
        allow_blank=True,
        showErrorMessage=True,
    )
    kinds.add(f"B2:B{len(cell.operators) + 11}")
    sheet.add_data_validation(kinds)


def _of_operator(cell: Cell, name: str, column: OperatorColumn, words: Mapping[str, str]) -> Any:
    """What stands in the column; nothing where the file would leave the key out."""
    if column.key == SPEED:
        return cell.walk.get(name, {}).get(SPEED)
    value = getattr(cell.operators[name], column.key)
    match column.holds:
        case "kind":
            return words[value]
        case "breaks":
            return "; ".join(f"{plain(start)}-{plain(end)}" for start, end in value) or None
        case "pairs":
            return "; ".join(" > ".join(map(_in_pair, pair)) for pair in value) or None
        case "limits":
            return "; ".join(f"{key} = {_plain(most)}" for key, most in value.items()) or None
        case "time":
            return value or None
    return value


def _plain(most: float) -> str:
    return f"{Decimal(repr(most)).normalize():f}"


def _in_pair(name: str) -> str:
    return f'"{name}"' if set(name) & set(';>"') else name


def _things(book: Workbook, cell: Cell, lang: Language, every: bool) -> None:
    words = HEADERS[lang]
    if every or cell.tools:
        sheet = book.create_sheet(SHEETS[lang]["tools"])
        swaps = [_headed(words["changeover"], "changeover", (who,), cell) for who in cell.operators]
        _header(sheet, [words["tool"], words["capacity"], *swaps], [18, 12, *[22] * len(swaps)])
        for row, (name, tool) in enumerate(cell.tools.items(), 2):
            values = [
                name,
                tool.capacity if tool.capacity != 1 else None,
                *(tool.changeover.get(who) for who in cell.operators),
            ]
            for column, value in enumerate(values, 1):
                _put(sheet, row, column, value)
    if every or cell.zones:
        sheet = book.create_sheet(SHEETS[lang]["zones"])
        _header(sheet, [words["zone"], words["capacity"], words["apart"]], [18, 12, 22])
        for row, (name, zone) in enumerate(cell.zones.items(), 2):
            _put(sheet, row, 1, name)
            _put(sheet, row, 2, zone.capacity if zone.capacity != 1 else None)
            _put(sheet, row, 3, "; ".join(words[kind] for kind in zone.apart) or None)


def _places_and_walking(book: Workbook, cell: Cell, lang: Language, every: bool) -> None:
    words = HEADERS[lang]
    if every or cell.places:
        sheet = book.create_sheet(SHEETS[lang]["places"])
        _header(sheet, [words[key] for key in ("place", "x", "y")], [18, 12, 12])
        for row, (name, metres) in enumerate(cell.places.items(), 2):
            for column, value in enumerate((name, *metres), 1):
                _put(sheet, row, column, value)
    rows = rows_of(cell)
    if every or rows:
        sheet = book.create_sheet(SHEETS[lang]["walking"])
        walkers = [who for who in cell.operators if every or any(who in row[2] for row in rows)]
        times = [_headed(words["time"], "time", (who,), cell) for who in walkers]
        _header(sheet, [words["from"], words["to"], *times], [18, 18, *[18] * len(times)])
        for row, (start, end, seconds) in enumerate(rows, 2):
            for column, value in enumerate((start, end, *map(seconds.get, walkers)), 1):
                _put(sheet, row, column, value)


def _assessments(book: Workbook, cell: Cell, lang: Language) -> None:
    """A row for each assessment of a task, a column for each fact that one of them states."""
    rows = [(name, one) for name, task in cell.tasks.items() for one in task.ergonomics]
    if not rows:
        return
    words, own = HEADERS[lang], ["name", "method", "for whom", "score"]
    facts = list(dict.fromkeys(fact for _, one in rows for fact in one.facts))
    sheet = book.create_sheet(SHEETS[lang]["ergonomics"])
    widths: list[float] = [14, 16, 18, 10, *(14 for _ in facts)]
    _header(sheet, [words[name] for name in own] + facts, widths)
    for row, (name, one) in enumerate(rows, 2):
        stated = [name, one.method, _list(one.operators) or None, one.score]
        for column, value in enumerate([*stated, *map(one.facts.get, facts)], 1):
            _put(sheet, row, column, _fact(value))


def _fact(value: Any) -> Any:
    """A fact as a sheet has it: a truth value as a word; a number that says where it came from
    keeps its value and unit.
    """
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):
        return f"{value['value']} {value['unit']}" if value.get("unit") else value["value"]
    return value


def _sets_and_name(book: Workbook, cell: Cell, lang: Language) -> None:
    words = HEADERS[lang]
    if cell.stress_of_set is not None:
        no_task = next(
            (word for word in ("-", "none", "keine", "n/a", "k.a.") if word not in cell.tasks), None
        )
        sheet = book.create_sheet(SHEETS[lang]["sets"])
        _header(sheet, [words["sets"], words["stress"]], [40, 12])
        for row, (names, stress) in enumerate(cell.stress_of_set.items(), 2):
            _put(sheet, row, 1, _list(names.split(",")) if names else no_task)
            _put(sheet, row, 2, stress)
    sheet = book.create_sheet(SHEETS[lang]["cell"])
    _put(sheet, 1, 1, words["cell name"])
    _put(sheet, 1, 2, cell.name or None)
    if cell.cycles_per_shift is not None:
        _put(sheet, 2, 1, words["cycles"])
        _put(sheet, 2, 2, cell.cycles_per_shift)
    sheet.column_dimensions["B"].width = 60


def _help(book: Workbook, lang: Language) -> None:
    from openpyxl.styles import Alignment, Font

    sheet = book.create_sheet(SHEETS[lang]["help"])
    sheet.column_dimensions["A"].width, sheet.column_dimensions["B"].width = 32, 110
    for row, (what, text) in enumerate(HELP[lang], 1):
        _put(sheet, row, 1, what)
        _put(sheet, row, 2, text)
        sheet.cell(row, 1).font = Font(name="Calibri", bold=True)
        sheet.cell(row, 2).alignment = Alignment(wrap_text=True, vertical="top")


# --- how it looks, and what may be typed ----------------------------------------------------------


def _put(sheet: Worksheet, row: int, column: int, value: Any) -> None:
    """A value as itself: a text that begins with "=" stays a text, a task called 1 is the
    number 1.
    """
    if value is None:
        return
    if isinstance(value, str):
        if value.isdecimal() and value.isascii() and str(int(value)) == value and len(value) < 15:
            value = int(value)
        else:
            cell = sheet.cell(row, column, value)
            cell.data_type = "s"
            return
    sheet.cell(row, column, plain(float(value)))


def _header(sheet: Worksheet, headers: list[str], widths: list[float]) -> None:
    from openpyxl.styles import Alignment, Font, PatternFill
    from openpyxl.utils import get_column_letter

    for column, (header, width) in enumerate(zip(headers, widths, strict=True), 1):
        cell = sheet.cell(1, column, header)
        cell.data_type = "s"
        cell.font = Font(name="Calibri", bold=True, color="FFFFFF")
        cell.fill = PatternFill("solid", fgColor="1F4E5F")
        cell.alignment = Alignment(wrap_text=True, vertical="center")
        sheet.column_dimensions[get_column_letter(column)].width = max(
            width, min(len(header) + 2, 30)
        )
    sheet.row_dimensions[1].height = 32
    sheet.page_setup.orientation, sheet.page_setup.paperSize = "landscape", 9
    sheet.page_setup.fitToWidth, sheet.page_setup.fitToHeight = 1, 0
    sheet.sheet_properties.pageSetUpPr.fitToPage = True
    sheet.freeze_panes = "A2"


def _checks(sheet: Worksheet, fields: list[Field], last: int, lang: Language) -> None:
    from openpyxl.utils import get_column_letter
    from openpyxl.worksheet.datavalidation import DataValidation

    words, sheets = HEADERS[lang], SHEETS[lang]
    number = DataValidation(
        type="decimal",
        operator="greaterThanOrEqual",
        formula1="0",
        allow_blank=True,
        showErrorMessage=True,
    )
    number.errorTitle, number.error = "Tandem", CHECKS[lang]["number"]
    sheet.add_data_validation(number)
    for column, field in enumerate(fields, 1):
        letter = get_column_letter(column)
        if field.check == "number":
            number.add(f"{letter}2:{letter}{last}")
        elif field.check == "text":
            for row in range(2, last + 1):
                sheet.cell(row, column).number_format = "@"
        elif field.check == "name":
            once = f"COUNTIF(${letter}$2:${letter}${last},{letter}2)=1"
            unique = DataValidation(
                type="custom", formula1=once, allow_blank=True, showErrorMessage=True
            )
            unique.errorTitle, unique.error = "Tandem", CHECKS[lang]["name"]
            unique.add(f"{letter}2:{letter}{last}")
            sheet.add_data_validation(unique)
        elif field.check in ("tool", "zone", "place"):
            there = sheets[f"{field.check}s"]
            options = DataValidation(
                type="list",
                formula1=f"'{there}'!$A$2:$A$100",
                allow_blank=True,
                showErrorMessage=False,
            )
            options.promptTitle, options.prompt, options.showInputMessage = (
                words[field.check],
                f"{CHECKS[lang]['see']} {there}",
                True,
            )
            options.add(f"{letter}2:{letter}{last}")
            sheet.add_data_validation(options)
