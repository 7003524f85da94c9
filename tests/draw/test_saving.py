"""Pictures as files: whole, the same bytes every time, text as text."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image
from tests.draw.cells import gearbox, greedy, thesis, thesis_front, thesis_schedules

from tandem.draw import overview, plot_compare, plot_front, plot_gantt, plot_graph, save
from tandem.draw.style import looks
from tandem.errors import UsageError

PICTURES = {
    "gantt": lambda: plot_gantt(gearbox(), greedy(gearbox())),
    "front": lambda: plot_front(thesis_front()),
    "graph": lambda: plot_graph(gearbox()),
    "compare": lambda: plot_compare(thesis(), *thesis_schedules()[:2]),
    "overview": lambda: overview(thesis_front()),
}
STARTS = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}


@pytest.mark.parametrize("ending", STARTS)
@pytest.mark.parametrize("name", PICTURES)
def test_the_same_picture_gives_the_same_bytes(tmp_path: Path, name: str, ending: str) -> None:
    first, second = (
        save(PICTURES[name](), tmp_path / f"{i}{ending}").read_bytes() for i in range(2)
    )
    assert first == second
    assert first.startswith(STARTS[ending])
    assert sorted(p.name for p in tmp_path.iterdir()) == [f"0{ending}", f"1{ending}"]


def test_a_png_is_not_blank_and_has_the_operators_colours(tmp_path: Path) -> None:
    image = Image.open(
        save(plot_gantt(thesis(), thesis_schedules()[0]), tmp_path / "a.png")
    ).convert("RGB")
    found = {
        "#{:02X}{:02X}{:02X}".format(*colour)
        for count, colour in image.getcolors(10**6)
        if count > 500
    }
    assert {look.tint for look in looks(thesis()).values()} <= found


def test_text_in_an_svg_is_text(tmp_path: Path) -> None:
    svg = save(plot_gantt(gearbox(), greedy(gearbox())), tmp_path / "a.svg").read_text()
    assert "Insert shaft</text>" in svg
    assert "time [s]</text>" in svg


def test_another_ending_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"ends in \.svg, \.png or \.pdf, not '\.jpg'"):
        save(plot_front(thesis_front()), tmp_path / "a.jpg")
    assert list(tmp_path.iterdir()) == []
