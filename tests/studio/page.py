"""The studio's page in a real Chromium, with the real server behind it: what tests of the page
share.
"""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

import pytest

THESIS = Path(__file__).parents[2] / "examples/thesis.yaml"
PATIENCE_MS = 30_000
"""A busy machine is no fault of the page."""
Expect = Callable[..., Any]

browsing = pytest.mark.browser


class Server:
    """`tandem studio` on a cell file or a folder."""

    def __init__(self, path: Path):
        self.path = path
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tandem", "studio", str(path), "--port", "0", "--no-browser"],
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().strip()

    def settle(self) -> None:
        """Comes back once it has answered what it was asked before."""
        place = urlsplit(self.address)
        token = {"X-Tandem-Token": place.fragment.removeprefix("token=")}
        request = Request(f"http://{place.netloc}/api/health", headers=token)
        with urlopen(request, timeout=PATIENCE_MS / 1000) as answer:
            assert answer.status == 200

    def stop(self) -> None:
        self.process.send_signal(signal.SIGINT)
        assert self.process.wait(30) == 0


class Studio:
    """Pages that look at a cell file, of a server that others may use too."""

    def __init__(self, browser: Any, path: Path, server: Server | None = None):
        self.path = path
        self.own = None if server else Server(path)
        self.server = server or self.own
        assert self.server is not None
        self.address = self.server.address
        self.context = browser.new_context(
            viewport={"width": 1280, "height": 900}, locale="en-US", accept_downloads=True
        )
        self.context.set_default_timeout(PATIENCE_MS)
        self.errors: list[str] = []
        self.requests: list[str] = []

    def open(self) -> Any:
        """A page in which the cell can be seen."""
        page = self.context.new_page()
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.goto(self.address)
        page.get_by_role("grid").wait_for()
        return page

    def close(self) -> None:
        """At the end nothing may have failed, and nothing been asked of another host."""
        self.context.close()
        if self.own:
            self.own.stop()
        assert self.errors == []
        hosts = {urlsplit(url).netloc for url in self.requests if url.startswith("http")}
        assert hosts == {urlsplit(self.address).netloc}


def copied(folder: Path) -> Path:
    """A copy of the thesis's example."""
    return Path(shutil.copy(THESIS, folder / "cell.yaml"))


def cell_at(page: Any, row: int, column: str) -> Any:
    """The cell of a row, from 0, in the column with that heading."""
    headings = page.get_by_role("grid").get_by_role("columnheader").all_inner_texts()
    return page.locator(f"td[data-row='{row}'][data-column='{headings.index(column)}']")


def enter(page: Any, row: int, column: str, text: str) -> None:
    cell_at(page, row, column).click()
    page.keyboard.type(text)
    page.keyboard.press("Enter")


def button(page: Any, name: str) -> Any:
    return page.get_by_role("button", name=name, exact=True)


def planned(page: Any, expect: Expect) -> list[str]:
    """Plans, and returns the names of the front's points once all is proven."""
    button(page, "Plan").click()
    expect(page.get_by_role("status")).to_contain_text("all proven")
    return page.locator("[role=option] .numbers").all_inner_texts()


def bars(page: Any) -> list[str]:
    return sorted(
        one.get_attribute("aria-label") for one in page.locator("button.bar[data-task]").all()
    )


def paste(page: Any, text: str) -> None:
    """Pastes a block as another program copies it."""
    page.evaluate(
        """text => {
            const data = new DataTransfer();
            data.setData("text/plain", text);
            document.activeElement.dispatchEvent(
                new ClipboardEvent("paste", {clipboardData: data, bubbles: true, cancelable: true}))
        }""",
        text,
    )
