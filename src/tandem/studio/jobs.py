"""What takes long, as functions: a request as JSON in, a document as JSON out. They run in a
process of their own (`worker.py`), so that the page never waits for them.
"""

from __future__ import annotations

import base64
import time
from collections.abc import Callable
from typing import Any

from tandem.errors import UsageError
from tandem.plan.method import Progress
from tandem.studio.asked import (
    EFFORT,
    NAMES,
    NUMBER,
    PAIR,
    TEXT,
    cell_in,
    read,
)

Json = dict[str, Any]
Tell = Callable[[Json], None]
"""Takes what is known while a job goes on."""

OPTIONS = {
    **EFFORT,
    "method": TEXT,
    "minimize": TEXT,
    "weights": PAIR,
    "max_stress": NUMBER,
    "max_makespan": NUMBER,
    "set": NAMES,
    "without": NAMES,
    "force": NAMES,
}
"""The options of `tandem plan`, as keys of `options`."""
EVERY_S = 0.1
"""Progress is told no more often."""


def plan(request: Json, tell: Tell) -> Json:
    """`{"cell", "options"}` -> the document of `tandem plan --json`."""
    from tandem.explain.variant import variant
    from tandem.plan.methods import METHODS
    from tandem.plan.methods import plan as plan_cell

    asked = read(request.get("options") or {}, OPTIONS)
    method = asked.pop("method", "exact")
    if method not in list(METHODS):  # one by its dotted name would be imported, and so run
        raise UsageError(f"there is no method {method!r}. There are {', '.join(METHODS)}.")
    if "minimize" in asked and "weights" in asked:
        raise UsageError("minimize and weights exclude each other: give one of them.")
    if "weights" in asked:
        asked["minimize"], asked["weights"] = "weighted", tuple(asked["weights"])
    cell = cell_in(request["cell"])
    changes = [asked.pop(key, ()) for key in ("set", "without", "force")]
    if any(changes):
        cell = variant(cell, *changes)
    told = _Telling(tell)
    return plan_cell(cell, method=method, on_solution=told, **asked).to_dict()


class _Telling:
    """Hands on what a method knows, at most every `EVERY_S` seconds."""

    def __init__(self, tell: Tell):
        self.tell, self.next = tell, 0.0

    def __call__(self, progress: Progress) -> None:
        now = time.monotonic()
        if now < self.next:
            return
        self.tell(
            {
                "front": [result.to_dict() for result in progress.found],
                "open": progress.open_area,
                "bound": progress.bound,
                "wall_s": round(progress.wall_s, 4),
            }
        )
        # a large front takes a while to tell; no more than a tenth of the time goes into that
        self.next = now + max(EVERY_S, 10 * (time.monotonic() - now))


JOBS: dict[str, Callable[[Json, Tell], Json]] = {"plan": plan}
"""Name -> job. A new one is a line here."""


def as_bytes(document: Json) -> bytes:
    """The content of a document that holds a file."""
    return base64.b64decode(document["content"])
