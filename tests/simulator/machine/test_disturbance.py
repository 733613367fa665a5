"""A run as real sensors would show it."""

from collections.abc import Callable
from dataclasses import fields
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.disturbance import FORCES, Disturbance, Disturbed
from simulator.machine.noise_kind import NoiseKind
from simulator.machine.samples import PathMode, Samples, joined
from simulator.machine.transients import Response
from simulator.motion.segments import Floats

Made = Callable[..., Samples]

SHOWN = ("axis_power", "spindle_power", "coolant_power", "base_power", *FORCES)


def run(samples_of: Made, count: int) -> Samples:
    random = np.random.default_rng(7)
    powers = {name: 100.0 + 50.0 * random.random(count) for name in (*SHOWN, "cutting_power")}
    powers["axis_power"] = 10.0 + random.random((count, 3))
    mode = np.where(np.arange(count) % 3 == 0, int(PathMode.RAPID), int(PathMode.FEED))
    return samples_of(count, path_mode=mode, **powers)


def part(samples: Samples, rows: slice) -> Samples:
    return Samples(**{each.name: getattr(samples, each.name)[rows] for each in fields(Samples)})


def shown(disturbance: Disturbance, samples: Samples, cuts: tuple[int, ...] = ()) -> Samples:
    disturbed = Disturbed(disturbance=disturbance, rate=100.0, efficiency=0.8)
    edges = (0, *sorted(cuts), len(samples))
    parts = [part(samples, slice(a, b)) for a, b in pairwise(edges)]
    return joined([disturbed.shown(each) for each in parts])


def test_none_is_the_identity(samples_of: Made) -> None:
    samples = run(samples_of, 50)
    assert Disturbance().is_none
    disturbed = Disturbed(disturbance=Disturbance(), rate=100.0, efficiency=0.8)
    assert disturbed.shown(samples) is samples


@settings(max_examples=15, deadline=None)
@given(
    cuts=st.lists(st.integers(0, 3000), max_size=4),
    noise=st.sampled_from(list(NoiseKind)),
    missing=st.sampled_from([0.0, 0.1]),
    response=st.sampled_from([None, Response(), Response(overshoot=0.0)]),
)
def test_same_seed_same_bytes_however_the_run_is_cut(
    samples_of: Made,
    cuts: list[int],
    noise: NoiseKind,
    missing: float,
    response: Response | None,
) -> None:
    samples = run(samples_of, 3000)
    disturbance = Disturbance(noise=noise, missing=missing, response=response, seed=5)
    whole, pieces = shown(disturbance, samples), shown(disturbance, samples, tuple(cuts))
    for each in fields(Samples):
        assert getattr(pieces, each.name).tobytes() == getattr(whole, each.name).tobytes()


def test_another_seed_and_another_column_draw_otherwise(samples_of: Made) -> None:
    samples = samples_of(100, **dict.fromkeys(FORCES, np.full(100, 50.0)))
    one = shown(Disturbance(noise=NoiseKind.NORMAL, seed=1), samples)
    two = shown(Disturbance(noise=NoiseKind.NORMAL, seed=2), samples)
    assert (one.cutting_force != two.cutting_force).all()
    assert (one.cutting_force != one.feed_force).all()


def test_uniform_noise_keeps_its_bounds(samples_of: Made) -> None:
    """±10 % in feed, ±5 % in rapid, all alike: deviation over √3 of the bound."""
    samples = run(samples_of, 30_000)
    found = shown(Disturbance(noise=NoiseKind.UNIFORM), samples)
    rapid = samples.path_mode == PathMode.RAPID
    for name in SHOWN:
        error: Floats = getattr(found, name) / getattr(samples, name) - 1.0
        for rows, bound in ((rapid, 0.05), (~rapid, 0.10)):
            assert np.abs(error[rows]).max() <= bound
            assert np.abs(error[rows]).max() > 0.99 * bound
            assert error[rows].std() == pytest.approx(bound / np.sqrt(3.0), rel=0.03)
            assert abs(error[rows].mean()) < 0.03 * bound


def test_normal_noise_is_three_per_cent_of_a_force_and_twenty_watts(samples_of: Made) -> None:
    samples = run(samples_of, 30_000)
    found = shown(Disturbance(noise=NoiseKind.NORMAL), samples)
    for name in FORCES:
        error = getattr(found, name) / getattr(samples, name) - 1.0
        assert error.std() == pytest.approx(0.03, rel=0.03)
    assert (found.spindle_power - samples.spindle_power).std() == pytest.approx(20.0, rel=0.03)
    np.testing.assert_array_equal(found.base_power, samples.base_power)


def test_share_of_missing_samples(samples_of: Made) -> None:
    found = shown(Disturbance(missing=0.1), run(samples_of, 30_000))
    for name in SHOWN:
        assert np.isnan(getattr(found, name)).mean() == pytest.approx(0.1, abs=0.01)
    for name in ("time", "position", "velocity", "spindle_speed", "removal_rate"):
        assert not np.isnan(getattr(found, name)).any()


def test_lag_keeps_a_constant_cut(samples_of: Made) -> None:
    constant = {name: np.full(200, 80.0) for name in (*FORCES, "cutting_power")}
    samples = samples_of(200, spindle_power=np.full(200, 300.0), **constant)
    found = shown(Disturbance(response=Response()), samples)
    for name in (*FORCES, "cutting_power"):
        np.testing.assert_allclose(getattr(found, name), 80.0)
    np.testing.assert_allclose(found.spindle_power, 300.0)


def test_lagging_power_reaches_the_mains_over_the_efficiency(samples_of: Made) -> None:
    """A step of P_c with τ 0.05 s: ``P = P_idle + P_c·(1 − e^(−t/τ))/η``."""
    load = np.where(np.arange(200) < 10, 0.0, 80.0)
    samples = samples_of(200, spindle_power=200.0 + load / 0.8, cutting_power=load)
    found = shown(Disturbance(response=Response(overshoot=0.0)), samples)
    # The step rises over one interval of 10 ms; seen from its middle it is 5 ms old.
    age = np.arange(190) / 100.0 + 0.005
    np.testing.assert_allclose(
        found.spindle_power[10:], 200.0 + 100.0 * (1.0 - np.exp(-age / 0.05)), atol=0.3
    )
    np.testing.assert_allclose(found.cutting_power[:10], 0.0)


def test_lag_leaves_what_braking_gives_back(samples_of: Made) -> None:
    braking = np.full(50, -500.0)
    found = shown(Disturbance(response=Response()), samples_of(50, spindle_power=braking))
    np.testing.assert_array_equal(found.spindle_power, braking)


def test_overshoot_does_not_feed_the_mains(samples_of: Made) -> None:
    load = np.where(np.arange(100) < 50, 1000.0, 0.0)
    samples = samples_of(100, spindle_power=10.0 + load / 0.8, cutting_power=load)
    found = shown(Disturbance(response=Response(overshoot=0.5)), samples)
    assert found.cutting_power.min() < 0.0
    assert found.spindle_power.min() == 0.0


def test_events_and_positions_stay_true(samples_of: Made) -> None:
    samples = run(samples_of, 100)
    disturbance = Disturbance(noise=NoiseKind.UNIFORM, missing=0.2, response=Response())
    found = shown(disturbance, samples)
    changed = {*SHOWN, "cutting_power"}
    for each in fields(Samples):
        if each.name not in changed:
            np.testing.assert_array_equal(
                getattr(found, each.name), getattr(samples, each.name)
            )
