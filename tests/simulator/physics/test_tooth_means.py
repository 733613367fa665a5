"""Means of tooth periods against the forces along every edge, integrated in time."""

from math import atan, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.tooth_forces import forces, one_place
from simulator.physics.tooth_means import LOST, Arcs, Floats, Periods, means_of, periods
from simulator.physics.uneven_teeth import Runout, eccentric_runout

EXPONENT = 0.75
FEED = 0.04
SAMPLES = 192
"""of a tooth period, by which the judge integrates"""


def arcs(teeth: int, entry: float, exit_: float, lag: float) -> Arcs:
    even = np.ones(teeth)
    return Arcs(entry_angle=entry * even, exit_angle=exit_ * even, lag=lag * even)


def tooth_means(at: Periods, offsets: Floats) -> Floats:
    """Means of (M, z) sets of offsets, by the kernel as plain Python."""
    means = np.empty(offsets.shape)
    for row, each in zip(means, offsets, strict=True):
        means_of(at, each, row)
    return means


def shares(at: Arcs, offsets: Floats, *, delay: float = 0.0, feed: float = FEED) -> Floats:
    per_tooth = np.full(len(offsets), feed)
    prepared = periods(at, feed_per_tooth=per_tooth, exponent=EXPONENT, delay=delay)
    means = tooth_means(prepared, offsets[None])[0]
    return np.asarray(means / means.mean())


def integrated(
    teeth: int, entry: float, exit_: float, lag: float, offsets: Floats, *, delay: float = 0.0
) -> Floats:
    """Shares by :func:`forces`, shown by an instrument that lags."""
    middle = (np.arange(teeth * SAMPLES) + 0.5) / SAMPLES
    found = forces(
        CuttingEdges(teeth=teeth, diameter=2.0, helix_angle=atan(lag)),
        one_place(entry, exit_, axial_depth=1.0),
        ForceLaw(exponent=EXPONENT),
        rotation=(entry + 2.0 * pi / teeth * middle)[None, :],
        runout=Runout(offsets=offsets, feed_per_tooth=np.array([FEED])),
    )
    force = found.tangential[0]
    if delay:
        age = 2.0 * pi / (teeth * SAMPLES) * np.arange(len(force))
        weight = np.exp(-age / delay)
        spectrum = np.fft.fft(force) * np.fft.fft(weight / weight.sum())
        force = np.fft.ifft(spectrum).real
    means = force.reshape(teeth, SAMPLES).mean(axis=1)
    return np.asarray(means / means.mean())


@settings(max_examples=60)
@given(
    teeth=st.integers(2, 8),
    arc=st.sampled_from([(0.0, pi), (1.4, pi), (2.6, pi), (0.0, 1.0), (0.6, 2.3)]),
    lag=st.sampled_from([0.0, 0.05, 0.4, 1.2]),
    eccentricity=st.floats(0.0, 0.03),
    delay=st.sampled_from([0.0, 0.1]),
    lost=st.booleans(),
)
def test_periods_take_what_the_edges_take(
    teeth: int,
    arc: tuple[float, float],
    lag: float,
    eccentricity: float,
    delay: float,
    lost: bool,
) -> None:
    offsets = eccentric_runout(eccentricity, teeth)
    if lost:
        offsets[teeth // 2] = LOST
    found = shares(arcs(teeth, *arc, lag), offsets, delay=delay)
    judge = integrated(teeth, *arc, lag, offsets, delay=delay)
    np.testing.assert_allclose(found, judge, atol=0.03)


def test_chips_of_a_revolution_are_those_of_equal_teeth() -> None:
    """With a force in proportion to the chip, whatever the runout: the feed must be cut."""
    thin = periods(
        arcs(5, 2.0, pi, 0.3), feed_per_tooth=np.full(5, 0.03), exponent=1.0, delay=0.1
    )
    guesses = 0.02 * np.random.default_rng(1).standard_normal((20, 5))
    guesses[3, 2] = LOST
    np.testing.assert_allclose(tooth_means(thin, guesses).mean(axis=1), 1.0, rtol=1e-9)


@given(shift=st.floats(-1.0, 1.0), scale=st.floats(0.2, 5.0))
def test_only_differences_of_offsets_over_the_feed_count(shift: float, scale: float) -> None:
    at, offsets = arcs(4, 1.0, pi, 0.2), np.array([0.01, -0.02, 0.005, 0.0])
    plain = shares(at, offsets)
    np.testing.assert_allclose(shares(at, offsets + shift), plain, atol=1e-9)
    scaled = shares(at, scale * offsets, feed=scale * FEED)
    np.testing.assert_allclose(scaled, plain, atol=1e-9)


def test_arcs_without_length_are_not_known() -> None:
    assert arcs(3, 1.0, 2.0, 0.0).are_known
    assert not arcs(3, 1.0, 1.0, 0.0).are_known
    some = arcs(3, 1.0, 2.0, 0.0).rows(np.array([2]))
    assert some.entry_angle.tolist() == [1.0]


@pytest.mark.parametrize("lost", [0, 1, 3])
def test_successor_of_a_lost_tooth_takes_the_double_chip(lost: int) -> None:
    """Alone in its period, linear force: the textbook's pattern."""
    offsets = np.zeros(4)
    offsets[lost] = LOST
    at = periods(arcs(4, 2.5, pi, 0.0), feed_per_tooth=np.full(4, 0.1), exponent=1.0)
    expected = np.ones(4)
    expected[lost], expected[(lost + 1) % 4] = 0.0, 2.0
    np.testing.assert_allclose(tooth_means(at, offsets[None])[0], expected, atol=1e-9)
