"""Delay and overshoot of a drive, the first revolution, runout."""

from math import exp, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.transients import (
    Follower,
    Response,
    entry_share,
)

LAG = Response(delay=0.05, overshoot=0.0)
SWINGING = Response(delay=0.05, overshoot=0.2)


def test_a_lag_follows_a_ramp_as_in_closed_form() -> None:
    """``y = t − τ·(1 − e^(−t/τ))`` for u = t."""
    time = np.linspace(0.0, 0.8, 201)
    shown = Follower(LAG, 0.004).follow(time)
    np.testing.assert_allclose(shown, time - 0.05 * (1.0 - np.exp(-time / 0.05)), atol=1e-12)


@pytest.mark.parametrize("interval", [1e-4, 0.01, 0.1])
def test_a_step_overshoots_by_its_share(interval: float) -> None:
    """A step that rises over one interval: the response to a sharp one,
    ``1 − e^(−ζωt)·(cos ω_d t + ζ/√(1−ζ²)·sin ω_d t)``, in its mean over that interval."""
    damping = SWINGING.damping
    frequency = 2.0 * damping / 0.05
    damped = frequency * sqrt(1.0 - damping**2)
    load = np.ones(round(2.0 / interval))
    load[0] = 0.0
    shown = Follower(SWINGING, interval).follow(load)
    assert shown[0] == 0.0
    assert shown[-1] == pytest.approx(1.0, abs=1e-6)

    def risen(time: float) -> float:
        """Integral of the step response, by Simpson's rule."""
        t = np.linspace(0.0, time, 20001)
        y = 1.0 - np.exp(-damping * frequency * t) * (
            np.cos(damped * t) + damping / sqrt(1.0 - damping**2) * np.sin(damped * t)
        )
        weights = np.ones(len(t))
        weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
        return float(weights @ y * t[1] / 3.0)

    for row in (1, 3, 10):
        expected = (risen(row * interval) - risen((row - 1) * interval)) / interval
        assert shown[row] == pytest.approx(expected, abs=1e-9)
    if interval < 0.001:
        assert shown.max() == pytest.approx(1.2, abs=1e-4)


def test_damping_gives_its_overshoot() -> None:
    damping = Response(overshoot=0.16).damping
    assert damping == pytest.approx(0.5, abs=0.005)
    assert exp(-pi * damping / sqrt(1.0 - damping**2)) == pytest.approx(0.16)
    assert Response(overshoot=0.91).damping == pytest.approx(0.03, abs=0.001)


@pytest.mark.parametrize("response", [LAG, SWINGING])
def test_the_mean_delay_is_that_of_the_response(response: Response) -> None:
    """Behind a long ramp the drive stays by its delay."""
    time = np.linspace(0.0, 3.0, 3001)
    assert time[-1] - Follower(response, 0.001).follow(time)[-1] == pytest.approx(0.05)


@settings(max_examples=20, deadline=None)
@given(
    cuts=st.lists(st.integers(0, 60), max_size=5),
    response=st.sampled_from([LAG, SWINGING, Response(delay=0.0)]),
)
def test_chunks_do_not_matter(cuts: list[int], response: Response) -> None:
    load = np.sin(np.arange(60.0) ** 1.3)
    whole = Follower(response, 0.01).follow(load)
    follower = Follower(response, 0.01)
    parts = [follower.follow(part) for part in np.split(load, sorted(cuts))]
    np.testing.assert_array_equal(np.concatenate(parts), whole)


def test_a_constant_load_is_shown_as_it_is() -> None:
    for response in (LAG, SWINGING, Response(delay=0.0)):
        shown = Follower(response, 1e-7).follow(np.full(5, 321.0))
        np.testing.assert_allclose(shown, 321.0, rtol=1e-12)


def test_figures_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="delay of a drive -1 s"):
        Response(delay=-1.0)
    with pytest.raises(ValueError, match="overshoot 1 must be"):
        Response(overshoot=1.0)
    with pytest.raises(ValueError, match="interval 0 s"):
        Follower(LAG, 0.0)


def test_the_chip_grows_in_the_first_revolution() -> None:
    revolutions = np.array([-1.0, 0.0, 0.25, 1.0, 7.0])
    assert entry_share(revolutions).tolist() == [0.0, 0.0, 0.25, 1.0, 1.0]
