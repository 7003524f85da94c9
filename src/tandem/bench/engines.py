"""Who does the jobs: this process, several, or Ray's. What comes out is the same, in the order in
which it gets done.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

from tandem.bench.jobs import Job
from tandem.bench.outcome import Answer, Failure, answered
from tandem.cell.model import Cell
from tandem.errors import TandemError, UsageError

Cells = Mapping[str, Cell]
"""Digest -> cell."""
Engine = Callable[[Sequence[Job], Cells, int], Iterator[Answer | Failure]]
"""Jobs, their cells, and how many are done side by side."""


def in_processes(todo: Sequence[Job], cells: Cells, jobs: int) -> Iterator[Answer | Failure]:
    """By so many processes of this machine; with one, in this process."""
    if jobs == 1:
        with _discarded_when_stopped() as stopped:
            for job in todo:
                done = answered(job, cells[job.cell])
                if stopped():  # a method may answer with what it had: that is no result
                    raise KeyboardInterrupt
                yield done
        return
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from concurrent.futures.process import BrokenProcessPool

    # not forked: JAX has threads, which do not survive that
    context = get_context("spawn")
    held, alive = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(jobs, context, _ends_with, (held,))
    try:
        with _workers_hear_no_interrupt():
            futures = [pool.submit(answered, job, cells[job.cell]) for job in todo]
        for future in as_completed(futures):
            yield future.result()
    except BrokenProcessPool as error:
        raise TandemError(
            "a process that did jobs was ended from outside, perhaps for want of memory. What is"
            " done is kept; go on with the same command, and a smaller --jobs."
        ) from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        alive.close()


def _ends_with(held: Connection) -> None:
    """Ends this process as soon as nobody holds the other end: the command was stopped or killed,
    and what is still in hand is not wanted any more.
    """

    def watch() -> None:
        try:
            held.recv()
        except (EOFError, OSError):
            os._exit(0)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _workers_hear_no_interrupt() -> Iterator[None]:
    """Processes that are begun in here leave Ctrl-C to this one, which ends them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def _discarded_when_stopped() -> Iterator[Callable[[], bool]]:
    """Says whether Ctrl-C was pressed in here, whoever caught it."""
    pressed = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield pressed.is_set
        return

    def press(*_: Any) -> None:
        pressed.set()
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, press)
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)


def on_ray(todo: Sequence[Job], cells: Cells, jobs: int) -> Iterator[Answer | Failure]:
    """By Ray: on the cluster that RAY_ADDRESS names, else on one of this machine with room for so
    many jobs. Raises UsageError where Ray is not installed.
    """
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray
    except ImportError as error:
        raise UsageError(
            "--engine ray needs Ray, which is not installed. Get it with: pip install 'tandem[ray]'"
        ) from error
    begun = not ray.is_initialized()
    if begun:
        room = {} if os.environ.get("RAY_ADDRESS") else {"num_cpus": jobs}
        ray.init(include_dashboard=False, log_to_driver=False, logging_level="error", **room)
    try:
        remote = ray.remote(num_cpus=1)(answered)
        there = {digest: ray.put(cell) for digest, cell in cells.items()}
        pending = [remote.remote(job, there[job.cell]) for job in todo]
        while pending:
            done, pending = ray.wait(pending, num_returns=1)
            yield ray.get(done[0])
    finally:
        if begun:
            ray.shutdown()


ENGINES: Mapping[str, Engine] = {"processes": in_processes, "ray": on_ray}
"""Name -> engine."""
