"""Pictures of the studio's page, for the documentation and to be looked at: each view at 768 and
1280 px, light and dark, English and German.

    python benchmarks/studio_pictures.py docs/pictures/studio

Needs Chromium (`apt-get install chromium`) and `pip install playwright`.
"""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

THESIS = Path(__file__).parents[1] / "examples/thesis.yaml"
OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
LANGUAGES = {
    "en": {
        "locale": "en-US",
        "plan": "Plan",
        "bar": "task 6, human, 18 to 21 s",
        "copy": "Keep a copy",
        "all": "Plan all",
        "weight": "Between time and stress",
        "undo": "Undo",
    },
    "de": {
        "locale": "de-DE",
        "plan": "Planen",
        "bar": "Vorgang 6, human, 18 bis 21 s",
        "copy": "Kopie behalten",
        "all": "Alle planen",
        "weight": "Zwischen Zeit und Belastung",
        "undo": "Rückgängig",
    },
}


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as work, sync_playwright() as api:
        cell = Path(work) / "cell.yaml"
        shutil.copy(THESIS, cell)
        server = subprocess.Popen(
            [sys.executable, "-m", "tandem", "studio", str(cell), "--port", "0", "--no-browser"],
            stdout=subprocess.PIPE,
            text=True,
        )
        assert server.stdout is not None
        address = server.stdout.readline().strip()
        browser = api.chromium.launch(executable_path=shutil.which("chromium"), args=OPTIONS)
        for language, words in LANGUAGES.items():
            for width in (768, 1280):
                for scheme in ("light", "dark"):
                    context = browser.new_context(
                        viewport={"width": width, "height": 900},
                        locale=words["locale"],
                        color_scheme=scheme,
                    )
                    shoot(
                        context.new_page(), address, words, folder, f"{language}-{width}-{scheme}"
                    )
                    context.close()
        browser.close()
        server.send_signal(signal.SIGINT)
        server.wait(30)


def shoot(page: Any, address: str, words: dict[str, str], folder: Path, name: str) -> None:
    """The page as it opens, with the first compromise, with a bar on its way, and with its panels
    open, a slider moved and a scenario beside the cell.
    """
    page.goto(address)
    page.get_by_role("grid").wait_for()
    page.screenshot(path=folder / f"open-{name}.png", full_page=True)
    page.get_by_role("button", name=words["plan"], exact=True).click()
    option = page.get_by_role("option").first
    page.locator("[role=option][aria-selected=true] b").wait_for()
    option.click()
    bar = page.get_by_role("button", name=words["bar"])
    bar.click()
    page.screenshot(path=folder / f"plan-{name}.png", full_page=True)
    bar.press("ArrowUp")
    page.locator(".readout", has_text="→").wait_for()
    page.screenshot(path=folder / f"drag-{name}.png", full_page=True)
    bar.press("Escape")
    page.locator("td[data-row='2'][data-column='2']").click()
    page.keyboard.type("18")
    page.keyboard.press("Enter")
    page.get_by_role("button", name=words["copy"]).click()
    page.get_by_role("button", name=words["undo"], exact=True).click()
    page.get_by_role("button", name=words["all"]).click()
    page.locator(".compared").nth(1).wait_for()
    page.get_by_label(words["weight"]).press("End")
    page.locator(".ghost").first.wait_for()
    for panel in page.locator("details.panel").all():
        panel.locator("summary").click()
    page.screenshot(path=folder / f"panels-{name}.png", full_page=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
