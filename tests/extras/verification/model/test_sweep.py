"""Distances from the area that a tool sweeps, in closed form."""

from math import hypot, sqrt

import numpy as np
import pytest

from extras.verification.model.path import rows_between
from extras.verification.model.sweep import FAR, approach, foot, renewed, sweep, targets_at
from simulator.motion.segments import Floats
from simulator.removal.cutter import Cutter, profile_of
from simulator.removal.zmap import zmap_of
from tests.extras.verification.model.block import STOCK

FLAT = profile_of(Cutter(diameter=10.0), reach=50.0)
BALL = profile_of(Cutter(diameter=10.0, corner_radius=5.0), reach=50.0)


def away(
    point: tuple[float, float, float], way: list[list[float]], profile: object = FLAT
) -> float:
    targets, _ = targets_at(np.array([point]))
    approach(targets, profile, rows_between(np.array(way)), 0)  # type: ignore[arg-type]
    return float(targets.away[0])


LEVEL = [[0.0, 0.0, -5.0], [20.0, 0.0, -5.0]]


@pytest.mark.parametrize(
    ("point", "distance"),
    [
        ((10.0, 7.0, 0.0), 2.0),
        ((10.0, 4.0, 0.0), -1.0),
        ((23.0, 4.0, 0.0), 0.0),
        ((-3.0, -6.0, 0.0), hypot(3.0, 6.0) - 5.0),
        ((10.0, 4.0, -6.0), FAR),
    ],
)
def test_distance_from_a_level_line(point: tuple[float, float, float], distance: float) -> None:
    assert away(point, LEVEL) == pytest.approx(distance, abs=1e-12)


def test_only_the_part_of_a_slope_below_a_point_reaches_it() -> None:
    down = [[0.0, 0.0, 5.0], [20.0, 0.0, -5.0]]
    # The tip is below z = 0 from x = 10 on.
    assert away((4.0, 0.0, 0.0), down) == pytest.approx(1.0)
    assert away((4.0, 0.0, 0.0), down[::-1]) == pytest.approx(1.0)


def test_a_ball_is_narrower_near_its_tip() -> None:
    assert away((10.0, 6.0, -4.0), LEVEL, BALL) == pytest.approx(6.0 - sqrt(25.0 - 16.0))


def test_the_nearest_row_is_known_and_forgotten() -> None:
    targets, _ = targets_at(np.array([[19.0, 6.0, 0.0]]))
    way = np.array([[0.0, 0.0, -5.0], [10.0, 0.0, -5.0], [20.0, 0.0, -5.0]])
    approach(targets, FLAT, rows_between(way), 7)
    assert targets.row.tolist() == [8]
    assert renewed(targets).row.tolist() == [-1]


def test_a_sweep_lowers_cells_to_the_tip() -> None:
    whole = zmap_of(STOCK, cell=0.5)
    sweep(
        whole.grid, FLAT, rows_between(np.array([[-10.0, 20.0, -4.0], [50.0, 20.0, -4.0]])), 3
    )
    assert whole.grid.heights[40, 40] == -4.0
    assert whole.grid.owner[40, 40] == 3
    assert whole.grid.heights[40, 60] == 0.0


def test_the_foot_lies_on_the_line() -> None:
    points: Floats = np.array([[5.0, 3.0, 0.0], [30.0, 3.0, 0.0]])
    rows = rows_between(np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]]))
    found = foot(np.repeat(rows, 2, axis=0), points)
    assert found.tolist() == [[5.0, 0.0], [20.0, 0.0]]
