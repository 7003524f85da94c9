"""All published systems on one page: what each can do, found by letting it try, and each system's
table and figures with the exact values beside.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.atomic import store
from tandem.lab.antonelli2021.cells import own_cell
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.probes import PROBES, Entry, base, features, other_cells, tooled
from tandem.lab.published import published
from tandem.lab.systems import SYSTEMS, System
from tandem.learn.room import make_room
from tandem.learn.training.runs import versions
from tandem.report.from_markdown import html_of
from tandem.report.markup import Markup, tag
from tandem.report.tables import table

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""What a browser may load for this page: nothing that is not in it."""
LARGEST = 250_000
"""A figure of more bytes as SVG is put in as PNG."""
FILE = "comparison.html"


@dataclass(frozen=True)
class Shown:
    """One system on the page.

    Attributes:
      document: its result; None when there is none, and `missing` says why.
      table: its Markdown. figures: its pictures, SVG where there is one.
      entries: feature -> what the probe found. others: cell -> whether it can express it.
    """

    name: str
    title: str
    document: Mapping[str, Any] | None
    missing: str
    table: str
    figures: Sequence[Path]
    entries: Mapping[str, Entry]
    others: Mapping[str, Entry]


def cells_to_try() -> dict[str, Cell]:
    """Cells that every system is shown; none of them is the own cell of all."""
    return {
        "three tasks": base(),
        "the thesis's cell": thesis_cell(),
        "two flanges, joint tasks": own_cell(),
        "a cell with tools": tooled(5.0),
    }


def compare(
    folder: Path,
    *,
    quick: bool = False,
    stored: bool = False,
    seeds: int | None = None,
    systems: Mapping[str, System] | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> tuple[Path, dict[str, Any]]:
    """Runs every published system (or takes its stored result), lets each try every feature, and
    writes `folder/comparison.html`.

    Returns the page, and the results and the matrix as plain data. A stored result that is missing
    is said on the page.
    """
    shown, cells = [], cells_to_try()
    for name, system in (SYSTEMS if systems is None else systems).items():
        if not system.published:
            continue
        make_room()
        experiment, document, missing = system.load(), None, ""
        try:
            document = (
                experiment.stored()
                if stored
                else experiment.reproduce(folder / name, quick=quick, seeds=seeds, tell=tell)
            )
        except CellError as error:
            missing = error.faults[0].message
            tell(f"{name}: {error.faults[0]}")
        tell(f"{name}: what it can do")
        figures = experiment.draw_figures(document, folder / name) if document is not None else []
        words = experiment.table(document) if document is not None else ""
        found = features(experiment, document)
        shown.append(
            Shown(
                name,
                system.title,
                document,
                missing,
                words,
                figures,
                found,
                other_cells(experiment, cells),
            )
        )
    page = folder / FILE
    folder.mkdir(parents=True, exist_ok=True)
    store(
        page,
        html(shown, command="tandem reproduce --all" + " --quick" * quick + " --stored" * stored),
    )
    return page, {
        "schema_version": 1,
        "systems": {one.name: one.document for one in shown},
        "features": {
            one.name: {feature: entry._asdict() for feature, entry in one.entries.items()}
            for one in shown
        },
        "published": {
            one.name: {feature: published(one.name, feature)._asdict() for feature in PROBES}
            for one in shown
        },
        "other_cells": {
            one.name: {cell: entry._asdict() for cell, entry in one.others.items()} for one in shown
        },
        "versions": versions(),
    }


def html(shown: Sequence[Shown], *, command: str) -> str:
    """The page as text: self-contained, no script."""
    made = versions()
    body = tag(
        "body",
        tag(
            "header",
            tag("h1", "Published systems, run here"),
            *(tag("p", sentence, class_="lead") for sentence in _lead(shown)),
        ),
        tag(
            "main",
            _matrix(shown),
            _findings(shown),
            _others(shown),
            *(_section(one) for one in shown),
        ),
        tag(
            "footer",
            tag(
                "p",
                "Made with: ",
                tag("code", command),
                f", tandem {made['tandem']}, JAX {made['jax']}, Python {made['python']},"
                f" {made['machine']}.",
            ),
            class_="note",
        ),
    )
    head = tag(
        "head",
        Markup('<meta charset="utf-8">'),
        Markup(f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'),
        Markup('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        Markup('<link rel="icon" href="data:,">'),
        tag("title", "Published systems compared"),
        tag(
            "style",
            Markup((resources.files("tandem.report") / "page.css").read_text("utf-8") + STYLE),
        ),
    )
    return "<!DOCTYPE html>\n" + tag("html", head, body, lang="en") + "\n"


STYLE = """
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(24rem, 1fr)); gap: 1rem;
  margin: 1rem 0; }
.figures figure { margin: 0; break-inside: avoid; }
.figures img { width: 100%; height: auto; max-height: 32rem; object-fit: contain;
  object-position: left top; }
.matrix td { max-width: 12rem; overflow-wrap: break-word; hyphens: auto; }
.findings td:last-child { max-width: 28rem; overflow-wrap: anywhere; }
@media (max-width: 60rem) {
  .matrix table { font-size: .85rem; }
  .matrix th, .matrix td { padding-right: .4rem; }
  .matrix tbody th { min-width: 0; }
}
/* The widest table has a dozen columns: as narrow as their words on a screen, which scrolls when
   that is not enough; on paper nothing scrolls. */
.wide table { font-size: .93rem; }
.wide th, .wide td { padding-right: .5rem; }
.wide tbody th { min-width: 0; }
@media print {
  .figures { grid-template-columns: 1fr 1fr; }
  .figures img { max-height: 85mm; }
  .wide table { font-size: 8.5pt; }
}
"""


def _lead(shown: Sequence[Shown]) -> Iterator[str]:
    yield (
        f"{len(shown)} systems that learn to share assembly work between people and robots, each"
        " re-implemented from what is publicly known. Where a paper does not give its numbers they"
        " are ours; each system's page in the manual says which."
    )
    yield (
        "The first table is about these systems as they are rebuilt here, and is not written by"
        " hand: every entry is what happened when the system was given a small cell to try. The"
        " second puts what is published beside it."
    )


def _matrix(shown: Sequence[Shown]) -> Markup:
    heads = [("", ""), *((one.title.partition(":")[0], "") for one in shown)]
    rows = [
        tag(
            "tr",
            tag("th", feature, scope="row"),
            *(
                tag("td", one.entries[feature].value, title=one.entries[feature].how)
                for one in shown
            ),
        )
        for feature in PROBES
    ]
    return tag(
        "section",
        tag("h2", "What each can do as it is rebuilt here", id="features"),
        tag("div", table(heads, rows, "What each can do as it is rebuilt here"), class_="matrix"),
    )


def _findings(shown: Sequence[Shown]) -> Markup:
    heads = [(word, "") for word in ("", "system", "published", "rebuilt here", "how found")]
    rows = [
        _finding(feature, one, len(shown) if place == 0 else 0)
        for feature in PROBES
        for place, one in enumerate(shown)
    ]
    return tag(
        "section",
        tag("h2", "Published, and rebuilt here", id="findings"),
        tag(
            "p",
            "Published: what is publicly known of the system, with the source in brackets; nobody"
            ' here has read the papers\' full texts, so "not known" is not "no". Rebuilt here:'
            " what the system in this package did. Costs are in each system's own units: only"
            " whether they move says something.",
            class_="note",
        ),
        tag("div", table(heads, rows, "Published, and rebuilt here"), class_="matrix findings"),
        class_="page",
    )


def _finding(feature: str, one: Shown, rows: int) -> Markup:
    """A row of one feature and one system; the first of a feature names it, `rows` rows long."""
    claim, entry = published(one.name, feature), one.entries[feature]
    source = f" ({claim.source})" if claim.source else ""
    named = [tag("th", feature, scope="rowgroup", rowspan=rows)] if rows else []
    words = (one.title.partition(":")[0], claim.value + source, entry.value, entry.how)
    return tag("tr", *named, *(tag("td", word) for word in words))


def _others(shown: Sequence[Shown]) -> Markup:
    heads = [("", ""), *((one.title.partition(":")[0], "") for one in shown)]
    names = list(shown[0].others) if shown else []
    rows = [
        tag(
            "tr",
            tag("th", cell, scope="row"),
            *(tag("td", _words(one.others[cell])) for one in shown),
        )
        for cell in names
    ]
    return tag(
        "section",
        tag("h2", "The same cells for all", id="others"),
        tag(
            "p",
            "Whether a system can express a cell; if not, what of it it cannot, in its own words.",
            class_="note",
        ),
        tag("div", table(heads, rows, "The same cells for all"), class_="matrix"),
    )


def _words(entry: Entry) -> str:
    return entry.value if not entry.how else f"{entry.value}: {entry.how}"


def _section(one: Shown) -> Markup:
    exact = one.entries["exact optimum known"]
    words = (
        html_of(one.table, one.title)
        if one.document is not None
        else html_of(one.missing, one.title)
    )
    return tag(
        "section",
        tag("h2", one.title, id=one.name),
        tag(
            "p",
            f"Proven beside it: {exact.how}. Run it: ",
            tag("code", f"tandem reproduce {one.name}"),
            class_="note",
        ),
        words,
        tag(
            "div",
            *(tag("figure", _picture(file)) for file in _one_of_each(one.figures)),
            class_="figures",
        ),
        class_="page" if one.document is not None else None,
    )


def _one_of_each(files: Sequence[Path]) -> list[Path]:
    """A picture by name, as SVG when that is not too large, else as PNG."""
    chosen: dict[str, Path] = {}
    for file in sorted(files, key=lambda file: file.suffix == ".svg"):
        if file.suffix == ".png" or (file.suffix == ".svg" and file.stat().st_size <= LARGEST):
            chosen[file.stem] = file
    order = list(dict.fromkeys(file.stem for file in files))
    return [chosen[stem] for stem in order if stem in chosen]


def _picture(file: Path) -> Markup:
    kind = {".svg": "image/svg+xml", ".png": "image/png"}[file.suffix]
    return tag(
        "img",
        src=f"data:{kind};base64,{base64.b64encode(file.read_bytes()).decode()}",
        alt=file.stem.replace("-", " "),
    )
