"""Feeds from sampled positions, against a known truth: jitter, gaps, any rate of samples."""

import numpy as np
import pytest

from extras.calibration.model.block_feed import (
    DWELL,
    BlockCircle,
    BlockTest,
    CircleFeed,
    MissedCircle,
    PositionLog,
    circle_feeds,
    circles_of,
    program_blocks,
    zero_of_log,
)
from simulator.motion.segments import Floats

RAMP = 0.1
"""s, of acceleration at both ends of the truth"""


def circles(feed: float = 300.0) -> tuple[BlockCircle, ...]:
    test = BlockTest(radii=(12.7, 50.8), spacings=(0.0254, 0.254), feed=feed, lines=1000)
    return circles_of(program_blocks(test, name=""))


def truth(found: tuple[BlockCircle, ...], *, block_time: float, rate: float) -> PositionLog:
    """Run of circles at spacing over block time, with ramps, pauses and ways between them."""
    times: list[Floats] = []
    places: list[Floats] = []
    begin = 0.0
    for circle in found:
        speed = circle.spacing / block_time
        moving = circle.length / speed + RAMP
        own = np.arange(0.0, moving + 2.0 * DWELL, 1.0 / rate)
        station = _trapezoid(np.clip(own - DWELL, 0.0, moving), speed, moving)
        turned = circle.angle(circle.points[:1]) + station * circle.turn / circle.length
        first, second = circle.axes
        place = np.tile(circle.centre, (len(own), 1))
        place[:, first] += circle.radius * np.cos(turned)
        place[:, second] += circle.radius * np.sin(turned)
        times.append(begin + own)
        places.append(place)
        begin += moving + 2.0 * DWELL + 0.5
    return PositionLog(time=np.concatenate(times), position=np.concatenate(places))


def _trapezoid(time: Floats, speed: float, whole: float) -> Floats:
    """Way by a trapezoid of speed with ramps at both ends."""
    ramp = 0.5 * speed / RAMP
    rest = np.clip(whole - time, 0.0, RAMP)
    steady = speed * (np.clip(time, 0.0, whole) - 0.5 * RAMP)
    found: Floats = np.where(
        time < RAMP,
        ramp * time**2,
        np.where(rest < RAMP, speed * (whole - RAMP) - ramp * rest**2, steady),
    )
    return found


def disturbed(log: PositionLog, *, jitter: float, missing: float, seed: int) -> PositionLog:
    """The log with stamps that are off by up to some seconds, and without some samples."""
    draw = np.random.default_rng(seed)
    kept = draw.random(len(log)) >= missing
    time = np.maximum.accumulate(log.time + draw.uniform(-jitter, jitter, len(log)))
    noise = draw.normal(0.0, 0.001, log.position.shape)
    return PositionLog(time=time[kept], position=(log.position + noise)[kept])


@pytest.mark.parametrize("rate", [10.0, 17.0, 100.0])
@pytest.mark.parametrize("block_time", [0.002, 0.004, 0.01])
def test_feeds_are_those_of_the_truth_whatever_the_sampling(
    rate: float, block_time: float
) -> None:
    found = circles()
    exact = truth(found, block_time=block_time, rate=rate)
    errors = []
    for seed in range(5):
        log = disturbed(exact, jitter=0.4 / rate, missing=0.1, seed=seed)
        for each in circle_feeds(log, found):
            assert isinstance(each, CircleFeed)
            errors.append(each.feed * block_time / each.circle.spacing - 1.0)
    # Stamps off by 40 ms on a circle of 2 s: some per cent each, none on average.
    assert np.abs(errors).max() < 0.6 / rate + 0.002
    assert abs(np.mean(errors)) < 0.01


@pytest.mark.parametrize("block_time", [0.002, 0.004])
def test_without_jitter_the_feed_is_exact_although_chords_are_too_short(
    block_time: float,
) -> None:
    found = circles()
    log = truth(found, block_time=block_time, rate=10.0)
    coarse = next(each for each in found if each.spacing > 0.2)
    for each in circle_feeds(log, found):
        assert isinstance(each, CircleFeed)
        assert each.feed == pytest.approx(each.circle.spacing / block_time, rel=1e-4)
    # The fallacy: distance of two samples over their time.
    steps = np.linalg.norm(np.diff(log.position, axis=0), axis=1) / np.diff(log.time)
    away = np.linalg.norm(log.position - coarse.centre, axis=1) > coarse.radius + 0.1
    on_it = ~away[:-1] & ~away[1:]
    assert steps[on_it].max() < 0.99 * coarse.spacing / block_time


def test_a_fifth_of_wrong_samples_does_no_harm() -> None:
    found = circles()[:1]
    log = truth(found, block_time=0.004, rate=50.0)
    draw = np.random.default_rng(1)
    middle = (log.time > 2.0) & (log.time < 4.0) & (draw.random(len(log)) < 0.2)
    log.position[middle] = found[0].centre + draw.uniform(-1.0, 1.0, (middle.sum(), 3))
    each = next(iter(circle_feeds(log, found)))
    assert isinstance(each, CircleFeed)
    assert each.feed == pytest.approx(each.circle.spacing / 0.004, rel=0.01)


def test_circles_that_the_log_does_not_show_are_said() -> None:
    found = circles()
    log = truth(found, block_time=0.004, rate=10.0)
    half = log.time < 8.0
    cut = PositionLog(time=log.time[half], position=log.position[half])
    told = list(circle_feeds(cut, found))
    assert isinstance(told[0], CircleFeed)
    assert isinstance(told[-1], MissedCircle)
    assert told[-1].reason == "no samples at its start and its end"
    rare = PositionLog(time=log.time[::40], position=log.position[::40])
    assert all(isinstance(each, MissedCircle) for each in circle_feeds(rare, found))


def test_the_zero_of_a_log_is_found_by_its_rests() -> None:
    found = circles()
    log = truth(found, block_time=0.004, rate=20.0)
    shift = np.array([300.0, -20.0, 41.5])
    moved = PositionLog(time=log.time, position=log.position + shift)
    zero = zero_of_log(moved, found)
    assert zero == pytest.approx(shift, abs=1e-6)
    still = PositionLog(time=log.time, position=np.zeros_like(log.position))
    assert zero_of_log(still, found) is None
