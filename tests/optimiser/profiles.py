"""Problems of feed profiles on the paths of the trials."""

import numpy as np

from benchmarks.feed_paths import AXES, PATHS, wavy_caps
from optimiser.feed_profile.path_grid import PathGrid, path_grid, problem_on
from optimiser.feed_profile.profile import AxisLimit, Floats, NamedCaps, ProfileProblem


def grid_of(name: str, *, step: float = 0.5, greatest_turn: float = 0.1) -> PathGrid:
    return path_grid(PATHS[name](), step=step, greatest_turn=greatest_turn)


def stations_of(grid: PathGrid) -> Floats:
    return np.append(0.0, np.cumsum(grid.lengths))


def trial(
    name: str, *, step: float = 0.5, greatest_turn: float = 0.1
) -> tuple[ProfileProblem, AxisLimit, NamedCaps]:
    """A path with caps that vary along it."""
    grid = grid_of(name, step=step, greatest_turn=greatest_turn)
    wavy = wavy_caps(stations_of(grid))
    caps = NamedCaps(names=("wave", "top"), squares=np.stack((wavy, np.full(len(grid), 6e3))))
    return problem_on(grid, caps.least), grid.axis_limit(AXES), caps
