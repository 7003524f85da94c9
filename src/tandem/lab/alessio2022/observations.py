"""What agents see of a grid: four channels, each as large as the grid, one after the other as a
vector.
"""

from __future__ import annotations

from tandem.lab.alessio2022.world import (
    HUMAN,
    NOWHERE,
    REACHED_RIGHT,
    REACHED_WRONG,
    ROBOT,
    Array,
    Grid,
    State,
    namespace,
)

CHANNELS = ("obstacles", "path of the robot", "path of the human", "terminal reached")


def observe(grid: Grid, state: State, marks: Array = 0.0) -> Array:
    """`[4 S]` float32, as Alessio et al. (2022) describe it: obstacles, path of the robot, path of
    the human, terminal reached.

    How the channels are filled is ASSUMPTION: 1 at an obstacle; 1 on the agent's square and 0.5
    where it has been; 1 at a right terminal state that was reached, -1 at a wrong one.

    Args:
      marks: what right terminal states show before they are reached, and wrong ones less: with 0,
        as published, nobody sees where they lie (with one layout that is learned).
    """
    xp = namespace(grid.kind)
    squares = xp.arange(grid.kind.shape[0])
    paths = [
        0.5 * state.path[agent] + 0.5 * (squares == state.position[agent])
        for agent in (ROBOT, HUMAN)
    ]
    reached = xp.any(squares[None, :] == state.position[:, None], axis=0) & (
        state.reached != NOWHERE
    )
    sign = 1.0 * (grid.kind == REACHED_RIGHT) - 1.0 * (grid.kind == REACHED_WRONG)
    return xp.concatenate(
        [grid.obstacle * 1.0, *paths, sign * xp.where(reached, 1.0, marks)]
    ).astype(xp.float32)


OBSERVATIONS = {"published": 0.0, "marked": 0.5}
"""Name -> the `marks` of what is seen; "marked" is ours."""
