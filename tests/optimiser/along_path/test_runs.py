"""Feed commands behind a control's filter: the motion of the axes keeps every cap."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.along_path import runs
from optimiser.along_path.caps import NAMES, CapName
from optimiser.along_path.pieces import (
    FeedPieces,
    PieceRules,
    pieces_of,
    without_small_changes,
)
from optimiser.along_path.runs import Commands, commands_of
from optimiser.along_path.stretch import place_caps
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import Segments, lines
from simulator.motion.smoothing import smoothing_of
from tests.optimiser.along_path.stretches import (
    FIR,
    LIMITS,
    places_of,
    straight,
    stretch_of,
    with_control,
)

PLACES = st.lists(
    st.tuples(st.floats(0.05, 30.0), st.sampled_from([2.0, 5.0, 8.0, 20.0, 60.0, np.inf])),
    min_size=2,
    max_size=12,
)


def commanded(segments: Segments, commands: Commands) -> Segments:
    """Segments of the commands: one for each place."""
    begins = np.concatenate(([0.0], commands.ends[:-1]))
    offsets = np.concatenate(([0.0], np.cumsum(segments.length)))
    row = commands.segment
    kept = commands.ends > begins
    start = segments.position(row, begins - offsets[row])
    end = segments.position(row, commands.ends - offsets[row])
    return replace(
        segments[row],
        start=start,
        end=end,
        speed=commands.caps.feed,
        block=np.arange(len(row)),
    )[kept]


def speeds_of(path: Segments) -> tuple[np.ndarray, np.ndarray]:
    """Places along a path, mm, and speeds of the axes there, mm/s."""
    motion = FIR.control.plan(path, LIMITS)
    times = np.linspace(0.0, motion.duration, 4000)
    at = motion.at(times)
    offsets = np.concatenate(([0.0], np.cumsum(path.length)))
    return offsets[at.segment] + at.station, np.linalg.norm(at.velocity, axis=1)


@settings(max_examples=60)
@given(PLACES)
def test_axes_never_exceed_a_cap(places: list[tuple[float, float]]) -> None:
    ends = np.cumsum([length for length, _ in places]).tolist()
    caps = [cap for _, cap in places]
    segments = straight([ends[-1]])
    commands = commands_of(stretch_of(segments), places_of(segments, ends, caps), FIR)
    where, speed = speeds_of(commanded(segments, commands))
    # Speeds are compared just inside the places, whose ends belong to two of them.
    row = np.searchsorted(ends, where)
    inside = np.abs(where[:, None] - np.array([0.0, *ends])).min(axis=1) > 1e-6
    row = np.minimum(row, len(caps) - 1)
    assert (speed[inside] <= np.array(caps)[row][inside] * (1.0 + 1e-9)).all()


@settings(max_examples=40)
@given(PLACES, st.floats(1.0, 3.0))
def test_wider_caps_take_no_more_time(places: list[tuple[float, float]], factor: float) -> None:
    ends = np.cumsum([length for length, _ in places]).tolist()
    caps = [cap for _, cap in places]
    segments = straight([ends[-1]])

    def time(by: float) -> float:
        wider = [by * cap for cap in caps]
        found = commands_of(stretch_of(segments), places_of(segments, ends, wider), FIR)
        greatest = float(found.caps.feed.max())
        window = smoothing_of(FIR.control, LIMITS, greatest).window
        return float((np.diff(found.ends, prepend=0.0) / found.caps.feed).sum()) + window

    # The greatest feed is tried on a grid, so that a wider cap may miss the best by little.
    assert time(factor) <= 1.02 * time(1.0)


@settings(max_examples=20)
@given(PLACES)
def test_trials_that_a_bound_leaves_out_change_nothing(
    places: list[tuple[float, float]],
) -> None:
    ends = np.cumsum([length for length, _ in places]).tolist()
    segments = straight([ends[-1]])
    found = []
    for certain in (runs.CERTAIN, 0.0):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(runs, "CERTAIN", certain)  # nothing is left out at 0
            within = places_of(segments, ends, [cap for _, cap in places])
            found.append(commands_of(stretch_of(segments), within, FIR))
    assert np.array_equal(found[0].ends, found[1].ends)
    assert np.array_equal(found[0].caps.feed, found[1].caps.feed)


def test_corners_are_rounded_no_more_than_permitted() -> None:
    segments = lines([(0, 0, 0), (40, 0, 0), (40, 40, 0)], speed=5.0)
    commands = commands_of(
        stretch_of(segments), places_of(segments, [40.0, 80.0], [np.inf, np.inf]), FIR
    )
    motion = FIR.control.plan(commanded(segments, commands), LIMITS)
    at = motion.at(np.linspace(0.0, motion.duration, 20_000)).position
    nearest = np.linalg.norm(at - np.array([40.0, 0.0, 0.0]), axis=1).min()
    given = smoothing_of(FIR.control, LIMITS, 5.0).corner_gain * 5.0 * np.sin(np.pi / 4.0)
    assert nearest <= max(FIR.tolerance, given) * 1.001
    assert CapName.CORNER in {NAMES[number] for number in commands.caps.name}


@pytest.mark.parametrize("name", [ControlModelName.EXACT_STOP, ControlModelName.JUNCTION])
def test_a_control_without_a_filter_needs_no_guard(name: ControlModelName) -> None:
    segments = straight([30.0])
    places = places_of(segments, [10.0, 20.0, 30.0], [np.inf, 5.0, np.inf])
    commands = commands_of(stretch_of(segments), places, with_control(FIR, name))
    assert commands.ends.tolist() == [10.0, 20.0, 30.0]
    assert commands.caps.feed.tolist() == [300.0, 5.0, 300.0]


def test_a_locked_feed_stays_and_its_neighbours_wait_for_it() -> None:
    segments = straight([10.0, 10.0, 10.0])
    stretch = replace(stretch_of(segments), is_free=np.array([True, False, True]))
    commands = commands_of(
        stretch, places_of(segments, [10.0, 20.0, 30.0], [np.inf, np.inf, np.inf]), FIR
    )
    locked = commands.segment == 1
    assert (commands.caps.feed[locked] == 10.0).all()
    where, speed = speeds_of(commanded(segments, commands))
    assert speed[(where > 10.0) & (where < 20.0)].max() <= 10.0 * (1.0 + 1e-9)


def test_the_parts_of_a_block_cover_it_and_keep_its_caps() -> None:
    segments = straight([30.0], speed=4.0)
    ends, caps = [3.0, 3.2, 9.0, 30.0], [20.0, 5.0, 20.0, np.inf]
    commands = commands_of(stretch_of(segments), places_of(segments, ends, caps), FIR)
    pieces = pieces_of(stretch_of(segments), commands, PieceRules(least_length=0.5))
    assert pieces.begin[0] == 0.0
    assert pieces.begin[1:] == pytest.approx((pieces.begin + pieces.length)[:-1])
    assert pieces.length.sum() == pytest.approx(30.0)
    assert (pieces.length >= 0.5 - 1e-9).all()
    for begin, length, rate in zip(pieces.begin, pieces.length, pieces.rate, strict=True):
        starts = np.concatenate(([0.0], commands.ends[:-1]))
        touched = (starts < begin + length - 1e-9) & (commands.ends > begin + 1e-9)
        assert rate <= commands.caps.feed[touched].min() * (1.0 + 1e-12)


@given(
    st.lists(st.tuples(st.integers(0, 3), st.floats(1.0, 50.0)), min_size=1, max_size=12),
    st.floats(0.0, 0.5),
)
def test_small_changes_within_a_block_are_lowered(
    rows: list[tuple[int, float]], change: float
) -> None:
    rows.sort(key=lambda row: row[0])
    block, rate = np.array([each for each, _ in rows]), np.array([each for _, each in rows])
    ones = np.ones(len(rows))
    pieces = FeedPieces(
        block=block,
        begin=ones,
        length=ones,
        weight=ones,
        rate=rate,
        name=block,
        programmed=ones,
        is_per_revolution=np.zeros(len(rows), dtype=np.bool_),
        run=block,
        last_run=block,
    )
    found = without_small_changes(pieces, change)
    assert (found <= rate).all()
    together = np.diff(block) == 0
    low, high = np.minimum(found[1:], found[:-1]), np.maximum(found[1:], found[:-1])
    assert ((high == low) | (high >= (1.0 + change) * low))[together].all()


def test_a_programmed_feed_near_the_best_is_kept() -> None:
    segments = straight([30.0], speed=4.95)
    stretch = stretch_of(segments)
    commands = commands_of(stretch, places_of(segments, [30.0], [5.0]), FIR)
    pieces = pieces_of(stretch, commands, PieceRules())
    assert pieces.rate.tolist() == [4.95]


def test_a_block_in_one_piece_is_not_slowed_for_a_smoother_corner() -> None:
    """A fast feed elsewhere lengthens the filter; the whole of both lines would pay for it."""
    segments = lines([(0, 0, 0), (100, 0, 0), (5, 8, 0), (200, 8, 0)], speed=8.0)
    stretch = replace(stretch_of(segments), can_split=np.array([False, False, True]))
    places = places_of(segments, np.cumsum(segments.length).tolist(), [np.inf] * 3)
    pieces = pieces_of(stretch, commands_of(stretch, places, FIR), PieceRules())
    given = float((segments.length / segments.speed).sum())
    assert float((pieces.length / pieces.rate).sum()) <= given * (1.0 + 1e-9)


def test_a_path_without_length_has_no_commands() -> None:
    segments = lines([(1, 2, 3), (1, 2, 3)], speed=5.0)
    found = commands_of(stretch_of(segments), place_caps(stretch_of(segments)), FIR)
    assert len(found.ends) == len(found.run) == 0
    assert len(pieces_of(stretch_of(segments), found, PieceRules())) == 0
