"""Players beside the front: every number of the table, and a diamond for each place in the
chart.
"""

from __future__ import annotations

import re

from tests.schedule.cells import thesis

from tandem.plan.methods import plan
from tandem.report.html import html
from tandem.report.players import Player


def test_players_stand_beside_the_front():
    front = plan(thesis())
    players = [
        Player("greedy", 24, 3, 0.0, front[1].schedule),
        Player("best of 100", 24, 3, 0.0),
        Player("random", 34.23, 16.72, 0.488),
        Player("<lost>", None, None),
    ]
    page = html(front, players=players)
    assert page.count('class="player"') == 2  # the first two are at one place, the last is nowhere
    assert "greedy, best of 100" in page
    assert "&lt;lost&gt;" in page
    assert "<lost>" not in page
    row = re.search(r"a random player</th>(.*?)</tr>", page)
    assert row is not None
    assert re.findall(r">([^<>]+)</td>", row[1]) == ["34.23", "16.72", "49 %"]
    assert "What the learned policy does: 24 s, stress 3" in page


def test_without_players_nothing_is_said_of_them():
    page = html(plan(thesis()))
    assert 'class="player"' not in page
    assert "trial and error" not in page
