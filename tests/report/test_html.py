"""The report as text: everything is in it, nothing is fetched, nothing in a name is taken for
markup.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html import escape
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
from tests.draw.cells import (
    desk,
    front_of,
    gearbox_front,
    greedy,
    layered_front,
    thesis,
    thesis_front,
    thesis_schedules,
)

from tandem.draw.layers import reduced
from tandem.draw.style import contrast
from tandem.errors import UsageError
from tandem.plan.result import Front, Status
from tandem.report.html import html, summary
from tandem.report.instructions import steps
from tandem.report.language import words
from tandem.report.markup import fitting, tag, ticks, width_of
from tandem.report.svg_gantt import panel_times
from tandem.report.tables import shown_plans
from tandem.schedule.model import Schedule

FRONTS = {
    "thesis": thesis_front(),
    "gearbox": gearbox_front(),
    "desk": front_of(desk(), [greedy(desk())], proven=False, slack=0.1),
}
NASTY = "<script>alert(1)</script> & \"quoted\" 'x' </script><!--"


def drawings(page: str) -> list[ElementTree.Element]:
    """Every drawing; that they parse says that they are well formed."""
    return [
        ElementTree.fromstring(found.replace(' xmlns="http://www.w3.org/2000/svg"', ""))
        for found in re.findall(r"<svg.*?</svg>", page, re.S)
    ]


def charts(page: str, kind: str) -> list[ElementTree.Element]:
    return [svg for svg in drawings(page) if kind in (svg.get("class") or "").split()]


def with_class(svg: ElementTree.Element, *names: str) -> list[ElementTree.Element]:
    return [e for e in svg.iter() if e.get("class") in names]


@pytest.mark.parametrize("name", FRONTS)
def test_every_plan_has_a_bar_for_each_task_of_each_operator(name: str) -> None:
    front = FRONTS[name]
    page = html(front)
    for place, result in enumerate(front, 1):
        section = page.partition(f'id="plan-{place}"')[2].partition("</section>")[0]
        panels = panel_times(result.schedule, 1000)
        bars = [e for svg in charts(section, "gantt") for e in with_class(svg, "bar", "critical")]
        wanted = sum(len(a.operators) for a in result.schedule)
        assert len(bars) == wanted if len(panels) == 1 else len(bars) >= wanted
        for a in result.schedule:
            assert f"{front.cell.tasks[a.task].label or a.task}: " in section


def test_bars_stand_where_their_tasks_do() -> None:
    (gantt,) = charts(html(front_of(thesis(), thesis_schedules()[:1])), "gantt")
    boxes = {
        e.find("title").text.split(":")[0]: next(r for r in e.iter("rect"))
        for e in with_class(gantt, "task")
    }
    start, end = (
        float(boxes["1"].get("x")),
        float(boxes["7"].get("x")) + float(boxes["7"].get("width")),
    )
    scale = (end - start) / 23
    for a in thesis_schedules()[0]:
        assert float(boxes[a.task].get("x")) == pytest.approx(start + a.start * scale, abs=0.1)
        assert float(boxes[a.task].get("width")) == pytest.approx(
            (a.end - a.start) * scale, abs=0.1
        )


def test_every_point_is_a_link_to_its_plan() -> None:
    page = html(thesis_front())
    (chart,) = charts(page, "front")
    points = with_class(chart, "point")
    assert [p.get("href") for p in points] == ["#plan-1", "#plan-2", "#plan-3"]
    assert points[1].get("aria-label") == "Plan 2: 24 s, stress 3, proven"
    assert all(f'id="{p.get("href")[1:]}"' in page for p in points)


@pytest.mark.parametrize(
    ("language", "said", "doubted"),
    [
        ("en", "Dashed line: the bound", "with more time it may be another"),
        ("de", "Gestrichelte Linie: die Schranke", "Mit mehr Zeit kann es eine andere sein"),
    ],
)
def test_what_is_found_proven_and_open_differs_by_more_than_colour(
    language: str, said: str, doubted: str
) -> None:
    whole = thesis_front()
    cut = replace(
        whole,
        results=tuple(replace(result, status=Status.FEASIBLE) for result in whole),
        complete=False,
        bound_front=((23.0, 5.0), (24.0, 3.0), (30.0, 2.0)),
    )
    page = html(cut, language=language)
    (chart,) = charts(page, "front")
    assert len(with_class(chart, "bound")) == len(with_class(chart, "open-area")) == 1
    assert not with_class(chart, "bounds")
    assert len(with_class(chart, "dot open")) == 3
    assert said in page
    assert doubted in page
    (chart,) = charts(html(whole, language=language), "front")
    assert not with_class(chart, "bound", "open-area")


@pytest.mark.parametrize("name", FRONTS)
def test_the_graph_has_every_task_and_every_arrow(name: str) -> None:
    cell = FRONTS[name].cell
    chart = charts(html(FRONTS[name]), "graph")[0]
    assert len(with_class(chart, "node", "node critical")) == len(cell.tasks)
    assert len(with_class(chart, "arrow", "arrow bold")) == sum(map(len, reduced(cell).values()))


def test_names_are_never_taken_for_markup() -> None:
    renamed = {"1": NASTY}
    tasks = {
        renamed.get(n, n): t.model_copy(update={"after": tuple(renamed.get(a, a) for a in t.after)})
        for n, t in thesis().tasks.items()
    }
    operators = {"robot": {"kind": "robot", "label": NASTY}, "human": {"kind": "human"}}
    cell = thesis().replace(name=NASTY, tasks=tasks, operators=operators)
    rows = [
        {**row, "task": renamed.get(row["task"], row["task"])}
        for row in thesis_schedules()[0].to_list()
    ]
    page = html(front_of(cell, [Schedule.from_list(rows)]), command=NASTY, date=NASTY)
    found: list[str] = []

    class Scripts(HTMLParser):
        def handle_starttag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
            found.append(name)
            assert not any(key.startswith("on") for key, _ in attributes)

    Scripts().feed(page)
    assert found.count("script") == 2
    assert page.count("</script>") == 2
    assert "alert(1)</title>" not in page
    drawings(page)


def test_all_numbers_are_in_the_page_as_data() -> None:
    page = html(gearbox_front())
    document = json.loads(
        re.search(r'<script type="application/json" id="result">(.*?)</script>', page, re.S)[1]
    )
    assert {key: document[key] for key in gearbox_front().to_dict()} == gearbox_front().to_dict()
    assert document["cell_document"] == gearbox_front().cell.to_dict()


def test_nothing_is_fetched_from_anywhere() -> None:
    page = html(gearbox_front())
    urls = set(
        re.findall(
            r"""(?:https?:)?//[\w.-]+[^\s"'<)]*""", re.sub(r"^\s*//.*$", "", page, flags=re.M)
        )
    )
    assert urls <= {"http://www.w3.org/2000/svg"}
    assert not re.search(r"@import|src=|url\((?!#)", page)
    assert "default-src 'none'" in page


def test_it_says_how_it_was_made() -> None:
    page = html(thesis_front(), command="tandem plan thesis.yaml -o report.html", date="2026-05-01")
    for said in (
        "tandem plan thesis.yaml -o report.html",
        "2026-05-01",
        "cp-sat 9.14.6206",
        thesis().digest,
        "tandem 0.",
    ):
        assert said in page
    assert '<html lang="en">' in page
    assert html(thesis_front()) == html(thesis_front())


def test_the_summary_is_for_people() -> None:
    assert summary(thesis_front(), words()) == [
        (
            "7 tasks are to be done by 1 human and 1 robot. There are 3 sensible compromises"
            " between time and stress: the quickest takes 23 s with stress 7, the gentlest takes 34"
            " s with stress 2. We recommend plan 2: 24 s with stress 3. It takes 1 s (4.3 %) longer"
            " than the quickest and spares 4 (57 %) of its stress."
        ),
        (
            "This is proven: whatever plan is made for this cell, one of these is at least as quick"
            " and puts no more stress on people."
        ),
    ]
    open_front = front_of(thesis(), thesis_schedules(), proven=False, slack=0.1)
    assert "better plans may exist" in summary(open_front, words())[1]
    assert (
        summary(Front(thesis(), (), False, "exact", "cp-sat", 0, 1.0), words())[1]
        == "No plan was found."
    )


def test_assumptions_name_what_the_cell_has_and_nothing_else() -> None:
    thesis_page, gearbox_page = html(thesis_front()), html(gearbox_front())
    for sentence in ("driver (2 of it)", "Anna 30–40 s", "Ben 30", "A joint task occupies"):
        assert sentence in gearbox_page
        assert sentence not in thesis_page
    assert "Proof: complete" in thesis_page
    assert "Proven plans: 0 of 3" in html(
        front_of(thesis(), thesis_schedules(), proven=False, slack=0.1)
    )


def test_an_empty_front_has_a_page_too() -> None:
    page = html(Front(thesis(), (), False, "exact", "cp-sat", 0, 1.0))
    assert "No plan was found." in page
    assert charts(page, "graph")


def test_many_plans_share_the_table_of_tasks() -> None:
    front = layered_front()
    assert len(front) > 6
    shown = shown_plans(front)
    assert len(shown) <= 6
    assert {0, len(front) - 1, front.results.index(front.knee)} <= set(shown)


def test_text_is_dark_enough_and_large_enough() -> None:
    page = html(gearbox_front())
    css = page.partition("<style>")[2].partition("</style>")[0]
    colours = dict(re.findall(r"--(\w+): (#\w{6})", css))
    assert min(contrast(colours[name], "#FFFFFF") for name in ("ink", "faint", "blue")) >= 4.5
    assert contrast(colours["faint"], colours["shade"]) >= 4.5
    assert min(float(size) for size in re.findall(r'font-size="([\d.]+)"', page)) >= 16


def test_an_unknown_language_is_refused() -> None:
    with pytest.raises(UsageError, match=r"language 'xx': reports speak .*en"):
        html(thesis_front(), language="xx")
    with pytest.raises(UsageError):
        words("../en")


def test_small_pieces() -> None:
    assert (
        tag("a", "<&", class_="x", hidden=True, id=None, data_n=1.0)
        == '<a class="x" hidden="" data-n="1">&lt;&amp;</a>'
    )
    assert tag("p", "bell\x07") == "<p>bell</p>"
    assert fitting(["a long wording", "short"], width_of("short", 16)) == "short"
    assert fitting(["a long wording"], 100).endswith("…")
    assert fitting(["word"], 3) == ""
    assert ticks(0, 23, 12) == [0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22]
    assert ticks(0.1, 0.34, 5) == [0.1, 0.15, 0.2, 0.25, 0.3]


@pytest.mark.parametrize(
    ("language", "heading"), [("en", "Instructions for human"), ("de", "Anweisung für human")]
)
def test_each_plan_has_an_instruction_sheet_for_each_operator(language: str, heading: str) -> None:
    front = thesis_front()
    page = html(front, language=language)
    sheets = re.findall(r'<details class="sheet \w+" open="">.*?</details>', page, re.DOTALL)
    assert len(sheets) == len(front) * 2
    t = words(language)
    rows = re.findall(
        r"<tr><td.*?</tr>", next(sheet for sheet in sheets if heading in sheet), re.DOTALL
    )
    assert [len(rows), "4" in rows[-1]] == [len(front[0].schedule.of("human")), True]
    for step, row in zip(steps(front.cell, front[0].schedule, "human", t), rows, strict=True):
        said = (*(condition.says for condition in step.begin), *step.then)
        assert all(escape(sentence) in row for sentence in said)


@pytest.mark.parametrize(
    ("word", "pieces"),
    [
        (
            "tandem.lab.antonelli2021.qlearning",
            ["tandem.", "lab.", "antonelli", "2021.", "qlearning"],
        ),
        ("board_training", ["board_", "training"]),
        ("SmallestOfAllCells", ["Smallest", "Of", "All", "Cells"]),
        ("Donaudampfschifffahrt", ["Donaudamp", "fschifffa", "hrt"]),
        ("12345678.12345678", ["12345678.", "12345678"]),
        ("short.word", ["short.word"]),
    ],
)
def test_a_long_word_of_a_cell_is_broken_at_its_joints_first(word: str, pieces: list[str]) -> None:
    assert tag("td", word) == f"<td>{'<wbr>'.join(pieces)}</td>"
