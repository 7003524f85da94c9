"""Does a shift survive `kill -9`? Real processes, real SIGKILL, random moments; then each event and
decision is held against a shift nobody killed.

    python benchmarks/kill.py [--kills 100] [--policy longest-tail] [--tasks 40] [--seed 0]

Twice so many kills: once a simulated floor drives the shift inside the process (`--simulate`), once
the floor is outside and sends lines through a pipe, sending again, under the same id, whatever was
not answered. A life ends while the program starts, while it waits, or within milliseconds after an
event was sent. Exit code 1 when an event was lost or doubled, a decision differs, or something was
told that the journal does not hold.
"""

from __future__ import annotations

import argparse
import json
import platform
import random
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tandem import __version__
from tandem.dispatch.journal import Entry, Journal
from tandem.files.generators import layered
from tandem.files.load import dump

PEOPLE = "random:0.2+forgetful:0.1+pace:1.3"
FLOOR = ("--simulate", PEOPLE, "--cv", "0.2", "--failures", "120", "--absences", "150")
IN_STARTING = 0.1
"""Share of the kills that come before the program has said anything."""


@dataclass
class Lives:
    """What many short lives of one shift left.

    Attributes:
      entries: of the journal at the end.
      said: documents that were told completely, by all lives.
      kills: how many lives were ended; `starting` of them before they had said anything,
        `open_event` while an event was sent and not answered.
      again: events that were sent again and were known already.
    """

    entries: list[Entry] = field(default_factory=list)
    said: list[dict[str, Any]] = field(default_factory=list)
    kills: int = 0
    starting: int = 0
    open_event: int = 0
    again: int = 0


def command(cell: Path, journal: Path, policy: str, seed: int, *more: str) -> list[str]:
    """The program on a journal. The budget is so wide that a busy machine makes no decision
    late.
    """
    base = [
        sys.executable,
        "-m",
        "tandem.cli",
        "dispatch",
        str(cell),
        "--journal",
        str(journal),
        "--json",
    ]
    return [
        *base,
        *(
            []
            if journal.exists() and _begun(journal)
            else ["--policy", policy, "--seed", str(seed), "--budget", "60000"]
        ),
        *more,
    ]


def undisturbed(cell: Path, journal: Path, policy: str, seed: int) -> list[Entry]:
    """The shift that nobody kills."""
    subprocess.run(
        command(cell, journal, policy, seed, *FLOOR, *_seed(journal, seed)),
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return _entries(journal)


def killed_inside(
    cell: Path,
    journal: Path,
    policy: str,
    seed: int,
    kills: int,
    chance: random.Random,
    seconds: float,
    makespan: float,
) -> Lives:
    """The shift with its floor inside the process, killed so often; a life lasts `seconds` on
    average once it has begun.
    """
    lives = Lives()
    speed = makespan / (kills * seconds)
    while lives.kills < kills:
        with Life(
            command(
                cell, journal, policy, seed, *FLOOR, *_seed(journal, seed), "--speed", str(speed)
            )
        ) as life:
            if chance.random() < IN_STARTING:
                time.sleep(chance.uniform(0, 1.0))
                lives.starting += not life.has_said_something()
            elif life.line() is not None:
                time.sleep(chance.uniform(0, 2 * seconds))
            ended = life.killed()
            lives.said += life.said
            if ended:
                break
            lives.kills += 1
    subprocess.run(
        command(cell, journal, policy, seed, *FLOOR, *_seed(journal, seed)),
        check=True,
        stdout=subprocess.DEVNULL,
    )
    lives.entries = _entries(journal)
    return lives


def killed_outside(
    cell: Path,
    journal: Path,
    policy: str,
    seed: int,
    kills: int,
    chance: random.Random,
    events: list[str],
) -> Lives:
    """The shift with its floor outside, which sends these lines and sends again what was not
    answered; killed so often.
    """
    lives, sent = Lives(), 0
    deaths = sorted(chance.randrange(len(events)) for _ in range(kills))
    while sent < len(events):
        with Life(command(cell, journal, policy, seed), piped=True) as life:
            if deaths and deaths[0] == sent and chance.random() < IN_STARTING:
                deaths.pop(0)
                time.sleep(chance.uniform(0, 1.0))
                lives.starting += not life.has_said_something()
                life.killed()
                lives.kills += 1
                continue
            life.documents(2)
            while sent < len(events):
                life.send(events[sent])
                if deaths and deaths[0] == sent:
                    deaths.pop(0)
                    time.sleep(chance.uniform(0, 0.012))
                    lives.kills += 1
                    life.killed()
                    lives.open_event += not any(
                        document["type"] == "answer" and document.get("id") == _id(events[sent])
                        for document in life.said
                    )
                    break
                answer = life.documents(1)[0]
                lives.again += "duplicate_of" in answer
                if "duplicate_of" not in answer:
                    life.documents(1)
                sent += 1
            lives.said += life.said
    lives.entries = _entries(journal)
    return lives


def judged(reference: list[Entry], lives: Lives) -> list[str]:
    """What is wrong about the killed shift; empty when every event was kept once and every decision
    is the reference's.
    """
    wrong = []
    if [entry.number for entry in lives.entries] != list(range(len(lives.entries))):
        wrong.append("the journal's numbers have gaps.")
    then, now = (
        [entry for entry in entries if entry.number == 0 or entry.event is not None]
        for entries in (reference, lives.entries)
    )
    if [entry.event for entry in then] != [entry.event for entry in now]:
        wrong.append(f"the events are others: {len(then)} without kills, {len(now)} with them.")
    for one, other in zip(then, now, strict=False):
        if _lasting(one) != _lasting(other) or (
            one.number == other.number and one.situation != other.situation
        ):
            wrong.append(
                f"entry {other.number}: the decision or the situation is another one than number"
                f" {one.number} of the shift that nobody killed."
            )
    kept = {entry.number: entry for entry in lives.entries}
    for document in lives.said:
        entry = kept.get(document.get("number", -1))
        if document["type"] in ("answer", "decision") and (
            entry is None or document not in (entry.answer, entry.decision)
        ):
            wrong.append(f"it was told, but is not in the journal: {json.dumps(document)[:200]}")
    return wrong


class Life:
    """One process from its start until it is killed."""

    def __init__(self, program: list[str], piped: bool = False) -> None:
        stdin = subprocess.PIPE if piped else subprocess.DEVNULL
        self.process = subprocess.Popen(
            program, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        self.said: list[dict[str, Any]] = []

    def __enter__(self) -> Life:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        for pipe in filter(None, (self.process.stdin, self.process.stdout, self.process.stderr)):
            try:
                pipe.close()
            except BrokenPipeError:
                continue

    def line(self) -> dict[str, Any] | None:
        """The next document that it says; None when it ends without one."""
        assert self.process.stdout is not None
        text = self.process.stdout.readline()
        if not text.endswith(b"\n"):
            return None
        self.said.append(json.loads(text))
        return self.said[-1]

    def documents(self, count: int) -> list[dict[str, Any]]:
        """The next documents; an error of the program when it ends before."""
        made = [document for _ in range(count) if (document := self.line()) is not None]
        if len(made) < count:
            assert self.process.stderr is not None
            raise RuntimeError(f"the shift ended by itself: {self.process.stderr.read().decode()}")
        return made

    def send(self, text: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(text.encode() + b"\n")
        self.process.stdin.flush()

    def has_said_something(self) -> bool:
        assert self.process.stdout is not None
        return bool(select.select([self.process.stdout], [], [], 0)[0])

    def killed(self) -> bool:
        """Kills it and hears what was still in the pipe; True when it had ended by itself
        before.
        """
        ended = self.process.poll() is not None
        self.process.kill()
        self.process.wait()
        while self.line() is not None:
            continue
        return ended


def _seed(journal: Path, seed: int) -> list[str]:
    return ["--seed", str(seed)]


def _begun(journal: Path) -> bool:
    with Journal(journal, read_only=True) as opened:
        return not opened.is_new


def _entries(journal: Path) -> list[Entry]:
    with Journal(journal, read_only=True) as opened:
        return list(opened.entries())


def _lasting(entry: Entry) -> dict[str, Any]:
    """The decision without numbers of entries, which count lines that came twice, and without what
    is measured.
    """
    return {
        key: value
        for key, value in _without_orders(entry.decision or {})
        if key not in ("number", "latency_ms")
    }


def _without_orders(decision: Any) -> Iterator[tuple[str, Any]]:
    for key, value in decision.items():
        yield (
            key,
            (
                [{k: v for k, v in row.items() if k != "order"} for row in value]
                if key in ("starts", "revoked")
                else value
            ),
        )


def _id(text: str) -> str:
    return str(json.loads(text)["id"])


def replayed(cell: Path, journal: Path) -> bool:
    """Whether the program itself finds the same decisions when it replays the journal."""
    return (
        subprocess.run(
            command(cell, journal, "", 0, "--replay"), stdout=subprocess.DEVNULL
        ).returncode
        == 0
    )


def run(
    kills: int, policy: str, tasks: int, seed: int, seconds: float, folder: Path
) -> dict[str, Any]:
    """Both ways of killing; the document that is printed."""
    cell, chance = folder / "cell.yaml", random.Random(seed)
    dump(layered(tasks, seed=seed), cell)
    reference = undisturbed(cell, folder / "reference.db", policy, seed)
    lines = [entry.line for entry in reference if entry.event is not None]
    rows = []
    for floor in ("inside", "outside"):
        journal = folder / f"{floor}.db"
        if floor == "inside":
            lives = killed_inside(
                cell, journal, policy, seed, kills, chance, seconds, json.loads(lines[-1])["at"]
            )
        else:
            lives = killed_outside(cell, journal, policy, seed, kills, chance, lines)
        wrong = judged(reference, lives)
        rows.append(
            {
                "floor": floor,
                "kills": lives.kills,
                "while_starting": lives.starting,
                "with_an_unanswered_event": lives.open_event,
                "sent_again_and_known": lives.again,
                "events": sum(entry.event is not None for entry in lives.entries),
                "events_without_kills": len(lines),
                "documents_told": len(lives.said),
                "replay_is_the_same": replayed(cell, journal),
                "wrong": wrong[:20],
            }
        )
    return {
        "benchmark": "kill",
        "tandem": __version__,
        "python": platform.python_version(),
        "policy": policy,
        "tasks": tasks,
        "seed": seed,
        "rows": rows,
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=100, help="for each of the two floors")
    parser.add_argument("--policy", default="longest-tail")
    parser.add_argument("--tasks", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--seconds",
        type=float,
        default=0.15,
        help="that a life lasts on average, once it has begun",
    )
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        document = run(
            asked.kills, asked.policy, asked.tasks, asked.seed, asked.seconds, Path(folder)
        )
    print(json.dumps(document, indent=1))
    sys.exit(any(row["wrong"] or not row["replay_is_the_same"] for row in document["rows"]))


if __name__ == "__main__":
    main()
