"""What a decider at the faces of the event world sees: everything that can be seen, and nothing of
what is still to come.
"""

from __future__ import annotations

from tandem.world.arrays import Array, Arrays, namespace
from tandem.world.episode import expected_ends
from tandem.world.state import State, mounted, to_undo

MOST = 100.0
"""Times are cut off here, in units of the mean duration of a way, so that observations have
bounds.
"""


def observe(
    arrays: Arrays, state: State, mask: Array, operator: Array, *, unit: Array | None = None
) -> Array:
    """`[8 T + 6 O + W + 1]` float32 in 0..`MOST`, as the operator (`[]` int) sees it whose choice
    it is.

    Per task: open, in hand, done, to be taken apart, being taken apart, done by a human; the time
    since it began and the time that is left of it by the stated durations, 0 unless it is in hand.
    Per operator: whose choice it is, at work, away, has let its turn pass, its stress so far by the
    largest of a task, and what its work took so far by what it was to take (1 before anything was
    done). Per way: may begin now (`mask` `[W]`). Last the clock. Times in units of the mean
    duration of a way (`unit` `[]`, ticks, where some of the ways are not there).
    """
    xp = namespace(state.way)
    unit = xp.mean(arrays.way_ticks) if unit is None else unit
    up, begun = mounted(state), state.way >= 0
    running = begun & ~up
    none = xp.zeros_like(begun)
    # without mistakes these arrays have length 0; the observation keeps its size all the same
    off, undoing = (to_undo(arrays, state), state.undoing) if arrays.undo.shape[0] else (none, none)
    in_use = xp.arange(arrays.way_ticks.shape[0])[:, None] == state.way[None, :]
    by_human = (in_use & (arrays.way_uses & arrays.human[None, :]).any(axis=1)[:, None]).any(axis=0)
    # stated times only: the real ones would tell the agent what chance has in store
    since = xp.where(running, xp.maximum(state.clock - state.start_at, 0), 0) / unit
    left = xp.where(running, expected_ends(arrays, state) - state.clock, 0) / unit
    # an operator's pace shows only in tasks that have ended, real against stated time
    team = (in_use[:, :, None] & arrays.way_uses[:, None, :]).any(axis=0) & up[:, None]
    took = xp.where(team, xp.where(up, state.end_at - state.start_at, 0)[:, None], 0).sum(axis=0)
    stated = xp.where(
        team, xp.where(in_use, arrays.way_ticks[:, None], 0).sum(axis=0)[:, None], 0
    ).sum(axis=0)
    hardest = xp.maximum(1, arrays.way_load.max())
    parts = [
        ~begun,
        running & ~undoing,
        up & ~off,
        off,
        undoing,
        by_human,
        since,
        left,
        xp.arange(arrays.human.shape[0]) == operator,
        state.free_at > state.clock,
        state.away_until > state.clock,
        state.waits,
        state.load / hardest,
        xp.where(stated > 0, took / xp.maximum(stated, 1), 1.0),
        mask,
        xp.reshape(state.clock / unit, (1,)),
    ]
    return xp.minimum(xp.concatenate([part.astype(xp.float32) for part in parts]), MOST)
