"""Caps by place: what is air, what is near the stock, and the way into the material."""

from dataclasses import fields, replace

import numpy as np
import pytest

from optimiser.along_path.caps import NAMES, CapName, CutBounds
from optimiser.along_path.stretch import (
    ENTRY_LENGTH,
    ENTRY_SHARE,
    PathStretch,
    place_caps,
    segment_caps,
)
from optimiser.cuts.cut import CutKind
from simulator.motion.segments import arc
from simulator.removal.stations import Stations
from tests.optimiser.along_path.stretches import (
    BOUNDS,
    LIMITS,
    half_cut,
    straight,
    stretch_of,
)


def stretch(met: Stations, near: Stations | None = None) -> PathStretch:
    """Line of 30 mm with a bounded tool."""
    return replace(stretch_of(straight([30.0])), met=met, near=near, bounds=BOUNDS)


def names_at(found: PathStretch, places: list[float]) -> list[CapName]:
    """Names of the caps at some places, mm."""
    caps = place_caps(found)
    rows = np.searchsorted(caps.ends, places)
    return [NAMES[number] for number in caps.caps.name[rows]]


def test_the_chip_is_reduced_on_the_way_in() -> None:
    met = half_cut([10.0, 10.5, 30.0], [False, True, True])
    caps = place_caps(stretch(met))
    before, entry, inside = (
        caps.caps.feed[caps.ends.searchsorted(at)] for at in (5.0, 10.2, 20.0)
    )
    assert before == np.inf
    assert entry == pytest.approx(ENTRY_SHARE * inside)
    assert 10.0 + ENTRY_LENGTH * BOUNDS.cut.diameter > 10.5
    assert names_at(stretch(met), [10.2])[0] is CapName.ENTRY


def test_a_station_that_ends_behind_the_path_by_rounding_is_on_its_last_segment() -> None:
    caps = place_caps(stretch(half_cut([10.0, 30.000000000000004], [False, True])))
    assert caps.ends[-1] == 30.0
    assert caps.segment.max() == 0


def test_a_place_near_the_stock_is_no_air() -> None:
    met = half_cut([10.0, 30.0], [False, True])
    near = half_cut([6.0, 30.0], [False, True])
    caps = place_caps(stretch(met, near))
    assert caps.caps.feed[caps.ends.searchsorted(8.0)] < np.inf
    assert caps.caps.feed[caps.ends.searchsorted(3.0)] == np.inf


def test_a_thicker_cut_near_the_stock_does_not_slow_the_cut() -> None:
    met = half_cut([10.0, 30.0], [False, True])
    deeper = half_cut([10.0, 30.0], [True, True])
    deeper = replace(
        deeper, **{each.name: getattr(deeper, each.name) for each in fields(Stations)}
    )
    with_margin, without = place_caps(stretch(met, deeper)), place_caps(stretch(met))
    at = 20.0
    one = with_margin.caps.feed[with_margin.ends.searchsorted(at)]
    assert one == without.caps.feed[without.ends.searchsorted(at)]


def test_an_engagement_that_is_no_number_is_refused() -> None:
    met = half_cut([10.0, 30.0], [True, True])
    broken = replace(met, section=np.array([18.0, np.nan]))
    with pytest.raises(
        ValueError, match="block 0: the engagement at station 1 is not a number"
    ):
        place_caps(stretch(broken))


def test_arcs_keep_the_acceleration_of_the_axes() -> None:
    circle = arc((2.0, 0.0, 0.0), (0.0, 0.0, 0.0), 2.0 * np.pi, speed=5.0)
    found = segment_caps(circle, LIMITS, greatest=None)
    assert NAMES[found.name[0]] is CapName.CURVATURE
    assert found.feed[0] == pytest.approx(np.sqrt(0.8 * 4000.0 * 2.0))


def test_the_block_time_limits_short_blocks() -> None:
    limits = replace(LIMITS, block_time=0.01)
    found = segment_caps(straight([0.5, 10.0]), limits, greatest=200.0)
    assert found.feed.tolist() == [50.0, 200.0]
    assert [NAMES[number] for number in found.name] == [
        CapName.BLOCK_TIME,
        CapName.FEED_MECHANISM,
    ]


def feed_at(found: PathStretch, at: float) -> float:
    """Greatest feed at a place, mm/s."""
    caps = place_caps(found)
    return float(caps.caps.feed[caps.ends.searchsorted(at)])


CUT = half_cut([10.0, 30.0], [False, True])
FEW = replace(BOUNDS, cut=replace(BOUNDS.cut, tool=replace(BOUNDS.cut.tool, teeth=1)))
"""Bounds of the same tool with one tooth, whose chip is thicker."""


def with_bounds(bounds: CutBounds, *, speed: float) -> PathStretch:
    """Line of 30 mm at a feed, from 10 mm on in material."""
    return replace(stretch_of(straight([30.0], speed=speed)), met=CUT, bounds=bounds)


def test_a_feed_rises_only_to_what_all_guesses_permit() -> None:
    slow = 1.0
    one, other = (feed_at(with_bounds(each, speed=slow), 20.0) for each in (BOUNDS, FEW))
    both = replace(BOUNDS, plausible=(FEW,))
    assert other < one
    assert feed_at(with_bounds(both, speed=slow), 20.0) == min(one, other)


def test_a_feed_falls_only_to_what_the_best_guess_permits() -> None:
    one, other = (feed_at(with_bounds(each, speed=1.0), 20.0) for each in (BOUNDS, FEW))
    both = replace(BOUNDS, plausible=(FEW,))
    between, above = 0.5 * (one + other), 2.0 * one
    assert feed_at(with_bounds(both, speed=between), 20.0) == pytest.approx(between)
    assert feed_at(with_bounds(both, speed=above), 20.0) == pytest.approx(one)


def test_no_feed_falls_for_a_guessed_stock() -> None:
    guessed = replace(BOUNDS, is_stock_guessed=True)
    permitted = feed_at(with_bounds(BOUNDS, speed=1.0), 20.0)
    assert feed_at(with_bounds(guessed, speed=1.0), 20.0) == permitted
    fast = 2.0 * permitted
    found = with_bounds(guessed, speed=fast)
    assert feed_at(found, 20.0) == fast
    assert feed_at(found, 10.2) == fast
    assert names_at(found, [20.0]) == [CapName.GUESSED]


def test_a_guessed_stock_makes_no_air() -> None:
    guessed = replace(BOUNDS, is_stock_guessed=True)
    assert feed_at(with_bounds(BOUNDS, speed=7.0), 5.0) == np.inf
    assert feed_at(with_bounds(guessed, speed=7.0), 5.0) == 7.0


def test_the_feed_before_any_plan_counts_as_programmed() -> None:
    guessed = replace(BOUNDS, is_stock_guessed=True)
    planned = replace(with_bounds(guessed, speed=9.0), programmed=np.array([7.0]))
    assert feed_at(planned, 5.0) == 7.0


def test_a_drill_has_its_feed_before_it_meets_material() -> None:
    drill = replace(BOUNDS, cut=replace(BOUNDS.cut, kind=CutKind.DRILLING))
    guessed = replace(drill, is_stock_guessed=True)
    inside = feed_at(with_bounds(guessed, speed=1.0), 20.0)
    assert feed_at(with_bounds(guessed, speed=1.0), 5.0) == inside
