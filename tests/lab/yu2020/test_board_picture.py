"""Boards drawn as boards: every piece where it lies, with name and time, and in the look of who can
do it.
"""

from __future__ import annotations

import pytest
from matplotlib.patches import Polygon

from tandem.draw.fitted import FittedText
from tandem.lab.yu2020.board import Who, desk
from tandem.lab.yu2020.board_picture import COLOURS, HATCHES, Frame, plot_board, plot_film


def words(ax) -> dict[str, str]:
    """Name of a piece -> what stands on it."""
    ax.figure.canvas.draw()
    return {
        text.get_text().split()[0]: text.get_text()
        for text in ax.texts + list(ax.artists)
        if isinstance(text, FittedText) and text.get_text()
    }


@pytest.fixture
def drawn():
    return plot_board(desk())


def test_every_piece_shows_its_name_and_time(drawn):
    shown = words(drawn)
    assert set(shown) == {piece.name for piece in desk().pieces}
    assert all(str(piece.time) in shown[piece.name] for piece in desk().pieces)
    assert shown["A29"] == "A29  4 s"


def test_robot_pieces_are_hatched_and_pieces_for_either_are_both(drawn):
    fills = [patch for patch in drawn.patches if isinstance(patch, Polygon) and patch.get_fill()]
    hatched = [patch for patch in fills if patch.get_hatch() == HATCHES[Who.ROBOT]]
    assert len(fills) == 53 + 4
    assert len(hatched) == 29 + 4
    assert len({COLOURS[who] for who in COLOURS}) == 2


def test_a_moment_shows_what_is_left_where_it_lies_and_who_has_what_in_hand():
    ax = plot_board(desk(), frame=Frame("12 s", {"A1": 1, "A29": 2}, {"A1": Who.ROBOT}))
    assert set(words(ax)) == {"A1", "A29"}
    assert ax.get_title(loc="left") == "12 s"
    outlines = [
        patch for patch in ax.patches if isinstance(patch, Polygon) and not patch.get_fill()
    ]
    assert sorted(patch.get_linewidth() for patch in outlines) == [1.0, 2.2]
    assert max(patch.get_xy()[:, 1].max() for patch in outlines) < 2.5
    assert "in hand, in the colour of who has it" in [
        text.get_text() for text in ax.get_legend().get_texts()
    ]


def test_a_film_has_a_picture_a_frame_and_hides_what_is_left_over():
    figure = plot_film(
        desk(), [Frame(f"{second} s", {"A1": 1}, {}) for second in range(5)], columns=3
    )
    assert [ax.get_title(loc="left") for ax in figure.axes if ax.axison] == [
        "0 s",
        "1 s",
        "2 s",
        "3 s",
        "4 s",
    ]
    assert len(figure.axes) == 6
