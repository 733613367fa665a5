"""Wear of an edge while it cuts."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.machine.wear import Wear, wearing, wearing_along
from simulator.motion.segments import lines
from simulator.physics.tool_life import LIFE_CRITERION
from simulator.removal.stations import StationKind, Stations
from simulator.spec import Taylor

STEEL = Taylor(exponent=0.5, constant=400_000 / 60)
"""n 0.5, C 400 m/min: at 200 m/min an edge lives 4 min"""

SPEED = 200_000 / 60


def test_edge_is_worn_out_after_the_life_of_taylor() -> None:
    worn = wearing(0.0, STEEL, SPEED).after(240.0)
    assert worn.flank == pytest.approx(LIFE_CRITERION)


def test_an_edge_without_a_rate_stays_as_it_is() -> None:
    assert Wear().after(100.0) == Wear()
    assert not Wear(flank=0.1).grows


@given(
    flank=st.floats(0.0, 0.3),
    rate=st.floats(0.0, 0.01),
    seconds=st.lists(st.floats(0.0, 100.0), min_size=1),
)
def test_wear_at_many_times_is_that_at_each(
    flank: float, rate: float, seconds: list[float]
) -> None:
    wear = Wear(flank=flank, per_second=rate)
    wanted = [wear.after(each).flank for each in seconds]
    np.testing.assert_allclose(wear.flanks(np.array(seconds)), wanted, rtol=1e-9)


def stations(diameter: list[float], section: list[float]) -> Stations:
    count = len(diameter)
    nothing = np.zeros(count)
    return Stations(
        segment=np.arange(count),
        station=np.full(count, 10.0),
        kind=np.full(count, int(StationKind.TURNING)),
        section=np.array(section),
        growth=np.zeros(len(section)),
        axial_depth=nothing,
        radial_width=nothing,
        entry_angle=nothing,
        exit_angle=nothing,
        contact_angle=nothing,
        chip_ratio=nothing,
        diameter=np.array(diameter),
    )


PATH = lines([(10.0 * row, 0.0, 0.0) for row in range(4)], speed=5.0)


def test_constant_surface_speed_wears_as_if_the_diameter_stayed() -> None:
    diameter = np.array([100.0, 50.0, 25.0])
    found = wearing_along(
        0.1,
        STEEL,
        PATH,
        stations([100.0, 50.0, 25.0], [1.0, 1.0, 1.0]),
        spindle_speed=SPEED / (pi * diameter),
    )
    assert found.flank == 0.1
    assert found.per_second == pytest.approx(LIFE_CRITERION / 240.0)


def test_rate_is_the_mean_over_time_with_chips() -> None:
    """Rates go with v²: 2 s at the speed and 4 s at twice the speed; air does not count."""
    path = replace(PATH, speed=np.array([5.0, 2.5, 5.0]))
    cuts = stations([100.0, 200.0, 300.0], [1.0, 1.0, 0.0])
    spindle = np.full(3, SPEED / (pi * 100.0))
    found = wearing_along(0.0, STEEL, path, cuts, spindle_speed=spindle)
    mean = (2.0 * 1.0 + 4.0 * 4.0) / 6.0
    assert found.per_second == pytest.approx(mean * LIFE_CRITERION / 240.0)


@pytest.mark.parametrize("spindle", [0.0, 10.0])
def test_air_and_a_standing_spindle_wear_nothing(spindle: float) -> None:
    section = [1.0] * 3 if spindle == 0.0 else [0.0] * 3
    found = wearing_along(
        0.1, STEEL, PATH, stations([100.0] * 3, section), spindle_speed=np.full(3, spindle)
    )
    assert found == Wear(flank=0.1)
