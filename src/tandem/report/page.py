"""The frame of every page that we write: one HTML file that opens anywhere, without a network,
prints on A4 and needs no script to be read; with the document that it shows inside.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from functools import lru_cache
from importlib import resources
from typing import Any

from tandem.cell.model import Cell
from tandem.draw.style import Look, looks
from tandem.report.language import Words
from tandem.report.markup import Markup, hatch_id, hatches, tag

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
"""What a browser may load for this page: nothing that is not in it."""

ON_A_PAGE = 40
"""So many steps of a plan fit on a page of paper, and so are not torn apart."""


def page(
    cell: Cell,
    title: str,
    header: Iterable[Markup],
    main: Iterable[Markup],
    document: Mapping[str, Any],
    t: Words,
    *,
    opens: int,
    shades: bool = False,
) -> str:
    """The page as text.

    Args:
      header: what stands below the title; `main`: the sections.
      document: the result document, so that every number of the page can be read by a program.
      opens: the plan with which the page opens, counted from 1.
      shades: drawings tell products apart by shade.
    """
    body = tag(
        "body",
        hatches(looks(cell), shades=shades),
        tag("header", tag("h1", title), *header),
        tag("main", *main),
        tag("footer", tag("p", t("safety"), class_="note")),
        _data(document),
        tag("script", Markup(_shipped("page.js"))),
        data_opens=opens,
    )
    head = tag(
        "head",
        Markup('<meta charset="utf-8">'),
        Markup(f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'),
        Markup('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        Markup('<link rel="icon" href="data:,">'),
        tag("title", title),
        tag("style", Markup(_shipped("page.css"))),
    )
    return "<!DOCTYPE html>\n" + tag("html", head, body, lang=t("language")) + "\n"


def lead(sentences: Iterable[str], *, stale: bool) -> list[Markup]:
    """What a reader must know, a paragraph each; the first, that the cell has changed, in bold."""
    return [
        tag("p", tag("strong", said) if stale and not place else said, class_="lead")
        for place, said in enumerate(sentences)
    ]


def printing(says: str, more: Mapping[str, str]) -> Markup:
    """What is printed, and what more can be, as ("plans" or "more", words): boxes to tick, which
    need no script.
    """
    boxes = (
        tag(
            "label",
            Markup(f'<input type="checkbox" id="print-{key}" autocomplete="off">'),
            " ",
            said,
        )
        for key, said in more.items()
    )
    return tag("p", says, *boxes, class_="screen printing")


def all_or_one(t: Words) -> Markup:
    """The hint to choose a point, and the button that shows all of them."""
    button = tag(
        "button",
        t("front.all"),
        id="all",
        type="button",
        hidden=True,
        data_all=t("front.all"),
        data_single=t("front.single"),
    )
    return tag("p", t("front.hint"), " ", button, class_="screen")


def badges(marks: Iterable[str], t: Words) -> list[object]:
    """What makes a plan special, behind its title; `marks` are keys of words."""
    return [piece for key in marks for piece in (" ", tag("span", t(key), class_="badge"))]


def key(look: Look, cell: Cell) -> Markup:
    """An operator's fill, name and letters."""
    box = tag(
        "svg",
        tag("rect", width=30, height=20, fill=f"url(#{hatch_id(look, looks(cell))})"),
        width=30,
        height=20,
        aria_hidden="true",
    )
    return tag("span", box, f"{look.letters}: {look.label}", class_="key")


def assumed(sentences: Iterable[str], t: Words) -> Markup:
    """What was modelled and how far it is proven."""
    return tag(
        "section",
        tag("h2", t("assume.title"), id="assumptions"),
        tag("ul", *(tag("li", sentence) for sentence in sentences)),
        class_="keep papers",
    )


def how_made(entries: Iterable[tuple[str, str]], t: Words) -> Markup:
    """How the page was made, as (what, value)."""
    listed = tag(
        "dl",
        *(piece for what, value in entries for piece in (tag("dt", what), tag("dd", value))),
    )
    return tag(
        "section",
        tag("h2", t("made.title"), id="made"),
        listed,
        tag("p", t("made.data"), class_="note"),
        class_="keep",
    )


def _data(document: Mapping[str, Any]) -> Markup:
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    for sign, safe in (
        ("<", "\\u003c"),
        (">", "\\u003e"),
        ("&", "\\u0026"),
        ("\u2028", "\\u2028"),
        ("\u2029", "\\u2029"),
    ):
        text = text.replace(sign, safe)
    return tag("script", Markup(text), type="application/json", id="result")


@lru_cache
def _shipped(name: str) -> str:
    return (resources.files("tandem.report") / name).read_text("utf-8")
