"""What takes long, as functions: a request as JSON in, a document as JSON out. They run in a
process of their own (`worker.py`), so that the page never waits for them.
"""

from __future__ import annotations

import base64
import datetime
import json
import mimetypes
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from tandem.cell.language import spoken
from tandem.errors import CellError, UnsoundScheduleError, UsageError
from tandem.studio.asked import (
    EFFORT,
    LANGUAGE,
    NAMES,
    NUMBER,
    PAIR,
    POINTS,
    PRECEDENCE,
    ROWS,
    TABLE,
    TEXT,
    TRUTH,
    WHOLE,
    Json,
    Kind,
    cell_in,
    one_of,
    read,
)
from tandem.studio.importing import read_in, without_path
from tandem.studio.questions import Tell, compare, graph, measures, moved, recommend, schedule_of

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.method import Progress
    from tandem.plan.result import Front

OPTIONS: dict[str, Kind] = {
    **EFFORT,
    "work": NUMBER,
    "method": TEXT,
    "minimize": one_of(("makespan", "stress", "worst-stress")),
    "weights": PAIR,
    "max_stress": NUMBER,
    "max_makespan": NUMBER,
    "cv": NUMBER,
    "robust": TRUTH,
    "risk": TRUTH,
    "set": NAMES,
    "without": NAMES,
    "force": NAMES,
}
"""The options of `tandem plan`, as keys of `options`."""
OF_A_CELL: dict[str, Kind] = {"cell": TABLE, "draft": TEXT, "file": TEXT}
"""Which cell is meant: the one given here, that of a draft, or that of a file; else the first."""
PLACE: dict[str, Kind] = {"task": TEXT, "operators": NAMES, "start": NUMBER}
"""A task, who is to do it, and from when on."""
FORMS = ("csv", "html", "json", "md", "pdf", "png", "svg", "xlsx", "xml")
"""The endings of `tandem.report.files.EXPORTERS`."""
CHARTS = ("front", "gantt", "graph")
"""What `tandem.report.files.CHARTS` draws."""
EVERY_S = 0.1
"""Progress is told no more often."""
PLANNING_S = 60.0
"""What a plan with its risk takes at most, if nothing else is said."""
EXPLAINING_S = 5.0
"""What an explanation takes at most, if nothing else is said."""


def plan(request: Json, tell: Tell) -> Json:
    """The document of `tandem plan --json`."""
    from tandem.explain.variant import variant
    from tandem.plan.methods import METHODS
    from tandem.plan.methods import plan as plan_cell

    asked = read(request.get("options", {}), OPTIONS, where="options.")
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
    risk = {key: asked.pop(key) for key in ("cv", "robust", "risk") if key in asked}
    search = partial(plan_cell, cell, method=method, on_solution=_Telling(tell))
    front = _with_risk(cell, search, asked, **risk) if any(risk.values()) else search(**asked)
    return front.to_dict()


def _with_risk(
    cell: Cell,
    search: Callable[..., Front],
    asked: Json,
    cv: float = 0.0,
    robust: bool = False,
    risk: bool = False,
) -> Front:
    """The front with what becomes of each point where times scatter, both within the time limit."""
    if not 0 <= cv <= 10:
        raise UsageError(f"options.cv is {cv:g}, but must be between 0 and 10.")
    if find_spec("jax") is None:
        raise UsageError("telling the risk of a plan needs JAX: pip install 'tandem[learn]'")
    from tandem.dispatch.evaluation.risk import check_scatter, searching, with_risk

    check_scatter(cell, cv)
    until: float | None = None
    if "work" not in asked:  # by work no clock is asked
        limit = asked.get("time_limit", PLANNING_S)
        asked, until = {**asked, "time_limit": searching(limit)}, time.monotonic() + limit
    front = search(**asked)
    if front.interrupted:
        return front
    return with_risk(front, cv=cv, robust=robust, until=until)


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


def place(request: Json, tell: Tell) -> Json:
    """What it would mean to put a task elsewhere."""
    from tandem.cell.model import plain
    from tandem.schedule.placed import place as put
    from tandem.schedule.said import in_language

    cell, language = cell_in(request["cell"]), request.get("lang", "en")
    before = schedule_of(request["assignments"])
    placed = put(cell, before, request["task"], request["operators"], request["start"])
    return {
        "allowed": placed.allowed,
        "reasons": [in_language(reason, language) for reason in placed.reasons],
        "makespan": plain(placed.makespan),
        "stress": None if placed.stress is None else plain(placed.stress),
        "faults": [in_language(fault, language) for fault in placed.faults],
        "assignments": placed.schedule.to_list(),
        "ways": [
            {
                "operators": list(way.operators),
                "time": plain(way.time),
                "stress": plain(sum(way.stress.values())),
            }
            for way in placed.ways
        ],
    }


def replan(request: Json, tell: Tell) -> Json:
    """The rest planned anew with the fewest changes, around what is kept and what was put
    elsewhere.
    """
    from tandem.plan.least_change import replan as plan_anew
    from tandem.schedule.placed import place as put

    cell = cell_in(request["cell"])
    old = before = schedule_of(request["assignments"])
    keep = list(request.get("keep", ()))
    if (where := request.get("place")) is not None:
        asked = read(where, PLACE, needed=PLACE, where="place.")
        placed = put(cell, old, asked["task"], asked["operators"], asked["start"])
        if placed.reasons:
            raise UnsoundScheduleError(placed.reasons)
        before, keep = placed.schedule, [*keep, asked["task"]]
    effort = {key: request[key] for key in EFFORT if key in request}
    found = plan_anew(
        cell,
        before,
        keep=keep,
        allow=request.get("allow", 2.0),
        tolerance=request.get("tolerance", 0.0),
        **{"time_limit": 10.0, **effort},
    )
    t = spoken(request.get("lang", "en"), "tandem.studio")
    return {
        "point": found[0].to_dict(),
        "sentence": moved(found.changes, cell, old, found[0].schedule, t),
        "complete": found.complete,
        "document": found.to_dict(),
    }


def explain(request: Json, tell: Tell) -> Json:
    """Why a schedule is so, and what every other choice would cost."""
    from tandem.explain.explanation import explain as explained
    from tandem.plan.result import Bound, Front, Result, Status
    from tandem.schedule.checker import faults

    cell = cell_in(request["cell"])
    schedule = schedule_of(request["assignments"])
    if wrong := faults(cell, schedule):
        raise UnsoundScheduleError(wrong)
    point = Result(cell, schedule, Status.FEASIBLE, Bound(0.0, 0.0))
    front = Front(cell, (point,), False, "given", "", 0, 0.0)
    effort = {key: request[key] for key in EFFORT if key in request}
    found = explained(
        cell, front=front, task=request.get("task"), **{"time_limit": EXPLAINING_S, **effort}
    )
    document = found.to_dict(request.get("lang", "en"))
    said = [sentence for task in document["tasks"] for sentence in task["sentences"]]
    floor = document["floor"]["sentences"] if document["floor"] else []
    return {"sentences": [*floor, *said], "document": document}


def report(request: Json, tell: Tell) -> Json:
    """A stored plan as a file of its kind, or one of its charts as a picture."""
    from tandem.plan.choice import point_of
    from tandem.report.files import write, write_chart
    from tandem.report.stored import read_plan

    form = request["form"]
    # the document is read as a stored one is, so that each schedule is judged; what it names as its
    # cell's file is not looked for
    document = {**request["plan"], "source": None}
    with TemporaryDirectory(prefix="tandem-") as folder:
        stored = Path(folder) / "plan.json"
        stored.write_text(json.dumps(document, ensure_ascii=False), encoding="utf-8")
        try:
            front = read_plan(stored).front
        except (CellError, UnsoundScheduleError) as error:
            raise without_path(error, str(stored)) from None
        point = request.get("point")
        if point is not None:
            point_of(front, point, None, None)
        chart, shown = request.get("chart"), {"language": request.get("lang", "en"), "point": point}
        path = Path(folder) / f"{chart or 'plan'}.{form}"
        if chart is None:
            write(front, path, date=datetime.date.today().isoformat(), **shown)
        else:
            write_chart(front, path, chart, **shown)
        content = path.read_bytes()
    kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    return {"content": base64.b64encode(content).decode(), "name": path.name, "type": kind}


@dataclass(frozen=True)
class Job:
    """A line of the table: what is done, the keys of its request besides the cell, and which of
    them it needs.

    Attributes:
      of_a_cell: a request says which cell it is about: `cell`, `draft` or `file`.
      quick: done at once, beside whatever is searched; a dragged bar waits for it.
    """

    do: Callable[[Json, Tell], Json]
    keys: Mapping[str, Kind]
    needed: tuple[str, ...] = ()
    of_a_cell: bool = True
    quick: bool = False

    @property
    def all_keys(self) -> dict[str, Kind]:
        """Those that a request may have."""
        return {**(OF_A_CELL if self.of_a_cell else {}), **self.keys}

    def asked(self, given: Any) -> Json:
        """The request, its keys and kinds checked. Raises UsageError with all that is wrong."""
        found = read(given, self.all_keys, needed=self.needed)
        if self.keys.keys() >= {"options"}:
            read(found.get("options", {}), OPTIONS, where="options.")
        if self.keys.keys() >= {"place"} and "place" in found:
            read(found["place"], PLACE, needed=PLACE, where="place.")
        return found


JOBS: dict[str, Job] = {
    "plan": Job(plan, {"options": TABLE, "lang": LANGUAGE}),
    "place": Job(
        place,
        {"assignments": ROWS, "lang": LANGUAGE, **PLACE},
        ("assignments", *PLACE),
        quick=True,
    ),
    "measures": Job(
        measures,
        {"assignments": ROWS, "before": ROWS, "lang": LANGUAGE},
        ("assignments",),
        quick=True,
    ),
    "compare": Job(
        compare,
        {"other": TABLE, "points": POINTS, "other_points": POINTS, "lang": LANGUAGE},
        ("other",),
        quick=True,
    ),
    "recommend": Job(
        recommend,
        {"points": POINTS, "share": NUMBER, "max_makespan": NUMBER, "max_stress": NUMBER},
        ("points",),
        of_a_cell=False,
        quick=True,
    ),
    "graph": Job(graph, {"after": PRECEDENCE}, ("after",), of_a_cell=False, quick=True),
    "replan": Job(
        replan,
        {
            "assignments": ROWS,
            "keep": NAMES,
            "place": TABLE,
            "allow": NUMBER,
            "tolerance": NUMBER,
            "lang": LANGUAGE,
            **EFFORT,
        },
        ("assignments",),
    ),
    "explain": Job(
        explain,
        {"assignments": ROWS, "task": TEXT, "lang": LANGUAGE, **EFFORT},
        ("assignments",),
    ),
    "report": Job(
        report,
        {
            "plan": TABLE,
            "point": WHOLE,
            "form": one_of(FORMS),
            "chart": one_of(CHARTS),
            "lang": LANGUAGE,
        },
        ("plan", "form"),
        of_a_cell=False,
    ),
    "import": Job(
        read_in,
        {
            "content": TEXT,
            "name": TEXT,
            "sheet": TEXT,
            "map": NAMES,
            "human": NAMES,
            "robot": NAMES,
            "machine": NAMES,
            "lang": LANGUAGE,
        },
        ("content", "name"),
        of_a_cell=False,
    ),
}
"""Name -> job. A new one is a line here."""
