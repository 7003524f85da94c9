"""How fast the studio is: its start, its page, the front after the key, a pasted block, and from a
moved pointer to the painted picture while a bar is dragged.

    python benchmarks/studio_speed.py 200 1000

Prints each beside its aim, with the load of the machine before it, in headless Chromium. The
numbers are those of bars for the drag. Needs Chromium (`apt-get install chromium`) and
`pip install playwright`.
"""

from __future__ import annotations

import gzip
import json
import os
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[1]
STATIC = ROOT / "src/tandem/studio/static"
OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
PATIENCE_MS = 180_000
MOVES = 120
ROWS = 500
PICTURE_MS = {200: 16, 1000: 33}
"""What the 95th percentile of a drag is to be at most, by the number of bars."""
# A frame's callbacks run before it is painted, a message sent from there arrives after it was.
LISTEN = """() => {
    window.delays = [];
    addEventListener("pointermove", event => requestAnimationFrame(() => {
        const channel = new MessageChannel();
        channel.port1.onmessage = () => delays.push(performance.now() - event.timeStamp);
        channel.port2.postMessage(0);
    }), true);
}"""
# The grid is there and takes the keyboard.
INTERACTIVE = """() => new Promise(done => {
    const look = () => document.querySelector("[role=grid] td")
        ? requestAnimationFrame(() => done(performance.now())) : requestAnimationFrame(look);
    look();
})"""
PAINTED = "() => performance.getEntriesByName('first-contentful-paint')[0].startTime"
# From the key to the picture in which the last point is proven.
KEY_TO_FRONT = """name => new Promise(done => {
    const begun = performance.now();
    const look = () => document.querySelector("[role=status]").textContent.includes(name)
        ? requestAnimationFrame(() => done(performance.now() - begun)) : setTimeout(look, 2);
    dispatchEvent(new KeyboardEvent("keydown", {key: "Enter", ctrlKey: true, bubbles: true}));
    look();
})"""
PASTE = """text => new Promise(done => {
    const data = new DataTransfer();
    data.setData("text/plain", text);
    const begun = performance.now();
    document.activeElement.dispatchEvent(
        new ClipboardEvent("paste", {clipboardData: data, bubbles: true, cancelable: true}));
    requestAnimationFrame(() => {
        const channel = new MessageChannel();
        channel.port1.onmessage = () => done(performance.now() - begun);
        channel.port2.postMessage(0);
    });
})"""


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


def say(what: str, found: float, unit: str, aim: float, more: str = "") -> None:
    met = "met" if found <= aim else "MISSED"
    load = os.getloadavg()[0]
    print(
        f"{what:36} {found:8.1f} {unit:2} aim {aim:5g} {met:6} load {load:4.1f} {more}".rstrip(),
        flush=True,
    )


@contextmanager
def served(browser: Any, cell: Path) -> Iterator[Any]:
    """A page that has not been led anywhere yet, with `page.address`."""
    begun = time.monotonic()
    server = subprocess.Popen(
        [sys.executable, "-m", "tandem", "studio", str(cell), "--port", "0", "--no-browser"],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert server.stdout is not None
    address = server.stdout.readline().strip()
    started = time.monotonic() - begun
    page = browser.new_page(viewport={"width": 1280, "height": 900}, locale="en-US")
    page.set_default_timeout(PATIENCE_MS)
    try:
        yield page, address, started
    finally:
        page.close()
        server.send_signal(signal.SIGINT)
        server.wait(60)


def first_look(browser: Any, work: Path) -> None:
    """Start, page, front and paste on the thesis's cell."""
    cell = work / "cell.yaml"
    shutil.copy(ROOT / "examples/thesis.yaml", cell)
    kinds = {".js", ".css", ".html", ".json"}
    sent = [path for path in STATIC.rglob("*") if path.suffix in kinds]
    size = sum(len(gzip.compress(path.read_bytes())) for path in sent) / 1000
    say("the page, gzipped", size, "kB", 300)
    with served(browser, cell) as (page, address, started):
        say("the server answers after", started * 1000, "ms", 1000)
        counter = counting(page)
        page.goto(address)
        interactive = page.evaluate(INTERACTIVE)
        spent = busy(counter)
        say("first paint", page.evaluate(PAINTED), "ms", 300)
        say("interactive", interactive, "ms", 1000)
        say("work of the page until then", 1000 * spent["task"], "ms", 1000, parts(spent))
        time.sleep(5)  # a reader looks before the key is pressed
        say("the front after the key", page.evaluate(KEY_TO_FRONT, "all proven"), "ms", 500)
        page.locator("td[data-row='0'][data-column='0']").click()
        # the block goes where the table's first column is
        block = "\n".join(f"p{i}\t\t{i % 9 + 1}\t{i % 7 + 1}" for i in range(ROWS))
        before = busy(counter)
        say(f"a paste of {ROWS} rows", page.evaluate(PASTE, block), "ms", 300)
        spent = less(busy(counter), before)
        say("work of the page for it", 1000 * spent["task"], "ms", 300, parts(spent))
        rows = page.locator("[role=grid] tbody tr").count()
        assert rows >= ROWS, f"only {rows} rows are there"
        page.goto("about:blank")
        page.goto(address)
        again = page.evaluate(INTERACTIVE)
        say("opened again: first paint", page.evaluate(PAINTED), "ms", 300)
        say("opened again: interactive", again, "ms", 1000)


def counting(page: Any) -> Any:
    """What counts the processor time of the page's thread, which a busy machine changes little."""
    counter = page.context.new_cdp_session(page)
    counter.send("Performance.enable", {"timeDomain": "threadTicks"})
    return counter


def less(after: dict[str, float], before: dict[str, float]) -> dict[str, float]:
    return {what: after[what] - before[what] for what in after}


def parts(spent: dict[str, float], times: int = 1) -> str:
    named = ("script", "style", "layout")
    return ", ".join(f"{what} {1000 * spent[what] / times:.2f}" for what in named)


def busy(counter: Any) -> dict[str, float]:
    """Seconds of processor time that the page's thread has spent since it began."""
    told = {one["name"]: one["value"] for one in counter.send("Performance.getMetrics")["metrics"]}
    names = {
        "task": "ThreadTime",
        "script": "ScriptDuration",
        "style": "RecalcStyleDuration",
        "layout": "LayoutDuration",
    }
    return {what: told[name] for what, name in names.items()}


def dragged(browser: Any, work: Path, count: int) -> None:
    """From each move of the pointer to its picture."""
    path = work / f"cell-{count}.json"
    path.write_text(json.dumps(cell_of(count)))
    with served(browser, path) as (page, address, _):
        page.goto(address)
        page.get_by_label("Search for [s]").fill("5")
        page.get_by_role("button", name="Plan", exact=True).click()
        page.locator("[role=option][aria-selected=true]").wait_for()
        page.get_by_role("button", name="Plan", exact=True).wait_for()
        bar = page.locator("button.bar").first.bounding_box()
        x, y = bar["x"] + bar["width"] / 2, bar["y"] + bar["height"] / 2
        page.evaluate(LISTEN)
        page.mouse.move(x, y)
        page.mouse.down()
        counter = counting(page)
        before = busy(counter)
        for step in range(MOVES):
            page.mouse.move(x + 6 + step * 4, y + (step % 20) * 3)
        after = busy(counter)
        page.keyboard.press("Escape")
        page.mouse.up()
        found: list[float] = sorted(page.evaluate("delays"))
    p95, median = statistics.quantiles(found, n=20)[-1], statistics.median(found)
    aim = PICTURE_MS.get(count, 33)
    spent = less(after, before)
    more = parts(spent, MOVES)
    say(f"work of the page a move, {count} bars", 1000 * spent["task"] / MOVES, "ms", aim, more)
    say(f"pointer to picture, {count} bars, p95", p95, "ms", aim, f"median {median:.1f} ms")


def main(counts: list[int]) -> None:
    with sync_playwright() as api, tempfile.TemporaryDirectory() as work:
        browser = api.chromium.launch(executable_path=shutil.which("chromium"), args=OPTIONS)
        first_look(browser, Path(work))
        for count in counts:
            dragged(browser, Path(work), count)
        browser.close()


if __name__ == "__main__":
    main([int(text) for text in sys.argv[1:]] or [200, 1000])
