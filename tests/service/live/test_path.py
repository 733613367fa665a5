"""A thinned path keeps what is seen, and tells truly how far it is off."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from service.errors import NotFound
from service.live import path as module
from service.live.path import (
    COLUMNS,
    FEWEST,
    FINE_COLOUR,
    FINE_LENGTH,
    TravelledPath,
    deviation,
    path_of,
    shown_path,
    thinned,
)
from service.live.series import Series, SeriesWriter, open_series
from simulator.motion.segments import Floats


def path_through(position: Floats, feed: Floats, force: Floats) -> TravelledPath:
    count = len(feed)
    return TravelledPath(
        time=np.linspace(0.0, 0.05 * count, count),
        position=position,
        feed=feed,
        force=force,
        is_rapid=np.zeros(count, dtype=np.bool_),
        workingstep=np.ones(count, dtype=np.int64),
    )


@st.composite
def paths(draw: st.DrawFn) -> TravelledPath:
    count = draw(st.integers(1, 120))

    def column(low: float, high: float) -> Floats:
        numbers = st.floats(low, high, width=32)
        found: Floats = draw(arrays(np.float64, count, elements=numbers))
        return found

    position = np.column_stack([column(-500.0, 500.0) for _ in range(3)])
    steps = draw(arrays(np.float64, count, elements=st.floats(0.0, 2.0, width=32)))
    return TravelledPath(
        time=np.cumsum(steps),
        position=position,
        feed=column(0.0, 20_000.0),
        force=column(0.0, 5_000.0),
        is_rapid=draw(arrays(np.bool_, count)),
        workingstep=np.sort(draw(arrays(np.int64, count, elements=st.integers(0, 4)))),
    )


def straight_lines(
    path: TravelledPath, kept: list[int], at: int
) -> tuple[Floats, float, float]:
    """Position, feed and force at a moment, between the two kept points around it."""
    after = next(place for place, each in enumerate(kept) if each >= at)
    if kept[after] == at:
        return path.position[at], path.feed[at], path.force[at]
    a, b = kept[after - 1], kept[after]
    span = path.time[b] - path.time[a]
    share = (path.time[at] - path.time[a]) / span if span > 0.0 else 0.0
    return (
        path.position[a] + share * (path.position[b] - path.position[a]),
        path.feed[a] + share * (path.feed[b] - path.feed[a]),
        path.force[a] + share * (path.force[b] - path.force[a]),
    )


@given(paths(), st.integers(FEWEST, 150))
def test_ends_and_extremes_stay_within_the_number(path: TravelledPath, points: int) -> None:
    kept = thinned(path, points)
    assert len(kept) <= points
    assert np.all(np.diff(kept) > 0)
    assert kept[0] == 0
    assert kept[-1] == len(path) - 1
    shown = path.at(kept)
    assert np.array_equal(shown.position.min(axis=0), path.position.min(axis=0))
    assert np.array_equal(shown.position.max(axis=0), path.position.max(axis=0))
    assert shown.force.max() == path.force.max()
    assert shown.feed[~shown.is_rapid].max(initial=0.0) == path.feed[~path.is_rapid].max(
        initial=0.0
    )


@given(paths(), st.integers(FEWEST, 150))
def test_no_point_is_farther_off_than_is_told(path: TravelledPath, points: int) -> None:
    # Two rows of one moment have no line between them: the later speaks for both.
    path = TravelledPath(
        time=path.time + 0.001 * np.arange(len(path)),
        position=path.position,
        feed=path.feed,
        force=path.force,
        is_rapid=path.is_rapid,
        workingstep=path.workingstep,
    )
    kept = thinned(path, points)
    told = deviation(path, kept)
    for at in range(len(path)):
        position, feed, force = straight_lines(path, list(kept), at)
        assert np.linalg.norm(path.position[at] - position) <= told.length + 1e-6
        assert path.is_rapid[at] or abs(path.feed[at] - feed) <= told.feed + 1e-6
        assert abs(path.force[at] - force) <= told.force + 1e-6


@given(paths())
def test_with_room_enough_nothing_that_is_seen_is_lost(path: TravelledPath) -> None:
    path = TravelledPath(
        time=np.linspace(0.0, 0.05 * len(path), len(path)),
        position=path.position,
        feed=path.feed,
        force=path.force,
        is_rapid=np.zeros(len(path), dtype=np.bool_),
        workingstep=path.workingstep,
    )
    told = deviation(path, thinned(path, len(path) + FEWEST))
    size = float(np.ptp(path.position, axis=0).max())
    assert told.length <= FINE_LENGTH * size * (1.0 + 1e-9) + 1e-12
    assert told.feed <= FINE_COLOUR * path.feed.max() * (1.0 + 1e-9) + 1e-12
    assert told.force <= FINE_COLOUR * path.force.max() * (1.0 + 1e-9) + 1e-12


def test_a_straight_cut_at_an_even_feed_needs_its_ends_only() -> None:
    run = np.linspace(0.0, 100.0, 1000)
    still = np.zeros(1000)
    path = path_through(np.column_stack([run, still, still]), still + 300.0, still + 800.0)
    assert list(thinned(path, 100)) == [0, 999]


def test_the_corner_of_a_square_stays() -> None:
    out, zeros = np.linspace(0.0, 50.0, 500), np.zeros(500)
    corner = np.concatenate([np.column_stack([out, zeros]), np.column_stack([50 + zeros, out])])
    position = np.column_stack([corner, np.zeros(1000)])
    kept = thinned(path_through(position, np.full(1000, 300.0), np.full(1000, 9.0)), FEWEST)
    assert {499, 500} & set(kept)
    assert deviation(path_through(position, np.ones(1000), np.ones(1000)), kept).length < 0.11


def test_a_change_of_force_on_a_straight_path_stays() -> None:
    run, still = np.linspace(0.0, 100.0, 1000), np.zeros(1000)
    force = np.where(np.arange(1000) < 400, 200.0, 900.0)
    path = path_through(np.column_stack([run, still, still]), still + 300.0, force)
    assert set(thinned(path, FEWEST)) == {0, 399, 400, 999}


def test_both_sides_of_a_rapid_move_and_of_a_workingstep_stay() -> None:
    run, still = np.linspace(0.0, 100.0, 1000), np.zeros(1000)
    plain = path_through(np.column_stack([run, still, still]), still + 300.0, still)
    path = TravelledPath(
        time=plain.time,
        position=plain.position,
        feed=plain.feed,
        force=plain.force,
        is_rapid=(run > 20.0) & (run < 30.0),
        workingstep=1 + (run > 60.0).astype(np.int64),
    )
    assert {199, 200, 299, 300, 599, 600} <= set(thinned(path, FEWEST))


def test_few_points_take_the_greatest_corners_first() -> None:
    count = 4000
    angle = np.linspace(0.0, 40.0 * np.pi, count)
    spiral = np.column_stack([angle * np.cos(angle), angle * np.sin(angle), np.zeros(count)])
    path = path_through(spiral, np.full(count, 300.0), np.full(count, 9.0))
    rough, fine = thinned(path, 200), thinned(path, 1000)
    assert len(rough) == 200
    assert deviation(path, fine).length < deviation(path, rough).length < 0.05 * 250.0


def test_a_missing_force_is_no_obstacle() -> None:
    run, still = np.linspace(0.0, 100.0, 50), np.zeros(50)
    path = path_through(np.column_stack([run, still, still]), still + 300.0, still + np.nan)
    assert list(thinned(path, FEWEST)) == [0, 49]


@given(st.integers(0, 3), st.integers(60, 400), st.integers(FEWEST, 50))
def test_a_path_in_pieces_is_as_true_as_it_says(seed: int, rows: int, points: int) -> None:
    numbers = np.random.default_rng(seed).normal(size=(rows, len(COLUMNS))).cumsum(axis=0)
    numbers[:, 0] = 0.1 * np.arange(rows)
    numbers[:, 6:] = 2.0, 1.0
    series = Series(columns=COLUMNS, values=numbers)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "PIECE", 50)
        shown = shown_path(series, points)
    whole = path_of(series)
    kept = np.searchsorted(whole.time, shown.path.time)
    assert len(kept) <= points
    assert shown.rows == rows
    assert shown.deviation == deviation(whole, kept)
    for axis in range(3):
        assert np.ptp(shown.path.position[:, axis]) == np.ptp(whole.position[:, axis])


def test_a_path_in_one_piece_is_thinned_once() -> None:
    numbers = np.random.default_rng(1).normal(size=(300, len(COLUMNS)))
    numbers[:, 0] = np.arange(300)
    series = Series(columns=COLUMNS, values=numbers)
    shown, whole = shown_path(series, 40), path_of(series)
    kept = thinned(whole, 40)
    assert np.array_equal(shown.path.time, whole.time[kept])
    assert shown.deviation == deviation(whole, kept)


def test_too_few_points_are_refused() -> None:
    still = np.zeros(5)
    with pytest.raises(ValueError, match="at least 20"):
        thinned(path_through(np.zeros((5, 3)), still, still), FEWEST - 1)


def test_rows_of_a_run_become_a_path(tmp_path: Path) -> None:
    file = tmp_path / "series.bin"
    rows = np.array([[0.0, 1, 2, 3, 0, 0, 1, 0], [0.1, 4, 5, 6, 300, 80, 2, 1]])
    with SeriesWriter(file, COLUMNS) as writer:
        writer.add(rows)
    series = open_series(file)
    assert series is not None
    path = path_of(series)
    assert list(path.is_rapid) == [True, False]
    assert list(path.workingstep) == [0, 1]
    assert list(path.position[1]) == [4.0, 5.0, 6.0]
    assert path.feed[1] == pytest.approx(300.0)
    assert path.force[1] == pytest.approx(80.0)


def test_rows_without_a_position_are_no_path(tmp_path: Path) -> None:
    file = tmp_path / "series.bin"
    with SeriesWriter(file, ["time_s", "x_mm"]) as writer:
        writer.add(np.zeros((2, 2)))
    series = open_series(file)
    assert series is not None
    with pytest.raises(NotFound, match="y_mm"):
        path_of(series)
