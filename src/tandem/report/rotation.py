"""A job rotation for people and programs: a document with a schema, text, CSV, Markdown and a
workbook.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tandem.cell.burdens import worth
from tandem.cell.crew import Person
from tandem.cell.measures import Measure
from tandem.cell.model import plain
from tandem.cell.names import Known
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.plan.rotation import SPREAD, STAYS, WORST, Rotated
from tandem.report.language import Words
from tandem.schedule.measures import mode_of
from tandem.schedule.rotation import Rotation, Shift, rotation_measure

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

SCHEMA_VERSION = 1


@dataclass(frozen=True)
class Told:
    """A rotation with what is told beside it.

    Attributes:
      staying: the best without rotation; None when there is none.
      made: version and command, and the plan's file where there is one.
    """

    found: Rotated
    staying: Rotated | None
    made: Mapping[str, str]

    @property
    def rotation(self) -> Rotation:
        return self.found.rotation

    @property
    def shift(self) -> Shift:
        return self.found.rotation.shift

    @property
    def measures(self) -> list[str]:
        """The aims' measures, then those that only limit somebody."""
        aimed = [aim.measure for aim in self.found.aims if aim.what == WORST]
        limits = [rotation_measure(n, self.shift.cell).name for n in self.shift.crew.measures]
        return list(dict.fromkeys([*aimed, *limits]))

    def measure(self, name: str) -> Measure:
        return rotation_measure(name, self.shift.cell)

    def limits(self, person: Person) -> dict[str, Decimal]:
        """The person's limits by the measures' own names."""
        most = self.shift.crew.most(person)
        return {self.measure(name).name: limit for name, limit in most.items()}


# --- the document ---------------------------------------------------------------------------------


def document(told: Told) -> dict[str, Any]:
    """The rotation as plain data; `schema()` describes it."""
    shift, rotation = told.shift, told.rotation
    numbers = range(len(shift.periods))
    return {
        "schema_version": SCHEMA_VERSION,
        "kind": "rotation",
        "cell": shift.cell.name,
        "cell_digest": shift.cell.digest,
        **told.made,
        "status": "optimal" if told.found.proven else "feasible",
        "seconds_each": plain(shift.each_s),
        "periods": [
            {"minutes": plain(one.minutes), "products": one.products} for one in shift.periods
        ],
        "roles": [{"role": role, "tasks": list(shift.tasks(role))} for role in shift.roles],
        "people": [
            {
                "person": person.name,
                "roles": [rotation.role_of(person.name, t) for t in numbers],
                "products": sum(
                    shift.periods[t].products for t in numbers if rotation.role_of(person.name, t)
                ),
                "values": {
                    name: float(rotation.has(told.measure(name), person)) for name in told.measures
                },
                "limits": {name: float(most) for name, most in told.limits(person).items()},
            }
            for person in shift.crew.people
        ],
        "aims": _aims(told.found),
        "without_rotation": None if told.staying is None else _aims(told.staying),
        "unassessed": {name: tasks for name in told.measures if (tasks := _unassessed(told, name))},
        "wall_s": round(told.found.wall_s, 3),
        "seed": told.found.seed,
    }


def _aims(found: Rotated) -> list[dict[str, Any]]:
    return [
        {
            "aim": aim.what,
            "measure": aim.measure or None,
            "value": plain(float(aim.value)),
            "proven": aim.proven,
            "rounded": aim.rounded,
        }
        for aim in found.aims
    ]


def _unassessed(told: Told, name: str) -> list[str]:
    """Tasks of the roles that have no value on the measure's scale."""
    shift, scale = told.shift, told.measure(name).scale
    found = []
    for role in shift.roles:
        for row in shift.schedule.of(role):
            mode = mode_of(shift.cell, row)
            if mode is not None and role not in worth(shift.cell, scale, row.task, mode):
                found.append(row.task)
    return list(dict.fromkeys(found))


def schema() -> dict[str, Any]:
    """The JSON Schema of the document."""

    def table(properties: dict[str, Any], optional: tuple[str, ...] = ()) -> dict[str, Any]:
        return {
            "type": "object",
            "properties": properties,
            "required": [name for name in properties if name not in optional],
            "additionalProperties": False,
        }

    def rows(items: dict[str, Any]) -> dict[str, Any]:
        return {"type": "array", "items": items}

    text, whole = {"type": "string"}, {"type": "integer", "minimum": 0}
    positive = {"type": "number", "exclusiveMinimum": 0}
    numbers = {"type": "object", "additionalProperties": {"type": "number", "minimum": 0}}
    aim = table(
        {
            "aim": {"enum": [WORST, SPREAD, STAYS]},
            "measure": {"type": ["string", "null"]},
            "value": {"type": "number", "minimum": 0},
            "proven": {"type": "boolean"},
            "rounded": {"type": "boolean", "description": "Counted to twelve digits."},
        }
    )
    person = table(
        {
            "person": text,
            "roles": {
                **rows({"type": ["string", "null"]}),
                "description": "For each period; null: not in this cell.",
            },
            "products": whole,
            "values": {**numbers, "description": "Measure -> what the person bears in the shift."},
            "limits": numbers,
        }
    )
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:tandem:rotation:{SCHEMA_VERSION}",
        "title": "Tandem job rotation",
        "description": "What `tandem rotate --json` prints.",
        **table(
            {
                "schema_version": {"const": SCHEMA_VERSION},
                "kind": {"const": "rotation"},
                "cell": {"type": ["string", "null"]},
                "cell_digest": text,
                "version": text,
                "command": text,
                "plan": text,
                "status": {"enum": ["optimal", "feasible"]},
                "seconds_each": positive,
                "periods": rows(table({"minutes": positive, "products": whole})),
                "roles": rows(table({"role": text, "tasks": rows(text)})),
                "people": rows(person),
                "aims": rows(aim),
                "without_rotation": {"anyOf": [{"type": "null"}, rows(aim)]},
                "unassessed": {"type": "object", "additionalProperties": rows(text)},
                "wall_s": {"type": "number", "minimum": 0},
                "seed": {"type": "integer"},
            },
            optional=("plan",),
        ),
    }


def schema_text() -> str:
    """The same as text."""
    return json.dumps(schema(), indent=2) + "\n"


# --- for people -----------------------------------------------------------------------------------


def heads(t: Words, told: Told) -> list[str]:
    """The heads of the table: person, periods, measures."""
    periods = [t("rotation.period", n=n) for n in range(1, len(told.shift.periods) + 1)]
    return [t("rotation.person"), *periods, *told.measures]


def rows(t: Words, told: Told) -> Iterator[list[str]]:
    """A row for each person: roles, then what they bear and may bear."""
    for person in told.shift.crew.people:
        roles = [
            told.rotation.role_of(person.name, period) or t("rotation.elsewhere")
            for period in range(len(told.shift.periods))
        ]
        limits, values = told.limits(person), []
        for name in told.measures:
            value = short(t, told.rotation.has(told.measure(name), person))
            if name in limits:
                value = t("rotation.value", value=value, limit=short(t, limits[name]))
            values.append(value)
        yield [person.name, *roles, *values]


def short(t: Words, value: Decimal) -> str:
    """A value to four digits with the language's decimal mark."""
    return f"{float(value):.4g}".replace(".", t("decimal"))


def remarks(t: Words, told: Told) -> Iterator[str]:
    """What the table does not say: how good it is, beside what, and what it is not."""
    shift = told.shift
    yield t(
        "rotation.shift",
        periods=len(shift.periods),
        minutes=t.number(sum(one.minutes for one in shift.periods)),
        products=sum(one.products for one in shift.periods),
        each=t.seconds(shift.each_s),
    )
    without = {} if told.staying is None else _values(told.staying)
    found = _values(told.found)
    for name in dict.fromkeys(aim.measure for aim in told.found.aims if aim.measure):
        worst, spread = (short(t, found[what, name]) for what in (WORST, SPREAD))
        yield t("rotation.worst", measure=name, value=worst, spread=spread)
        if without:
            worst, spread = (short(t, without[what, name]) for what in (WORST, SPREAD))
            yield t("rotation.without", value=worst, spread=spread)
    if not without:
        yield t("rotation.without.none")
    yield t("rotation.stays", n=told.rotation.stays)
    yield t("rotation.proven" if told.found.proven else "rotation.open")
    if rounded := [aim.measure for aim in told.found.aims if aim.rounded]:
        yield t("rotation.rounded", names=", ".join(dict.fromkeys(rounded)))
    for name in told.measures:
        if tasks := _unassessed(told, name):
            yield t("rotation.unassessed", measure=name, tasks=", ".join(tasks))
    yield t("rotation.own")
    yield t("rotation.advice")


def _values(found: Rotated) -> dict[tuple[str, str], Decimal]:
    return {(aim.what, aim.measure): aim.value for aim in found.aims}


def roles(t: Words, told: Told) -> list[str]:
    """What each role does."""
    shift = told.shift
    return [t("rotation.role", role=r, tasks=", ".join(shift.tasks(r))) for r in shift.roles]


def text(t: Words, told: Told) -> str:
    """The rotation for a terminal."""
    table = [heads(t, told), *rows(t, told)]
    widths = [max(len(row[column]) for row in table) for column in range(len(table[0]))]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in table
    ]
    title = t("rotation.title", name=told.shift.cell.name or t("unnamed"))
    said = "\n".join(remarks(t, told))
    return "\n".join([title, *roles(t, told), "", *lines, "", said])


def markdown(t: Words, told: Told) -> str:
    """The rotation as Markdown."""
    table = [heads(t, told), *rows(t, told)]
    lines = ["| " + " | ".join(c.replace("|", "\\|") for c in row) + " |" for row in table]
    lines.insert(1, "|" + "---|" * len(table[0]))
    title = t("rotation.title", name=told.shift.cell.name or t("unnamed"))
    return "\n".join(
        [
            f"# {title}", "", f"{t('rotation.table')}.", "", *lines, "",
            f"## {t('rotation.roles')}", "", *(f"- {one}" for one in roles(t, told)), "",
            *(line for one in remarks(t, told) for line in (one, "")),
        ]
    )  # fmt: skip


def csv_text(t: Words, told: Told) -> str:
    """A row for each person and period; the same in every language."""
    buffer = io.StringIO(newline="")
    writer = csv.writer(buffer, lineterminator="\r\n")
    writer.writerow(["period", "minutes", "products", "person", "role", "tasks", *told.measures])
    for number, period in enumerate(told.shift.periods):
        for person in told.shift.crew.people:
            role = told.rotation.role_of(person.name, number)
            tasks = "" if role is None else ",".join(told.shift.tasks(role))
            bears = [
                0.0
                if role is None
                else float(
                    told.shift.share(measure, number) * told.shift.each(measure, person, role)
                )
                for measure in map(told.measure, told.measures)
            ]
            writer.writerow(
                [number + 1, plain(period.minutes), period.products, person.name, role or "",
                 tasks, *map(plain, bears)]
            )  # fmt: skip
    return buffer.getvalue()


def xlsx(t: Words, told: Told) -> bytes:
    """The rotation as a workbook, ready to be printed and hung up."""
    from openpyxl import Workbook

    from tandem.report.workbook import fit_to_page, spread, write_header, write_row, write_title

    book = Workbook()
    sheet: Worksheet = book.worksheets[0]
    sheet.title = t("rotation.sheet")
    write_title(sheet, t("rotation.title", name=told.shift.cell.name or t("unnamed")))
    periods = [
        t("rotation.period.long", n=n, minutes=t.number(one.minutes), products=one.products)
        for n, one in enumerate(told.shift.periods, 1)
    ]
    names = [t("rotation.person"), *periods, *told.measures]
    write_header(sheet, 3, names, [22, *([20] * len(periods)), *([24] * len(told.measures))])
    row = 4
    for cells in rows(t, told):
        write_row(sheet, row, cells)
        row += 1
    for said in ("", *roles(t, told), "", *remarks(t, told)):
        if said:
            spread(sheet, row, said, len(names))
        row += 1
    sheet.freeze_panes = "B4"
    fit_to_page(sheet)
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def json_text(t: Words, told: Told) -> str:
    """The document as text."""
    return json.dumps(document(told), ensure_ascii=False, indent=1) + "\n"


WRITERS: dict[str, Callable[[Words, Told], str | bytes]] = {
    ".json": json_text,
    ".csv": csv_text,
    ".md": markdown,
    ".xlsx": xlsx,
}
"""Ending of a file -> what is written into it."""


def check(path: Path) -> None:
    """Raises UsageError when a file of that name cannot be written."""
    if path.suffix.lower() not in WRITERS:
        hint = Known(WRITERS).hint(path.suffix.lower())
        raise UsageError(f"-o {path}: a rotation is written as {', '.join(WRITERS)}. {hint}")


def write(t: Words, told: Told, path: Path) -> None:
    """Writes the rotation in the form that the file's ending says. Raises OSError, UsageError."""
    check(path)
    store(path, WRITERS[path.suffix.lower()](t, told))
