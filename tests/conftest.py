"""What every test shares."""

from __future__ import annotations

import gc
import os
import shutil
import sys
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from hypothesis.database import DirectoryBasedExampleDatabase

from tandem.cli.compiled import keep_compiled

if "PYTEST_XDIST_WORKER" not in os.environ and "JAX_COMPILATION_CACHE_DIR" not in os.environ:
    # What one test, worker, command or earlier run has compiled the others need not: JAX and every
    # command read these variables. Compiling is three quarters of the time of a small training.
    compiled = Path(__file__).resolve().parents[1] / ".pytest_cache" / "compiled"
    os.environ["JAX_COMPILATION_CACHE_DIR"] = str(compiled)
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.1")
    keep_compiled()

# What is compiled for a test runs for milliseconds: most optimisations would cost more than they
# bring, and change nothing but speed.
os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")
# XLA's older way to write loops takes a third of the time to compile, and one thread, not many.
os.environ.setdefault(
    "XLA_FLAGS",
    "--xla_cpu_use_fusion_emitters=false --xla_cpu_parallel_codegen_split_count=1",
)

pytest_plugins = ["tests.changed", "tests.longest_first"]

# No deadline: a busy machine is no fault of the code. The suite draws the same in every run, so
# that more draws would only repeat; `dev.py fuzz properties` draws anew, and more.
settings.register_profile("tandem", deadline=None, derandomize=True, max_examples=40)
# Hypothesis itself draws the same, and keeps nothing, where it sees a CI.
settings.register_profile(
    "anew",
    deadline=None,
    derandomize=False,
    print_blob=True,
    database=DirectoryBasedExampleDatabase(".hypothesis/examples"),
)
settings.load_profile(os.environ.get("TANDEM_DRAWS", "tandem"))


@pytest.hookimpl(wrapper=True)
def pytest_collection(session: pytest.Session) -> Generator[None, object, object]:
    """Eight thousand tests and the libraries are half a million objects that stay. They are set
    aside: a full collection of garbage, which every shift begins with, costs a third of a second
    with them and a few milliseconds without.
    """
    gc.disable()
    found = yield
    gc.enable()
    _set_aside()
    return found


def _set_aside() -> None:
    gc.unfreeze()
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True, scope="module")
def _room_for_what_the_next_module_compiles() -> Iterator[None]:
    """A run in one process compiles more than the memory maps of a process hold; what follows is a
    segmentation fault.
    """
    yield
    if "jax" in sys.modules:
        from tandem.learn.room import make_room

        if make_room():  # what was compiled may refer to itself, and would stay while it is aside
            _set_aside()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    return _no_excuse((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    return _no_excuse((yield))


def _no_excuse(report: Any) -> Any:
    """Where TANDEM_CI is set, all that `apt-get install` can bring is there: what is skipped for
    want of it has failed.
    """
    if os.environ.get("TANDEM_CI") and report.skipped and "apt-get install" in str(report.longrepr):
        report.outcome = "failed"
    return report


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that all workers of this run see; see `tests/learn/short_runs.py`."""
    own = tmp_path_factory.getbasetemp()
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own


# The last ones keep Chromium from trying the outside network on its own.
CHROMIUM_OPTIONS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="session")
def browser() -> Generator[Any, None, None]:
    """A real Chromium, one for all tests of a process: Playwright starts only once in it."""
    program = os.environ.get("CHROMIUM") or next(
        filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
    )
    if not program:
        pytest.skip("no browser: apt-get install chromium")
    api = pytest.importorskip(
        "playwright.sync_api",
        reason="no browser control: pip install playwright (and apt-get install chromium)",
    )
    with api.sync_playwright() as running:
        chromium = running.chromium.launch(
            executable_path=program, headless=True, args=CHROMIUM_OPTIONS
        )
        yield chromium
        chromium.close()
