"""The studio as a new user gets it: the wheel in an empty environment, no Node, a page that plans.

    python benchmarks/studio_wheel.py

Builds the wheel, makes a virtual environment, installs `tandem[studio]` from that wheel and the
registry, opens the page of the thesis's cell in Chromium and plans. Prints what was installed, how
long each step took, and the front; ends with 1 when anything is missing or the page failed.
Needs Chromium (`apt-get install chromium`), `pip install playwright hatchling`, and a registry.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[1]
OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
PATIENCE_MS = 120_000


def bare(environment: Path) -> dict[str, str]:
    """Variables of a shell in which there is this environment and nothing of ours, and no Node."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if name in ("HOME", "LANG", "TMPDIR") or name.startswith(("PIP_", "SSL_", "HTTP", "http"))
    }
    kept["PATH"] = str(environment / "bin")
    return kept


def told(what: str, begun: float, more: str = "") -> None:
    print(f"{what:40} {time.monotonic() - begun:6.1f} s  {more}".rstrip(), flush=True)


def main() -> int:
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        begun = time.monotonic()
        subprocess.run(
            [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
            cwd=ROOT,
            check=True,
            capture_output=True,
        )
        (wheel,) = folder.glob("*.whl")
        told("the wheel", begun, f"{wheel.stat().st_size / 1e6:.1f} MB")

        begun = time.monotonic()
        environment = folder / "venv"
        subprocess.run([sys.executable, "-m", "venv", str(environment)], check=True)
        python, variables = environment / "bin/python", bare(environment)
        subprocess.run(
            [
                *(str(python), "-m", "pip", "install", "-q"),
                *("-c", str(ROOT / "constraints.txt"), f"{wheel}[studio]"),
            ],
            check=True,
            env=variables,
            cwd=folder,
        )
        found = subprocess.run(
            [str(python), "-m", "pip", "list", "--format", "freeze"],
            check=True,
            env=variables,
            capture_output=True,
            text=True,
        ).stdout.splitlines()
        told("an environment with tandem[studio]", begun, f"{len(found)} packages")
        without_node = shutil.which("node", path=variables["PATH"]) is None
        return 0 if _page(folder, environment, variables) and without_node else 1


def _page(folder: Path, environment: Path, variables: dict[str, str]) -> bool:
    """Whether the page of the installed package plans the thesis's cell."""
    cell = folder / "cell.yaml"
    shutil.copy(ROOT / "examples/thesis.yaml", cell)
    begun = time.monotonic()
    server = subprocess.Popen(
        [str(environment / "bin/tandem"), "studio", str(cell), "--port", "0", "--no-browser"],
        stdout=subprocess.PIPE,
        text=True,
        env=variables,
        cwd=folder,
    )
    assert server.stdout is not None
    address = server.stdout.readline().strip()
    told("the server's line", begun)
    errors: list[str] = []
    with sync_playwright() as api:
        browser = api.chromium.launch(executable_path=shutil.which("chromium"), args=OPTIONS)
        page = browser.new_page(locale="en-US")
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: errors.append(str(error)))
        begun = time.monotonic()
        page.goto(address)
        page.get_by_role("grid").wait_for()
        told("the page", begun)
        begun = time.monotonic()
        page.get_by_role("button", name="Plan", exact=True).click()
        page.get_by_role("status").filter(has_text="all proven").wait_for()
        names = page.locator("[role=option] .numbers").all_inner_texts()
        told("the front, proven", begun, "; ".join(names))
        browser.close()
    server.send_signal(signal.SIGINT)
    ended = server.wait(60)
    print(f"the server ended with {ended}, the page's errors: {errors}", flush=True)
    return ended == 0 and not errors and len(names) == 3


if __name__ == "__main__":
    sys.exit(main())
