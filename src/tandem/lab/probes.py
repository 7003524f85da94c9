"""What each published system can do, found out by letting it try: small cells, each with one
feature, and what happened with them.

An entry of the matrix is a value and how it was found. The probes know a system by its handles only
(`systems.Features`); that a system cannot do a thing shows as a refusal in its own words, as a cost
that does not move, or as an episode in which the thing did not happen.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.files.validate import cell_of
from tandem.lab.systems import Document, Experiment, Features, Played

SEED = 0


class Entry(NamedTuple):
    """One entry: what stands in the table, and what the probe saw."""

    value: str
    how: str


NO = "no"
Probe = Callable[[Experiment, Document | None], Entry]


def base(**changes: Any) -> Cell:
    """Two tasks that both operators can share, and one on top of them; every time is the same for
    both, so that any system can hold it.
    """
    tasks: dict[str, Any] = {
        "left": {"time": {"robot": 4}},
        "right": {"time": {"human": 4}},
        "top": {"time": {"robot": 3, "human": 3}, "after": ["left", "right"]},
    }
    for name, more in changes.items():
        tasks[name] = {**tasks[name], **more}
    return cell_of(
        {"operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}}, "tasks": tasks}
    )


def tooled(changeover: float) -> Cell:
    """The base, one task of it with a tool that the robot must take up first."""
    data = base(left={"tool": "gripper"}, top={"tool": "driver", "time": {"robot": 3}}).to_dict()
    return cell_of(
        {
            **data,
            "tools": {
                "driver": {"changeover": {"robot": changeover}},
                "gripper": {"changeover": {"robot": changeover}},
            },
        }
    )


def joint() -> Cell:
    """The base, with a task on top that both must do together."""
    return base(top={"time": {}, "together": [{"operators": ["robot", "human"], "time": 3}]})


def other() -> Cell:
    """The base with other times: a cell that the policy has not seen."""
    return base(
        left={"time": {"robot": 7}},
        right={"time": {"human": 2}},
        top={"time": {"robot": 5, "human": 5}},
    )


def larger() -> Cell:
    """The base and one more task on top: a cell of another size."""
    data = base().to_dict()
    return cell_of(
        {
            **data,
            "tasks": {**data["tasks"], "lid": {"time": {"robot": 2, "human": 2}, "after": ["top"]}},
        }
    )


def in_a_row() -> Cell:
    """The base, its first two tasks one after the other."""
    return base(right={"after": ["left"]})


IN_A_ROW = 11.0
"""Seconds that the base takes when one task is done at a time."""


# --- The probes, in the order of the table ---


def objectives(system: Experiment, document: Document | None) -> Entry:
    """Which of time, stress and difficulty move what the system says that a cell costs."""
    cost = system.FEATURES.cost
    plain = cost(base())
    costly = {
        "time": base(left={"time": {"robot": 9}}),
        # on what only the human can do: nobody can be spared it
        "stress": base(right={"stress": 8}),
        "difficulty": base(
            left={"difficulty": {"robot": 8}},
            right={"difficulty": {"human": 8}},
            top={"difficulty": {"robot": 8, "human": 8}},
        ),
    }
    moved, seen = [], [f"a cell costs {plain:.4g}"]
    for name, cell in costly.items():
        try:
            found = cost(cell)
        except CellError as error:
            seen.append(f"{name} is refused ({first(error)})")
            continue
        seen.append(f"with more {name} {found:.4g}")
        moved += [name] * (abs(found - plain) > 1e-6)
    return Entry(", ".join(moved) or "none", "; ".join(seen))


def agents(system: Experiment, document: Document | None) -> Entry:
    """Who decides in what is trained."""
    names = list(system.FEATURES.agents())
    return Entry(f"{len(names)}: {', '.join(names)}", "read off what is trained")


def algorithm(system: Experiment, document: Document | None) -> Entry:
    """The module of the function that trains."""
    trains = system.FEATURES.trains()
    parts = trains.__module__.split(".")
    called = next((ALGORITHMS[part] for part in reversed(parts) if part in ALGORITHMS), parts[-1])
    return Entry(called, f"trained by {trains.__module__}.{trains.__qualname__}")


ALGORITHMS = {
    "ppo": "PPO",
    "adversarial": "adversarial PPO",
    "qlearning": "tabular Q-learning",
    "board_training": "tree search and network (AlphaZero)",
    "ddpg": "DDPG, shared critic",
    "dqn": "DQN",
}
"""Module or package -> what it is called."""


def together(system: Experiment, document: Document | None) -> Entry:
    """Cooperation: two tasks end sooner side by side than in a row. Collaboration: a task that both
    do at once is taken.

    A system that counts on nobody may still work side by side: where the cost says nothing, an
    episode is timed.
    """
    cost, kinds, seen = system.FEATURES.cost, [], []
    apart, row = cost(base()), cost(in_a_row())
    seen.append(f"two tasks cost {apart:.4g} side by side, {row:.4g} in a row")
    if apart < row - 1e-6:
        kinds.append("cooperation")
    else:
        took = system.FEATURES.play(base(), SEED).makespan
        seen.append(
            "an episode was not finished"
            if took is None
            else f"an episode of {IN_A_ROW:g} s of work took {took:.4g}"
        )
        kinds += ["cooperation"] * (took is not None and took < IN_A_ROW)
    try:
        seen.append(f"a joint task is taken ({cost(joint()):.4g})")
        kinds.append("collaboration")
    except CellError as error:
        seen.append(f"a joint task is refused ({first(error)})")
    return Entry(" and ".join(kinds) or NO, "; ".join(seen))


def disassembly(system: Experiment, document: Document | None) -> Entry:
    """A human mounts something wrongly: is it taken apart again, and the product finished?"""
    return _episode(
        system.FEATURES.mistake,
        lambda played: played.undone,
        "finished; times that something was taken apart: {n}",
        "nothing was taken apart",
    )


def tools(system: Experiment, document: Document | None) -> Entry:
    """A cell with a tool: refused, taken without minding the changeover, or minded."""
    try:
        system.runs_on(tooled(5.0))
        quick, slow = system.FEATURES.cost(tooled(1.0)), system.FEATURES.cost(tooled(5.0))
    except CellError as error:
        return Entry(NO, f"refused: {first(error)}")
    seen = f"a changeover of 1 s costs {quick:.4g}, one of 5 s {slow:.4g}"
    return Entry("yes" if slow > quick + 1e-6 else "not minded", seen)


def deviation(system: Experiment, document: Document | None) -> Entry:
    """A human does not do what is expected: is the product finished all the same?"""
    return _episode(
        system.FEATURES.deviate,
        lambda played: played.deviations,
        "finished; times that the human deviated: {n}",
        "the human did not deviate",
    )


def real_time(system: Experiment, document: Document | None) -> Entry:
    """How long a decision takes: the median over an episode, on this machine."""
    times = system.FEATURES.play(base(), SEED).decisions_ms
    if not times:
        return Entry(NO, "no decision was timed")
    median, longest = statistics.median(times), max(times)
    return Entry(
        f"{'yes' if median < 1000 else 'no'}: {median:.2g} ms",
        f"{len(times)} decisions, the longest {longest:.3g} ms",
    )


def generalises(system: Experiment, document: Document | None) -> Entry:
    """Cells that the policy was not trained on, one of the same size and one larger: does it finish
    them?
    """
    carry = system.FEATURES.carry
    if carry is None:
        return Entry(NO, "what it learns is bound to the cell that it learned on")
    seen, finished = [], []
    for size, cell in (("of the same size", other()), ("larger", larger())):
        try:
            took = carry(base(), cell, SEED).makespan
            seen.append(
                f"a cell {size} is "
                + ("not finished" if took is None else f"finished in {took:.4g}")
            )
            finished += [size] * (took is not None)
        except CellError as error:
            seen.append(f"a cell {size} is refused: {first(error)}")
        except UsageError as error:
            seen.append(f"a cell {size} is refused: {error}")
    values = {(): NO, ("of the same size",): "same size only", ("larger",): "larger only"}
    return Entry(values.get(tuple(finished), "yes"), "; ".join(seen))


def exact_known(system: Experiment, document: Document | None) -> Entry:
    """Whether the result holds proven values beside the learned ones."""
    if document is None:
        return Entry("not run", "there is no result yet")
    values = list(system.FEATURES.exact(document)) if system.FEATURES.exact else []
    return Entry("yes" if values else NO, f"{len(values)} proven values in the result")


PROBES: dict[str, Probe] = {
    "objectives": objectives,
    "agents": agents,
    "algorithm": algorithm,
    "cooperation or collaboration": together,
    "disassembly": disassembly,
    "tools": tools,
    "human deviation": deviation,
    "real time": real_time,
    "generalises": generalises,
    "exact optimum known": exact_known,
}
"""The matrix: one line a feature."""


def features(system: Experiment, document: Document | None) -> dict[str, Entry]:
    """Every feature of one system, by name."""
    return {name: probe(system, document) for name, probe in PROBES.items()}


def other_cells(system: Experiment, cells: Mapping[str, Cell]) -> dict[str, Entry]:
    """Whether the system can express cells that are not its own: taken, or refused with the
    features that it cannot.
    """
    found = {}
    for name, cell in cells.items():
        try:
            system.runs_on(cell)
            found[name] = Entry("yes", "")
        except CellError as error:
            found[name] = Entry(
                NO, _told(list(dict.fromkeys(fault.message for fault in error.faults)))
            )
    return found


def _told(messages: list[str]) -> str:
    """All of a few complaints, the first of many."""
    rest = len(messages) - MOST_TOLD
    return " ".join([*messages[:MOST_TOLD], *([f"(and {rest} more)"] if rest > 0 else [])])


MOST_TOLD = 3


def first(error: CellError) -> str:
    """The first complaint, without its place."""
    return error.faults[0].message.rstrip(".")


def _episode(
    handle: Callable[[Cell, int], Played] | None,
    count: Callable[[Played], int],
    happened: str,
    did_not: str,
) -> Entry:
    if handle is None:
        return Entry(NO, "it has no such person or event")
    try:
        played = handle(base(), SEED)
    except CellError as error:
        return Entry(NO, f"refused: {first(error)}")
    if played.makespan is None:
        return Entry(NO, "the product was not finished")
    return Entry("yes", happened.format(n=count(played))) if count(played) else Entry(NO, did_not)


__all__ = ["NO", "PROBES", "Entry", "Features", "features", "other_cells"]
