"""What a filter carries into a cut is found, and slowed down only where it must be."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.along_path.filter_transfer import excess, permitted_commands, slower_pieces
from optimiser.along_path.pieces import PieceRules
from optimiser.along_path.stretch import PathStretch, met_caps
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import Floats
from simulator.motion.smoothing import smoothing_of
from tests.optimiser.along_path.stretches import (
    BOUNDS,
    FIR,
    LIMITS,
    half_cut,
    straight,
    stretch_of,
    with_control,
)

FEEDS = st.lists(st.floats(1.0, 250.0), min_size=3, max_size=3)


def entering(feeds: list[float], *, cut: tuple[float, float] = (10.0, 20.0)) -> PathStretch:
    """Three blocks of 10 mm; the tool cuts between two places."""
    places = np.union1d(cut, [10.0, 20.0, 30.0])
    middle = places - 0.5 * np.diff(places, prepend=0.0)
    met = half_cut(places.tolist(), [cut[0] < each < cut[1] for each in middle])
    segment = np.minimum((middle / 10.0).astype(np.int64), 2)
    met = replace(met, segment=segment, station=places - 10.0 * segment)
    segments = replace(straight([10.0, 10.0, 10.0]), speed=np.array(feeds))
    return replace(stretch_of(segments), met=met, bounds=BOUNDS)


def greatest_in_cut(stretch: PathStretch, cut: tuple[float, float]) -> float:
    """Greatest speed of the axes over the permitted one, while the tool cuts."""
    motion = FIR.control.plan(stretch.segments, LIMITS)
    at = motion.at(np.linspace(0.0, motion.duration, 8000))
    offsets = np.concatenate(([0.0], np.cumsum(stretch.segments.length)))
    where = offsets[at.segment] + at.station
    inside = (where > cut[0] + 1e-6) & (where < cut[1] - 1e-6)
    speed: Floats = np.linalg.norm(at.velocity, axis=1)
    return float(speed[inside].max() / met_caps(stretch).caps.feed.min())


@settings(max_examples=40)
@given(FEEDS, st.floats(0.5, 14.0), st.floats(15.0, 29.0))
def test_slower_pieces_keep_the_cap(feeds: list[float], begin: float, end: float) -> None:
    stretch = entering(feeds, cut=(begin, end))
    pieces = slower_pieces(stretch, FIR, PieceRules())
    if pieces is None:
        assert excess(stretch, FIR).max() <= 1.003
        return
    assert (pieces.rate <= pieces.programmed).all()
    untouched = [block for block in range(3) if block not in pieces.block]
    blocks = np.concatenate((pieces.block, untouched))
    begins = np.concatenate((pieces.begin, np.zeros(len(untouched))))
    order = np.lexsort((begins, blocks))
    length = np.concatenate((pieces.length, np.full(len(untouched), 10.0)))[order]
    speed = np.concatenate((pieces.rate, np.array(feeds)[untouched]))[order]
    after = replace(stretch, segments=replace(straight(length.tolist()), speed=speed))
    assert greatest_in_cut(after, (begin, end)) <= 1.003


def test_a_fast_way_to_a_cut_is_slow_only_before_it() -> None:
    permitted = float(met_caps(entering([1.0, 1.0, 1.0])).caps.feed.min())
    stretch = entering([200.0, permitted, permitted])
    pieces = slower_pieces(stretch, FIR, PieceRules())
    assert pieces is not None
    assert pieces.block.tolist() == [0, 0]
    assert pieces.rate.tolist() == pytest.approx([200.0, permitted])
    reach = smoothing_of(FIR.control, LIMITS, 200.0).reach * permitted
    assert pieces.length[1] == pytest.approx(max(reach, PieceRules().least_length))
    whole = slower_pieces(
        replace(stretch, can_split=np.zeros(3, dtype=np.bool_)), FIR, PieceRules()
    )
    assert whole is not None
    assert whole.rate.tolist() == pytest.approx([permitted])


def test_the_excess_is_the_feed_over_the_permitted_one() -> None:
    stretch = entering([40.0, 50.0, 20.0])
    permitted = float(met_caps(stretch).caps.feed.min())
    assert excess(stretch, FIR).tolist() == pytest.approx([
        40.0 / permitted,
        50.0 / permitted,
        20.0 / permitted,
    ])
    locked = replace(stretch, is_free=np.array([True, False, True]))
    assert excess(locked, FIR)[1] == 0.0
    without = with_control(FIR, ControlModelName.JUNCTION)
    assert excess(stretch, without)[[0, 2]].tolist() == [0.0, 0.0]


def test_feeds_per_revolution_are_judged_as_such() -> None:
    """A faster spindle after the cut: the same feed per revolution is permitted everywhere."""
    permitted = float(met_caps(entering([1.0, 1.0, 1.0])).caps.feed.min())
    faster = replace(
        entering([permitted, permitted, 1.2 * permitted], cut=(1.0, 29.0)),
        spindle=np.array([50.0, 50.0, 60.0]),
    )
    assert excess(faster, FIR).max() > 1.19
    own = replace(faster, per_revolution=np.full(3, permitted / 50.0))
    assert excess(own, FIR).tolist() == pytest.approx([1.0, 1.0, 1.0])


def test_rapids_and_paths_without_length_permit_everything() -> None:
    stretch = entering([10.0, 10.0, 10.0])
    rapid = replace(stretch.segments, is_rapid=np.ones(3, dtype=np.bool_))
    assert not excess(replace(stretch, segments=rapid), FIR).any()
    point = replace(stretch_of(straight([0.0])), bounds=BOUNDS)
    assert len(permitted_commands(point, FIR).ends) == 0
    assert slower_pieces(point, FIR, PieceRules()) is None
