"""Fits of the block time: of paper 004's table, and of drawn points with known causes."""

import numpy as np
import pytest
from scipy.stats import linregress, t

from extras.calibration.model.block_fit import FeedCause, SpacingFeed, fitted_block_time
from simulator.errors import CalibrationError

TABLE_2 = {
    0.0001: 0.7,
    0.00025: 3.6,
    0.0005: 7.2,
    0.00075: 10.5,
    0.001: 14.6,
    0.0025: 35.6,
    0.005: 71.2,
    0.0075: 106.7,
    0.01: 147.68,
}
"""Vijayaraghavan et al. 2009: in, in/min, on a circle of 1 in"""


def points(feeds: dict[float, float], radius: float | None = None) -> list[SpacingFeed]:
    return [
        SpacingFeed(spacing=25.4 * spacing, feed=25.4 * feed / 60.0, radius=radius)
        for spacing, feed in feeds.items()
    ]


def test_fits_of_table_2_are_not_the_printed_line() -> None:
    """14516 through the origin and 14600 with an intercept are least squares by hand."""
    fit = fitted_block_time(points(TABLE_2, 25.4))
    origin, affine, robust = fit.fits
    assert 60.0 * origin.slope.value == pytest.approx(14_516.0, abs=0.5)
    assert 60.0 * affine.slope.value == pytest.approx(14_600.0, abs=0.5)
    assert affine.intercept is not None
    for each in (origin, robust):
        assert 60.0 * each.slope.high < 14_847.0
    assert fit.causes == (FeedCause.UNKNOWN, *[FeedCause.BLOCK_RATE] * 8)
    assert fit.block_time.low < 4.133e-3
    assert fit.block_time.high > 4.2e-3


def test_least_squares_with_interval_is_that_of_scipy() -> None:
    fit = fitted_block_time(points(TABLE_2)).fits[1]
    x, y = 25.4 * np.array(list(TABLE_2)), 25.4 / 60.0 * np.array(list(TABLE_2.values()))
    judge = linregress(x, y)
    half = t.ppf(0.975, len(x) - 2) * judge.stderr
    assert fit.slope.value == pytest.approx(judge.slope)
    assert fit.slope.high - fit.slope.value == pytest.approx(half)
    assert fit.intercept is not None
    assert fit.intercept.value == pytest.approx(judge.intercept)


def held(spacing: float, radius: float, **limits: float) -> SpacingFeed:
    """Point at the smallest of the block rate and other limits."""
    feeds = [spacing / 0.004, limits.get("commanded", np.inf)]
    feeds.append(np.sqrt(limits.get("acceleration", np.inf) * radius))
    feeds.append(np.sqrt(8.0 * limits.get("corner", np.inf)) * radius / spacing)
    return SpacingFeed(
        spacing=spacing, feed=min(feeds), radius=radius, commanded=limits.get("commanded")
    )


SPACINGS = (0.025, 0.05, 0.1, 0.2, 0.4)


@pytest.mark.parametrize(
    ("cause", "limits"),
    [
        (FeedCause.COMMANDED, {"commanded": 30.0}),
        (FeedCause.ACCELERATION, {"acceleration": 50.0}),
        (FeedCause.CORNER, {"corner": 0.05}),
    ],
)
def test_points_off_the_line_have_a_cause_and_leave_the_fits(
    cause: FeedCause, limits: dict[str, float]
) -> None:
    fit = fitted_block_time([
        held(s, r, **limits) for s in SPACINGS for r in (12.7, 25.4, 50.8)
    ])
    assert set(fit.causes) == {FeedCause.BLOCK_RATE, cause}
    assert fit.block_time.value == pytest.approx(0.004)
    for each in fit.fits:
        assert each.slope.value == pytest.approx(250.0, rel=1e-6)
    if cause is FeedCause.ACCELERATION:
        assert fit.acceleration == pytest.approx(50.0)
    if cause is FeedCause.CORNER:
        assert fit.corner == pytest.approx(0.05)


def test_stops_at_each_block_are_told_from_a_block_rate() -> None:
    found = [
        SpacingFeed(spacing=s, feed=min(s / 0.004, np.sqrt(0.25 * 500.0 * s)), radius=25.4)
        for s in (0.0005, 0.001, 0.0015, 0.01, 0.1, 0.2)
    ]
    fit = fitted_block_time(found)
    assert fit.causes == (*[FeedCause.BLOCK_RATE] * 3, *[FeedCause.STOP] * 3)
    assert fit.acceleration == pytest.approx(500.0)


@pytest.mark.parametrize("seed", range(10))
def test_the_robust_fit_meets_the_truth_with_a_fifth_of_outliers(seed: int) -> None:
    draw = np.random.default_rng(seed)
    times = 0.004 * (1.0 + draw.normal(0.0, 0.01, 25))
    times[:5] *= draw.uniform(1.3, 2.5, 5)
    spacings = draw.uniform(0.01, 0.3, 25)
    fit = fitted_block_time([
        SpacingFeed(spacing=s, feed=s / time)
        for s, time in zip(spacings.tolist(), times.tolist(), strict=True)
    ])
    assert fit.block_time.value == pytest.approx(0.004, rel=0.01)
    assert fit.block_time.low < fit.block_time.value < fit.block_time.high


def test_a_fit_needs_three_spacings_and_a_common_time() -> None:
    with pytest.raises(CalibrationError, match="2 different spacings"):
        fitted_block_time(points({0.001: 14.0, 0.002: 28.0}))
    with pytest.raises(CalibrationError, match="varies by more than 3 %"):
        fitted_block_time(points({0.001: 14.0, 0.002: 14.0, 0.004: 14.0}))
