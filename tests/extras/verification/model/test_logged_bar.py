"""Bottom of a groove at which the tool turns back between two samples."""

import numpy as np
import pytest

from extras.verification.model.deviation import SurfacePlaces
from extras.verification.model.logged_bar import LoggedBar
from extras.verification.model.path import ProgrammedRun, programmed_path
from extras.verification.model.turned_part import turned_part, turned_places
from simulator.motion.segments import Floats, lines
from simulator.removal.cutter import Insert
from stepnc_model.programs.program import Stock
from tests.extras.verification.model.block import sampled, samples_at

BAR = Stock(low=(-20.0, -20.0, -50.0), high=(20.0, 20.0, 0.0), radius=20.0)
BLADE = Insert(width=3.0)
BOTTOM = 12.5


def way(bottom: float) -> tuple[tuple[float, float, float], ...]:
    return ((22.0437, 0.0, -28.0), (bottom, 0.0, -28.0), (22.0437, 0.0, -28.0))


def bottom_of(points: Floats) -> SurfacePlaces:
    """Places in the middle of the groove, as a log of it shows them."""
    run = ProgrammedRun(
        cutter=BLADE, tool=1, workingstep=0,
        segments=lines([list(each) for each in way(BOTTOM)], speed=5.0),
    )  # fmt: skip
    part = turned_part(programmed_path([run]), BAR)
    left = LoggedBar(part.bar, BAR, {1: BLADE})
    left.add(samples_at(points))
    places = turned_places(part, left)
    return places[~places.is_wall & (np.abs(places.position[:, 2] + 26.5) < 1.0)]


def test_an_excess_at_the_bottom_is_known_to_the_way_between_samples() -> None:
    # The last sample lies 1.3937 mm before the bottom, the next one 0.2063 mm behind it.
    places = bottom_of(sampled(way(BOTTOM + 0.15), 1.6))
    assert places.deviation == pytest.approx(0.15 + 0.2063)
    # Of the way of 1.6 mm, 1.1874 mm lie between the samples. Positions have four decimals; a
    # micrometre is the method's.
    assert places.uncertainty == pytest.approx(0.2063 + 1e-3, abs=1e-4)
    assert places.is_beyond.all()
    assert not bottom_of(sampled(way(BOTTOM), 1.6)).is_beyond.any()


def test_a_tool_that_leaves_faster_may_have_been_anywhere() -> None:
    slow = sampled(way(BOTTOM + 0.15), 1.6)
    turn = int(slow[:, 0].argmin())
    assert not bottom_of(
        np.concatenate([slow[: turn + 1], slow[turn + 1 :: 2]])
    ).is_beyond.any()
