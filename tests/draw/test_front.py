"""The front as a chart: every point, its proof, the knee."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.draw.cells import front_of, layered_front, rows, thesis, thesis_front, thesis_schedules

from tandem.draw.front import plot_front, staircase
from tandem.draw.overview import overview
from tandem.errors import UsageError
from tandem.plan.result import Front


def words(ax) -> list[str]:
    return [text.get_text() for text in ax.texts]


def dots(ax) -> list[tuple[float, float, str]]:
    """Makespan, stress and fill of every point."""
    found = [line for line in ax.lines if line.get_marker() == "o" and line.get_gid() != "knee"]
    return [
        (line.get_xdata()[0], line.get_ydata()[0], line.get_markerfacecolor()) for line in found
    ]


def test_every_point_is_there_with_its_numbers() -> None:
    ax = plot_front(thesis_front())
    assert [dot[:2] for dot in dots(ax)] == [(23, 7), (24, 3), (34, 2)]
    assert sorted(words(ax)) == ["23 s, 7", "24 s, 3 (knee)", "34 s, 2"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("makespan [s]", "stress")


def test_the_ring_is_around_the_knee() -> None:
    ring = next(line for line in plot_front(thesis_front()).lines if line.get_gid() == "knee")
    assert (ring.get_xdata()[0], ring.get_ydata()[0]) == (24, 3)


def test_points_that_are_not_proven_are_hollow_and_reach_to_their_bounds() -> None:
    ax = plot_front(front_of(thesis(), thesis_schedules(), proven=False, slack=0.5))
    assert {dot[2] for dot in dots(ax)} == {"white"}
    ends = {
        (line.get_xdata()[0], line.get_ydata()[0])
        for line in ax.lines
        if line.get_marker() in ("|", "_")
    }
    assert {(11.5, 7.0), (23.0, 3.5)} <= ends
    assert "white" not in {dot[2] for dot in dots(plot_front(thesis_front()))}


def test_the_dominated_area_is_what_the_points_dominate() -> None:
    assert staircase(thesis_front().points, 40, 10) == [
        (23, 10),
        (23, 7),
        (24, 7),
        (24, 3),
        (34, 3),
        (34, 2),
        (40, 2),
    ]


def test_labels_never_meet() -> None:
    ax = plot_front(layered_front())
    ax.figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.texts]
    assert len(boxes) >= 3
    assert [(a, b) for i, a in enumerate(boxes) for b in boxes[:i] if a.overlaps(b)] == []


@pytest.mark.parametrize("count", [1, 2])
def test_short_fronts_have_a_window_around_them(count: int) -> None:
    ax = plot_front(front_of(thesis(), thesis_schedules()[:count]))
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    assert all(left < x < right and low < y < high for x, y, _ in dots(ax))
    assert not any("knee" in word for word in words(ax))


def test_an_empty_front_is_drawn_as_one() -> None:
    empty = Front(thesis(), (), False, "exact", "cp-sat", 0, 0.0)
    assert dots(plot_front(empty)) == []
    assert len(overview(empty).axes) == 1


def test_the_overview_has_the_front_and_the_gantt_chart_of_the_knee() -> None:
    upper, lower = overview(thesis_front()).axes
    assert upper.get_xlabel() == "makespan [s]"
    assert lower.get_title(loc="left") == "Recommended: makespan 24 s, stress 3"
    assert len([p for p in lower.patches if (p.get_gid() or "").startswith("task ")]) == 7


def test_front_plot_is_this_chart() -> None:
    assert [dot[:2] for dot in dots(thesis_front().plot())] == thesis_front().points


def test_a_german_overview_has_german_words_and_a_decimal_comma() -> None:
    cell = thesis().replace(
        name="Zelle", tasks={"1": {"time": {"robot": 2.5, "human": 1.25}, "stress": 0.75}}
    )
    front = front_of(cell, [rows(("1", "human", 0, 1.25)), rows(("1", "robot", 0, 2.5))])
    upper, lower = overview(front, language="de").axes
    upper.figure.canvas.draw()
    assert (upper.get_xlabel(), upper.get_ylabel(), lower.get_xlabel()) == (
        "Dauer [s]",
        "Belastung",
        "Zeit [s]",
    )
    assert upper.get_title(loc="left") == "2 Punkte, vollständig und bewiesen"
    assert {"1,25 s; 0,75", "2,5 s; 0"} <= {text.get_text() for text in upper.texts}
    assert {text.get_text() for text in upper.get_legend().get_texts()} == {
        "bewiesen",
        "empfohlen",
        "dominiert",
    }
    assert not [
        label
        for axis in (upper.xaxis, upper.yaxis, lower.xaxis)
        for label in axis.get_ticklabels()
        if "." in label.get_text()
    ]


def test_a_language_that_pictures_do_not_speak_is_refused() -> None:
    with pytest.raises(UsageError, match=r"'fr': reports speak de, en\."):
        overview(thesis_front(), language="fr")


def cut_short() -> Front:
    """A front of which a part is open: three proven points, one that is not, and the bound."""
    front = front_of(thesis(), thesis_schedules(), proven=False, slack=0.0)
    corners = ((23.0, 5.0), (24.0, 3.0), (30.0, 2.0))
    return replace(front, complete=False, bound_front=corners, open_area=0.1)


def test_of_a_front_cut_short_the_bound_and_what_is_open_are_drawn() -> None:
    ax = plot_front(cut_short())
    bound = next(line for line in ax.lines if line.get_gid() == "bound")
    assert bound.get_linestyle() == "--"
    corners = list(zip(bound.get_xdata(), bound.get_ydata(), strict=True))
    assert corners[2:-1] == [(24, 5), (24, 3), (30, 3), (30, 2)]
    between = next(patch for patch in ax.patches if patch.get_gid() == "open")
    assert between.get_hatch()
    assert not any(line.get_marker() in ("|", "_") for line in ax.lines)
    assert "24 s, 3 (recommended)" in words(ax)


@pytest.mark.parametrize(
    ("language", "said"),
    [
        (
            "en",
            ["found, not proven", "open: better may exist here", "bound: nothing lies below it"],
        ),
        ("de", ["gefunden, nicht bewiesen", "offen: hier kann es Besseres geben"]),
    ],
)
def test_the_legend_says_what_is_found_proven_and_open(language: str, said: list[str]) -> None:
    legend = plot_front(cut_short(), language=language).get_legend()
    assert legend is not None
    assert set(said) <= {text.get_text() for text in legend.get_texts()}


def test_a_complete_front_has_neither() -> None:
    ax = plot_front(thesis_front())
    assert not {"bound", "open"} & {artist.get_gid() for artist in [*ax.lines, *ax.patches]}
