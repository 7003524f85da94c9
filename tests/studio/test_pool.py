"""The studio's worker processes."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

pytest.importorskip("starlette", reason="pip install 'tandem[studio]'")

from tandem.studio.pool import AT_ONCE, Pool

CELL = {
    "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
    "tasks": {"drill": {"time": {"robot": 4, "human": 3}}},
}
DRAGGED = {
    "cell": CELL,
    "assignments": [{"task": "drill", "operators": ["robot"], "start": 0, "end": 4}],
    "task": "drill",
    "operators": ["human"],
    "start": 2,
}
PATIENCE_S = 240


def test_all_that_may_work_at_once_have_loaded_before_the_first_bar_is_dragged() -> None:
    """A bar that is dragged asks about its lanes and its place at the same time. Whoever had to
    wait for a process to load saw nothing for a second.
    """

    async def asked() -> tuple[list[Any], int]:
        pool = Pool()
        await pool.start()
        assert pool.ready == 0
        await pool.wake()
        async with asyncio.timeout(PATIENCE_S):
            while pool.ready < AT_ONCE:
                await asyncio.sleep(0.05)
            told = await asyncio.gather(
                *(pool.document("place", DRAGGED) for _ in range(AT_ONCE + 1))
            )
            left = pool.ready
        await pool.close()
        return told, left

    # a browser's tests may have left an event loop running in this thread
    with ThreadPoolExecutor(1) as thread:
        told, left = thread.submit(asyncio.run, asked()).result()
    assert [one["makespan"] for one in told] == [5] * (AT_ONCE + 1)
    assert left == AT_ONCE  # none was begun or lost
