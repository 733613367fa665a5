"""Loads at a place are those from which its caps were computed."""

from dataclasses import replace

import numpy as np
import pytest

from optimiser.along_path.caps import CapName, station_caps
from optimiser.along_path.filter_transfer import BrokenBound
from optimiser.along_path.pieces import PieceRules, pieces_of
from optimiser.along_path.place_loads import (
    broken_bounds,
    loads_at,
    lost_times,
    row_of,
    worst_bounds,
)
from optimiser.along_path.runs import commands_of
from optimiser.along_path.stretch import PathStretch, place_caps
from optimiser.solver.problem import LimitName
from tests.optimiser.along_path.stretches import BOUNDS, FIR, half_cut, straight, stretch_of

SPINDLE = 50.0


def cut_at(speed: float) -> PathStretch:
    """30 mm in three blocks, of which the middle one cuts, at a feed in mm/s."""
    met = half_cut([10.0, 10.0, 10.0], [False, True, False])
    met = replace(met, segment=np.arange(3))
    segments = straight([10.0, 10.0, 10.0], speed=speed)
    return replace(stretch_of(segments), met=met, bounds=BOUNDS)


@pytest.mark.parametrize("name", ["motor_power", "tool_deflection", "shank_strength"])
def test_a_load_is_above_its_bound_as_far_as_the_feed_is_above_its_cap(name: str) -> None:
    """A load rises as the feed to the power 1 − m_c."""
    place = row_of(half_cut([1.0], [True]), 0)
    feed = 400.0
    loads = loads_at(place, BOUNDS, feed=feed, spindle=SPINDLE)
    load = next(each for each in loads if each.limit.name == name)
    exponent = 1.0 - BOUNDS.at.material.kienzle.m_c
    at_bound = feed * (1.0 - load.margin) ** (-1.0 / exponent)
    again = loads_at(place, BOUNDS, feed=at_bound, spindle=SPINDLE)
    found = next(each for each in again if each.limit.name == name)
    assert found.margin == pytest.approx(0.0, abs=1e-6)


def test_the_feed_at_a_broken_bound_is_the_cap() -> None:
    stretch = cut_at(200.0)
    caps = station_caps(
        row_of(stretch.met, 1), BOUNDS, spindle=np.array([SPINDLE]), descent=np.zeros(1)
    )
    places = place_caps(stretch)
    pieces = pieces_of(stretch, commands_of(stretch, places, FIR), PieceRules())
    broken = broken_bounds(stretch, pieces)
    lost = lost_times(pieces)
    worst = max(lost, key=lambda name: lost[name])
    assert broken[worst].block == stretch.segments.block[1]
    assert broken[worst].ratio == pytest.approx(200.0 / float(caps.caps.feed[0]))
    load = broken[worst].load
    assert load is not None
    assert load.limit.name is LimitName.FEED_PER_TOOTH
    assert load.value == pytest.approx(200.0 / (SPINDLE * BOUNDS.cut.tool.teeth))
    assert lost[worst] > 0.0


def test_a_permitted_feed_breaks_nothing() -> None:
    stretch = cut_at(1.0)
    pieces = pieces_of(stretch, commands_of(stretch, place_caps(stretch), FIR), PieceRules())
    assert broken_bounds(stretch, pieces) == {}
    assert lost_times(pieces) == {}


def test_the_worst_of_two_stretches_is_kept() -> None:
    def broken(speed: float) -> dict[CapName, BrokenBound]:
        stretch = cut_at(speed)
        commands = commands_of(stretch, place_caps(stretch), FIR)
        return broken_bounds(stretch, pieces_of(stretch, commands, PieceRules()))

    slow, fast = broken(150.0), broken(200.0)
    assert worst_bounds(slow, fast) == worst_bounds(fast, slow) == fast


def test_a_least_feed_of_the_user_does_not_hide_what_is_broken() -> None:
    stretch = replace(cut_at(200.0), bounds=replace(BOUNDS, least=150.0))
    pieces = pieces_of(stretch, commands_of(stretch, place_caps(stretch), FIR), PieceRules())
    assert lost_times(pieces) == {}
    (broken,) = broken_bounds(stretch, pieces).values()
    assert broken.load is not None
    assert broken.load.limit.name is LimitName.FEED_PER_TOOTH
