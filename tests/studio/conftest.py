"""What tests of the studio's page are given."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.studio.page import PATIENCE_MS, Expect, Server, Studio, copied


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """One server for all tests of a file: a process of its own, and one that plans, cost each test
    seconds.
    """
    running = Server(copied(tmp_path_factory.mktemp("studio")))
    yield running
    running.stop()


@pytest.fixture
def studio(browser: Any, server: Server) -> Iterator[Studio]:
    """The studio on a copy of the thesis's example, which may be saved: afterwards its folder is as
    it was.
    """
    opened = Studio(browser, server.path, server)
    yield opened
    opened.close()
    server.settle()
    for beside in server.path.parent.iterdir():
        beside.unlink()
    copied(server.path.parent)


@pytest.fixture
def shared(browser: Any, server: Server) -> Iterator[Studio]:
    """The same on a server that other tests use too; nothing may be saved."""
    before = server.path.read_bytes()
    opened = Studio(browser, server.path, server)
    yield opened
    opened.close()
    assert server.path.read_bytes() == before


@pytest.fixture
def expect() -> Expect:
    api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
    api.expect.set_options(timeout=PATIENCE_MS)
    return api.expect  # type: ignore[no-any-return]
