"""How long the studio's page takes from a moved pointer to the painted picture, while a bar is
dragged.

    python benchmarks/studio_drag.py 200 1000

Prints for each number of bars the median and the 95th percentile, milliseconds, in headless
Chromium. Needs Chromium (`apt-get install chromium`) and `pip install playwright`.
"""

from __future__ import annotations

import json
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
MOVES = 120
# A frame's callbacks run before it is painted, a message sent from there arrives after it was.
LISTEN = """() => {
    window.delays = [];
    addEventListener("pointermove", event => requestAnimationFrame(() => {
        const channel = new MessageChannel();
        channel.port1.onmessage = () => delays.push(performance.now() - event.timeStamp);
        channel.port2.postMessage(0);
    }), true);
}"""


def cell_of(count: int) -> dict[str, Any]:
    """So many short tasks that two operators can do, in chains of ten."""
    draw = random.Random(count)
    tasks = {
        f"t{i}": {
            "time": {"robot": draw.randint(2, 9), "human": draw.randint(2, 9)},
            "stress": draw.randint(0, 5),
            **({"after": [f"t{i - 1}"]} if i % 10 else {}),
        }
        for i in range(count)
    }
    operators = {"robot": {"kind": "robot"}, "human": {"kind": "human"}}
    return {"format": 1, "operators": operators, "tasks": tasks}


def delays(browser: Any, count: int) -> list[float]:
    """Milliseconds from each move of the pointer to its picture."""
    with tempfile.TemporaryDirectory() as work:
        path = Path(work) / "cell.json"
        path.write_text(json.dumps(cell_of(count)))
        server = subprocess.Popen(
            [sys.executable, "-m", "tandem", "studio", str(path), "--port", "0", "--no-browser"],
            stdout=subprocess.PIPE,
            text=True,
        )
        assert server.stdout is not None
        page = browser.new_page(viewport={"width": 1280, "height": 900}, locale="en-US")
        page.set_default_timeout(120_000)
        page.goto(server.stdout.readline().strip())
        page.get_by_label("Search for [s]").fill("5")
        page.get_by_role("button", name="Plan", exact=True).click()
        page.locator("[role=option][aria-selected=true]").wait_for()
        page.get_by_role("button", name="Plan", exact=True).wait_for()
        bar = page.locator("button.bar").first.bounding_box()
        x, y = bar["x"] + bar["width"] / 2, bar["y"] + bar["height"] / 2
        page.evaluate(LISTEN)
        page.mouse.move(x, y)
        page.mouse.down()
        for step in range(MOVES):
            page.mouse.move(x + 6 + step * 4, y + (step % 20) * 3)
        page.keyboard.press("Escape")
        page.mouse.up()
        found: list[float] = page.evaluate("delays")
        page.close()
        server.send_signal(signal.SIGINT)
        server.wait(60)
    return found


def main(counts: list[int]) -> None:
    with sync_playwright() as api:
        browser = api.chromium.launch(executable_path=shutil.which("chromium"), args=OPTIONS)
        for count in counts:
            found = sorted(delays(browser, count))
            p95 = statistics.quantiles(found, n=20)[-1]
            median = statistics.median(found)
            print(f"{count:5} bars: median {median:.1f} ms, p95 {p95:.1f} ms, {len(found)} moves")
        browser.close()


if __name__ == "__main__":
    main([int(text) for text in sys.argv[1:]] or [200, 1000])
