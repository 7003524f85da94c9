"""A sweep's tables as Markdown, CSV, LaTeX and JSON, and its picture.

All of them are made of one document, `summary.summarised`; none has a number of its own.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tandem.bench.folder import SweepFolder
from tandem.bench.summary import Run, read_runs, seconds, summarised
from tandem.cell.written import number
from tandem.draw.saving import PICTURES, save
from tandem.errors import UsageError
from tandem.files.atomic import store

TITLES = {"plan": "Planning", "dispatch": "Dispatch beside people"}
PARTS = {"rows": "over all cells", "cells": "cell by cell"}

LATEX = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "|": r"\textbar{}",
        "–": "--",
        "±": r"$\pm$",
        "≥": r"$\geq$",
    }
)
"""Signs that LaTeX reads otherwise."""


@dataclass(frozen=True)
class Table:
    """One of them: texts, ready to be shown. The first `names` columns are words, the others
    numbers.
    """

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    names: int = 1
    notes: tuple[str, ...] = ()


def tables(document: Mapping[str, Any]) -> Iterator[Table]:
    """Of each kind the one over all cells, and the one cell by cell."""
    for part in document["tables"]:
        yield _whole(part)
        yield _by_cell(part)


def _whole(part: Mapping[str, Any]) -> Table:
    rows = []
    for row in part["rows"]:
        rows.append(
            (
                row["who"],
                f"{row['found']}/{row['jobs']}",
                _with(row["iqm"], row["iqm_ci95"]),
                _with(row["gap"], row["gap_ci95"], 100),
                _told(row["worst_gap"], 100),
                "-" if row["optimal"] is None else str(row["optimal"]),
                _with(row["better_than_rule"], row["better_than_rule_ci95"]),
            )
        )
    return Table(
        f"{TITLES[part['kind']]}, {PARTS['rows']}",
        (
            "who",
            "found",
            "IQM",
            "gap %",
            "worst gap %",
            "optimal",
            "beats best rule",
        ),
        tuple(rows),
        notes=tuple(part["left_out"]),
    )


def _by_cell(part: Mapping[str, Any]) -> Table:
    names = [row["who"] for row in part["rows"]]
    beside = part["kind"] == "dispatch"
    rows = []
    for cell in part["cells"]:
        bound = "-" if cell["bound"] is None else number(round(cell["bound"], 2))
        sign = "" if cell["proven"] or cell["bound"] is None else "≥ "
        costs = [cell["cost"][name] for name in names]
        rows.append(
            (
                cell["cell"],
                *([cell["people"]] if beside else []),
                f"{sign}{bound}",
                *("-" if cost is None else number(round(cost, 2)) for cost in costs),
            )
        )
    return Table(
        f"{TITLES[part['kind']]}, {PARTS['cells']}: mean cost",
        ("cell", *(["beside"] if beside else []), "optimum", *names),
        tuple(rows),
        names=2 if beside else 1,
    )


def _told(value: float | None, factor: float = 1.0) -> str:
    return "-" if value is None else f"{factor * value:.{2 if factor > 1 else 3}f}"


def _with(value: float | None, edges: Sequence[float] | None, factor: float = 1.0) -> str:
    """A number with its interval."""
    if value is None or edges is None:
        return "-"
    low, high = (_told(edge, factor) for edge in edges)
    return f"{_told(value, factor)} [{low}, {high}]"


def standing(document: Mapping[str, Any]) -> Iterator[str]:
    """What must be known of a sweep that is not done, one sentence a run."""
    for run in document["runs"]:
        if run["jobs"] < run["of"]:
            yield (
                f"{run['run']}: {run['jobs']} of {run['of']} jobs are done; what is told is of"
                " these alone."
            )


def legend(document: Mapping[str, Any]) -> str:
    """How the tables are to be read."""
    said = document["statistics"]
    return (
        "IQM: mean of the middle half of all proximities, proven optimum (or bound) / cost: 1 at"
        " the optimum, 0 where nothing was found. Gap: cost / optimum - 1, mean. In brackets: 95 %"
        f" intervals by a stratified bootstrap ({said['draws']} draws, seed {said['seed']}). Best"
        " rule: on each cell and seed the best of all dispatch rules, best-of-n among them. Beats"
        " best rule: how likely a job costs less than the best rule's on the same cell, ties half."
    )


# ------------------------------------------------------------------ forms


def markdown(document: Mapping[str, Any]) -> str:
    """The tables, each column as wide as what stands in it, so that a terminal can show them."""
    parts = [f"# {document['name']}"] if document["name"] else []
    parts += standing(document)
    for table in tables(document):
        parts += [f"## {table.title}", _grid(table)]
        parts += ["\n".join(f"- {note}" for note in table.notes)] if table.notes else []
    return "\n\n".join([*parts, legend(document)]) + "\n"


def _grid(table: Table) -> str:
    lines = [
        tuple(text.replace("|", "\\|") for text in line) for line in (table.heads, *table.rows)
    ]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    rule = [
        "-" * width if place < table.names else "-" * (width - 1) + ":"
        for place, width in enumerate(widths)
    ]

    def written(line: Iterable[str]) -> str:
        shown = [
            text.ljust(width) if place < table.names else text.rjust(width)
            for place, (text, width) in enumerate(zip(line, widths, strict=True))
        ]
        return f"| {' | '.join(shown)} |"

    return "\n".join([written(lines[0]), written(rule), *map(written, lines[1:])])


def comma_separated(document: Mapping[str, Any]) -> str:
    """One line for whoever was asked, all numbers with all their digits."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    keys = ("jobs", "done", "found", "optimal", "worst_gap")
    spread = ("iqm", "mean", "gap", "better_than_rule")
    edges = [f"{name}{edge}" for name in spread for edge in ("", "_low", "_high")]
    writer.writerow(["kind", "who", *keys, *edges])
    for part in document["tables"]:
        for row in part["rows"]:
            numbers = [
                one
                for name in spread
                for one in (row[name], *(row[f"{name}_ci95"] or (None, None)))
            ]
            writer.writerow([part["kind"], row["who"], *(row[key] for key in keys), *numbers])
    return out.getvalue()


def latex(document: Mapping[str, Any]) -> str:
    r"""A `table` for each of them, to be read in by `\input`; it needs no package."""
    return "\n".join(map(_latex, tables(document)))


def _latex(table: Table) -> str:
    columns = "l" * table.names + "r" * (len(table.heads) - table.names)
    lines = [
        " & ".join(text.translate(LATEX) for text in line) + r" \\"
        for line in (table.heads, *table.rows)
    ]
    return "\n".join(
        [
            r"\begin{table}",
            rf"\caption{{{table.title.translate(LATEX)}}}",
            r"\centering",
            r"\footnotesize",
            r"\setlength{\tabcolsep}{3pt}",
            rf"\begin{{tabular}}{{{columns}}}",
            r"\hline",
            lines[0],
            r"\hline",
            *lines[1:],
            r"\hline",
            r"\end{tabular}",
            r"\end{table}",
            "",
        ]
    )


def as_json(document: Mapping[str, Any]) -> str:
    """The document."""
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


FORMS: Mapping[str, Callable[[Mapping[str, Any]], str]] = {
    ".md": markdown,
    ".csv": comma_separated,
    ".tex": latex,
    ".json": as_json,
}
"""Ending of a file -> what is written into it; the others are pictures."""


def write(document: Mapping[str, Any], path: str | Path) -> None:
    """Writes the tables, or the picture, in the form of the file's ending. Raises UsageError for
    another one.
    """
    ending = Path(path).suffix.lower()
    if ending in FORMS:
        store(path, FORMS[ending](document))
        return
    if ending not in PICTURES:
        known = ", ".join((*FORMS, *PICTURES))
        raise UsageError(f"{path}: the name of an output ends in {known}.")
    from tandem.draw.sweep import sweep_figure

    save(sweep_figure(document), path)


def check(paths: Iterable[str | Path]) -> None:
    """Raises UsageError, before anything is worked out, for endings that cannot be written."""
    known = (*FORMS, *PICTURES)
    wrong = [str(path) for path in paths if Path(path).suffix.lower() not in known]
    if wrong:
        raise UsageError(f"{', '.join(wrong)}: the name of an output ends in {', '.join(known)}.")


def write_all(folder: str | Path) -> dict[str, Any]:
    """Writes every form into a sweep's folder, the single results and the seconds besides; returns
    the document.
    """
    place = SweepFolder(Path(folder))
    runs = read_runs([place.path])
    document = summarised(runs)
    for ending in (*FORMS, ".svg"):
        write(document, place.path / f"summary{ending}")
    place.write("results.csv", results(runs))
    place.write("times.csv", times(runs))
    return document


def results(runs: Sequence[Run]) -> str:
    """Every job's result, one line each."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    keys = ("outcome", "cost", "makespan", "stress", "bound", "proven", "chosen", "reason")
    writer.writerow(["run", "kind", "who", "cell", "people", "seed", *keys])
    for run in runs:
        labels = {cell.digest: label for label, cell in run.spec.cells.items()}
        for job, record in run.records.items():
            people = "" if job.people is None else job.people[0]
            told = [getattr(record, key) for key in keys]
            writer.writerow(
                [run.name, job.kind, job.who, labels[job.cell], people, job.seed, *told]
            )
    return out.getvalue()


def times(runs: Sequence[Run]) -> str:
    """What jobs took, one line for whoever was asked; empty where that is not known."""
    out = io.StringIO()
    if rows := seconds(runs):
        writer = csv.DictWriter(out, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return out.getvalue()
