"""The process that searches: a job a line on stdin, what comes of it a line each on stdout.

`python -P -m tandem.studio.worker`. A line `{"id", "do", ...}` begins a job; `{"stop": id}` ends it
with what was found, as Ctrl-C does on the command line. The end of stdin ends the process.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import warnings
from queue import SimpleQueue
from types import FrameType
from typing import Any, TextIO

from tandem.errors import TandemError
from tandem.studio.failures import failure
from tandem.studio.jobs import JOBS

Json = dict[str, Any]


class Worker:
    """Does one job after the other.

    Args:
      given: where jobs come from.
      told: where answers go.
    """

    def __init__(self, given: TextIO, told: TextIO):
        self.given, self.told = given, told
        self.waiting: SimpleQueue[Json] = SimpleQueue()
        self.current: int | None = None
        self.stopped: set[int] = set()

    def work(self) -> None:
        """Until stdin ends."""
        signal.signal(signal.SIGINT, self._interrupt)
        threading.Thread(target=self._listen, daemon=True).start()
        self._tell({"event": "ready"})
        while True:
            job = self.waiting.get()
            number = int(job["id"])
            try:
                self.current = number
                event, data = self._done(job)
            except KeyboardInterrupt:
                event, data = "failed", {"error": "stopped before anything was found.", "exit": 130}
            finally:
                self.current = None
            self._tell({"id": number, "event": event, "data": data})

    def _done(self, job: Json) -> tuple[str, Json]:
        number = int(job["id"])
        if number in self.stopped:
            raise KeyboardInterrupt

        def tell(data: Json) -> None:
            self._tell({"id": number, "event": "progress", "data": data})

        try:
            return "done", JOBS[job["do"]].do(job, tell)
        except TandemError as error:
            return "failed", failure(error, job.get("cell"), job.get("lang", "en"))
        except (MemoryError, RecursionError) as error:
            return "failed", {"error": f"too large: {type(error).__name__}.", "exit": 3}
        except Exception as error:  # noqa: BLE001  whatever it is, the next job is done
            bug = f"this is a bug in Tandem, not in your input: {type(error).__name__}: {error}"
            return "failed", {"error": bug, "exit": 1}

    def _tell(self, line: Json) -> None:
        self.told.write(json.dumps(line, ensure_ascii=False, separators=(",", ":")) + "\n")
        self.told.flush()

    def _listen(self) -> None:
        for line in self.given:
            message = json.loads(line)
            if "stop" not in message:
                self.waiting.put(message)
                continue
            self.stopped.add(message["stop"])
            if self.current == message["stop"]:
                _interrupt_the_search()
        os._exit(0)  # whoever asked is gone

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self.current is not None:
            raise KeyboardInterrupt


def _interrupt_the_search() -> None:
    """As if Ctrl-C had been pressed, whatever the main thread waits for."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        signal.raise_signal(signal.SIGINT)


def _ready() -> None:
    """Loads what planning needs before anybody waits for it."""
    from tandem.cell.model import Cell
    from tandem.plan.methods import plan

    # what is compiled or loaded by a first search is there then
    two = {"1": {"time": {"a": 1, "b": 2}, "stress": 1}, "2": {"time": {"a": 2, "b": 1}}}
    who = {"a": {"kind": "human"}, "b": {"kind": "robot"}}
    cell = {"operators": who, "tasks": two}
    front = plan(Cell.model_validate(cell), time_limit=5, workers=1)
    # and by a first bar that is dragged
    dragged = {"task": "1", "operators": ["b"], "start": 0.0}
    placed = {"cell": cell, "assignments": front[0].schedule.to_list(), **dragged}
    JOBS["place"].do(placed, lambda _: None)


def main() -> None:
    """What some library prints must not get among the answers."""
    told = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    warnings.simplefilter("ignore")
    _ready()
    Worker(sys.stdin, told).work()


if __name__ == "__main__":
    main()
