"""Worker processes and who waits for them: a few searches at once, each of which can be stopped."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import subprocess
import sys
from asyncio.subprocess import Process
from collections.abc import AsyncGenerator, AsyncIterator
from typing import Any

Json = dict[str, Any]

AT_ONCE = 2
"""Searches that go on at the same time; each has as many threads as there are cores."""
MOST_WAITING = 12
"""Further ones that wait for their turn. More are refused."""
LONGEST_LINE = 2**28
"""Bytes of one answer."""
GRACE_S = 10.0
"""A search that was stopped has so long to say what it found; then its process is ended."""
ASLEEP_S = 3.0
"""Without any request that would need them, processes begin to load after so long."""
OVERTIME_S = 120.0
"""A job may take so much longer than its time limit."""


class BusyError(Exception):
    """More is asked for than is done."""


class Failed(Exception):
    """A job that ended without a document; `told` as `failures.failure` says it."""

    def __init__(self, told: Json):
        super().__init__(told["error"])
        self.told = told


class Run:
    """A job that goes on.

    Attributes:
      number: what it is stopped by.
      is_stream: it was begun by a stream, which `stop` means when it names nothing.
    """

    def __init__(self, number: int, is_stream: bool):
        self.number, self.is_stream = number, is_stream
        self.process: _Process | None = None
        self.stopped = False

    def stop(self) -> None:
        """Asks the search to end with what it has; whoever waits for its turn does not begin."""
        if not self.stopped:
            self.stopped = True
            if self.process is not None:
                self.process.stop(self.number)


class Pool:
    """Worker processes. As many as may work at once are kept ready, so that none is waited for: a
    dragged bar asks about its lanes and about its place at the same time.
    """

    def __init__(self) -> None:
        self._free: list[_Process] = []
        self._working = 0
        self._places = asyncio.Semaphore(AT_ONCE)
        self._numbers = itertools.count(1)
        self._tasks: set[asyncio.Task[None]] = set()
        self._is_awake = False
        self.runs: dict[int, Run] = {}

    async def start(self) -> None:
        """Has the processes begin to load after a while, if nobody has asked for it before: while
        the page itself is loading, they would take its time.
        """
        self._later(self._wake_later())

    async def _wake_later(self) -> None:
        await asyncio.sleep(ASLEEP_S)
        await self.wake()

    async def wake(self) -> None:
        """Has the first process begin to load, once; does not wait for it. The others follow when
        it has loaded, so that it is there the sooner.
        """
        if self._is_awake:
            return
        self._is_awake = True
        first = await _Process.start()
        self._free.append(first)
        self._later(self._follow(first))

    async def _follow(self, first: _Process) -> None:
        await asyncio.wait([first.loaded])
        await self._replenish()

    async def close(self) -> None:
        """Ends every process."""
        for task in self._tasks:
            task.cancel()
        for run in list(self.runs.values()):
            if run.process is not None:
                run.process.kill()
        for process in self._free:
            process.kill()
        await asyncio.gather(*(process.process.wait() for process in self._free))
        self._free.clear()

    @property
    def ready(self) -> int:
        """How many processes have loaded and wait for a job."""
        return sum(process.loaded.done() for process in self._free)

    def stop(self, number: int | None = None) -> list[int]:
        """Stops the run of this number; every stream when none is given. Returns which it
        stopped.
        """
        found = [
            run
            for run in list(self.runs.values())
            if not run.stopped and (run.is_stream if number is None else run.number == number)
        ]
        for run in found:
            run.stop()
        return [run.number for run in found]

    async def document(self, do: str, request: Json) -> Json:
        """What comes of a job. Raises Failed; BusyError."""
        async with contextlib.aclosing(self.events(do, request)) as events:
            async for event, data in events:
                if event == "done":
                    return data
                if event == "failed":
                    raise Failed(data)
        raise Failed({"error": "the search ended without an answer.", "exit": 1})

    async def events(
        self, do: str, request: Json, *, is_stream: bool = False
    ) -> AsyncGenerator[tuple[str, Json]]:
        """`started`, then `progress` as it comes, then `done` or `failed`. Whoever leaves off
        stops the job. Raises BusyError.
        """
        if len(self.runs) >= AT_ONCE + MOST_WAITING:
            raise BusyError(f"{len(self.runs)} searches are asked for already; try again later.")
        run = Run(next(self._numbers), is_stream)
        self.runs[run.number] = run
        try:
            yield "started", {"run": run.number}
            # closed here, not some time later: the process is free again before its place is
            async with self._places, contextlib.aclosing(self._done(run, do, request)) as done:
                async for event in done:
                    yield event
        finally:
            del self.runs[run.number]

    async def _done(self, run: Run, do: str, request: Json) -> AsyncGenerator[tuple[str, Json]]:
        process = await self._taken()
        run.process = process
        self._working += 1
        limit = (request.get("options") or request).get("time_limit")
        limit = limit if isinstance(limit, int | float) else 60.0
        whole = False
        try:
            process.send({**request, "id": run.number, "do": do})
            if run.stopped:
                process.stop(run.number)
            async for event, data in process.answers(run, limit + OVERTIME_S):
                whole = event in ("done", "failed")
                yield event, data
        finally:
            self._working -= 1
            if whole and process.is_alive:
                self._free.append(process)
            else:
                process.kill()
                self._later(self._replenish())

    async def _taken(self) -> _Process:
        """A process that is free: rather one that has loaded."""
        if not self._free:
            return await _Process.start()
        ready = [process for process in self._free if process.loaded.done()]
        process = (ready or self._free)[0]
        self._free.remove(process)
        return process

    async def _replenish(self) -> None:
        while len(self._free) + self._working < AT_ONCE:
            self._free.append(await _Process.start())

    def _later(self, work: Any) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)


class _Process:
    """One worker process.

    Attributes:
      loaded: its first line, which it says when it has loaded what jobs need.
    """

    def __init__(self, process: Process):
        assert process.stdout is not None
        self.process = process
        self.loaded = asyncio.ensure_future(process.stdout.readline())

    @classmethod
    async def start(cls) -> _Process:
        # -P: a module that lies in the user's folder is not imported; a session of its own: Ctrl-C
        # is for the server, which then says what becomes of the search
        return cls(
            await asyncio.create_subprocess_exec(
                sys.executable,
                "-P",
                "-m",
                "tandem.studio.worker",
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                limit=LONGEST_LINE,
                start_new_session=True,
            )
        )

    @property
    def is_alive(self) -> bool:
        return self.process.returncode is None

    def send(self, line: Json) -> None:
        assert self.process.stdin is not None
        text = json.dumps(line, ensure_ascii=False, separators=(",", ":")) + "\n"
        self.process.stdin.write(text.encode())

    def stop(self, number: int) -> None:
        with contextlib.suppress(OSError):
            self.send({"stop": number})

    def kill(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            self.process.kill()

    async def answers(self, run: Run, longest: float) -> AsyncIterator[tuple[str, Json]]:
        """What the process says of a job, its last word included."""
        assert self.process.stdout is not None
        loop = asyncio.get_running_loop()
        until = loop.time() + longest
        since_stop: float | None = None
        # a job may be sent to a process that has not said yet that it has loaded
        reading: asyncio.Future[bytes] | None = None if self.loaded.done() else self.loaded
        while True:
            if run.stopped and since_stop is None:
                since_stop = loop.time()
            reading = reading or asyncio.ensure_future(self.process.stdout.readline())
            done, _ = await asyncio.wait([reading], timeout=0.25)
            if not done:
                late = since_stop is not None and loop.time() > since_stop + GRACE_S
                if late or loop.time() > until:
                    reading.cancel()
                    what = "it was stopped" if late else "its time was up"
                    yield "failed", {"error": f"the search did not end when {what}.", "exit": 130}
                    self.kill()
                    return
                continue
            line, reading = reading.result(), None
            if not line:
                # out of memory, or ended from outside
                yield "failed", {"error": "the process that searched has ended.", "exit": 1}
                return
            message = json.loads(line)
            if message.get("id") == run.number:
                yield message["event"], message["data"]
                if message["event"] in ("done", "failed"):
                    return
