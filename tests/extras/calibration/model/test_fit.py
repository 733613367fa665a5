"""Parameters recovered from synthetic runs, and named where the runs cannot tell them."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from extras.calibration.model.features import (
    PARAMETERS,
    Calibration,
    Estimate,
    Parameter,
    ParameterPrior,
    RunFeatures,
    design,
    powers,
)
from extras.calibration.model.fit import fitted
from extras.calibration.model.measured_run import Component
from simulator.errors import CalibrationError

EFFICIENCY = 0.85
TRUTH = {
    Parameter.BASE: 420.0,
    Parameter.IDLE: 130.0,
    Parameter.IDLE_PER_SPEED: 3.5,
    Parameter.INERTIA: 0.015,
    Parameter.CUTTING: 1.2,
    Parameter.FRICTION_X: 350.0,
    Parameter.VISCOUS_X: 1.5,
    Parameter.MASS_X: 120.0,
}
PRIORS = {name: ParameterPrior(value=0.0, scale=200.0) for name in Parameter} | {
    Parameter.CUTTING: ParameterPrior(value=1.0, scale=0.5),
    Parameter.INERTIA: ParameterPrior(value=0.0, scale=0.02),
    Parameter.IDLE_PER_SPEED: ParameterPrior(value=0.0, scale=5.0),
    Parameter.IDLE_PER_SPEED_SQUARED: ParameterPrior(value=0.0, scale=0.0005),
    Parameter.VISCOUS_X: ParameterPrior(value=0.0, scale=3.0),
}
ALL = tuple(part for part in Component if part is not Component.TOTAL)
NOISE = 8.0  # W


def run(seed: int, parts: tuple[Component, ...], *, speeds: tuple[float, ...]) -> RunFeatures:
    """A minute at 10 Hz: ramps, feeds back and forth along X, cuts now and then."""
    random = np.random.default_rng(seed)
    count = 600
    time = 0.1 * np.arange(count)
    speed = np.interp(time, np.linspace(1.0, 59.0, len(speeds)), speeds)
    velocity = np.zeros((count, 3))
    velocity[:, 0] = 150.0 * np.sin(0.7 * time) + 40.0 * np.sin(2.3 * time)
    bare = RunFeatures(
        name=f"run {seed}",
        duration=np.full(count, 0.1),
        spindle_speed=speed,
        spindle_acceleration=np.gradient(speed, time),
        velocity=velocity,
        acceleration=np.asarray(np.gradient(velocity, time, axis=0)),
        cutting_power=np.where(np.sin(0.3 * time) > 0.0, 400.0, 0.0),
        coolant=np.zeros(count),
        measured={},
    )
    values = np.array([TRUTH.get(name, 0.0) for name in PARAMETERS])
    watts = powers(design(bare, efficiency=EFFICIENCY), values)
    return RunFeatures(
        name=bare.name,
        duration=bare.duration,
        spindle_speed=bare.spindle_speed,
        spindle_acceleration=bare.spindle_acceleration,
        velocity=bare.velocity,
        acceleration=bare.acceleration,
        cutting_power=bare.cutting_power,
        coolant=bare.coolant,
        measured={part: watts[part] + random.normal(0.0, NOISE, count) for part in parts},
    )


def by_name(calibration: Calibration) -> Mapping[Parameter, Estimate]:
    return {each.parameter: each for each in calibration.estimates}


VARIED = (0.0, 0.0, 60.0, 20.0, 90.0, 90.0, 10.0, 70.0, 0.0)


@pytest.fixture(scope="module")
def by_total() -> Mapping[Parameter, Estimate]:
    runs = [run(seed, (Component.TOTAL,), speeds=VARIED) for seed in (3, 4)]
    return by_name(fitted(runs, PRIORS, efficiency=EFFICIENCY))


@pytest.mark.parametrize("parts", [ALL, (Component.TOTAL,)])
def test_intervals_hold_the_truth_as_often_as_they_say(parts: tuple[Component, ...]) -> None:
    held = []
    for seed in range(20, 30):
        found = by_name(
            fitted([run(seed, parts, speeds=VARIED)], PRIORS, efficiency=EFFICIENCY)
        )
        assert all(found[name].is_identified for name in TRUTH)
        held += [found[name].low <= TRUTH[name] <= found[name].high for name in TRUTH]
    # 80 intervals of 95 %: fewer than 70 would come once in a thousand times.
    assert sum(held) >= 70


@pytest.mark.parametrize("parameter", list(TRUTH))
def test_known_parameters_are_found(
    by_total: Mapping[Parameter, Estimate], parameter: Parameter
) -> None:
    found = by_total[parameter]
    half = 0.5 * (found.high - found.low)
    assert found.is_identified
    assert abs(found.value - TRUTH[parameter]) < 2.0 * half
    assert half < 0.5 * TRUTH[parameter]


@pytest.mark.parametrize(
    "parameter", [Parameter.COOLANT, Parameter.FRICTION_Y, Parameter.MASS_Z]
)
def test_what_no_sample_depends_on_is_named_and_kept(
    by_total: Mapping[Parameter, Estimate], parameter: Parameter
) -> None:
    assert by_total[parameter].reason == "no measured power depends on it"
    assert by_total[parameter].value == PRIORS[parameter].value


def test_one_spindle_speed_cannot_tell_idle_from_idle_per_speed() -> None:
    steady = run(5, (Component.SPINDLE,), speeds=(50.0, 50.0))
    found = by_name(fitted([steady], PRIORS, efficiency=EFFICIENCY))
    lost = [
        name
        for name in (Parameter.IDLE, Parameter.IDLE_PER_SPEED)
        if not found[name].is_identified
    ]
    assert len(lost) == 1
    other = ({Parameter.IDLE, Parameter.IDLE_PER_SPEED} - set(lost)).pop()
    assert str(other) in found[lost[0]].reason
    idle = found[Parameter.IDLE].value + 50.0 * found[Parameter.IDLE_PER_SPEED].value
    assert idle == pytest.approx(130.0 + 50.0 * 3.5, rel=0.02)
    # What is constant in time has no ramp either.
    assert not found[Parameter.INERTIA].is_identified


def test_base_cannot_be_told_from_a_spindle_that_never_stops() -> None:
    steady = run(6, (Component.TOTAL,), speeds=(50.0, 50.0))
    found = by_name(fitted([steady], PRIORS, efficiency=EFFICIENCY))
    trio = (Parameter.BASE, Parameter.IDLE, Parameter.IDLE_PER_SPEED)
    assert sum(not found[name].is_identified for name in trio) == 2


def test_small_cut_under_much_noise_keeps_the_prior() -> None:
    loud = run(7, ALL, speeds=VARIED)
    faint = RunFeatures(
        name="faint",
        duration=loud.duration,
        spindle_speed=loud.spindle_speed,
        spindle_acceleration=loud.spindle_acceleration,
        velocity=loud.velocity,
        acceleration=loud.acceleration,
        cutting_power=loud.cutting_power / 2000.0,
        coolant=loud.coolant,
        measured=loud.measured,
    )
    found = by_name(fitted([faint], PRIORS, efficiency=EFFICIENCY))[Parameter.CUTTING]
    assert not found.is_identified
    assert found.value == 1.0


def test_outliers_hardly_move_the_fit() -> None:
    clean = run(8, ALL, speeds=VARIED)
    spoilt = clean.measured[Component.SPINDLE].copy()
    spoilt[::50] += 5000.0
    noisy = RunFeatures(
        name="spoilt",
        duration=clean.duration,
        spindle_speed=clean.spindle_speed,
        spindle_acceleration=clean.spindle_acceleration,
        velocity=clean.velocity,
        acceleration=clean.acceleration,
        cutting_power=clean.cutting_power,
        coolant=clean.coolant,
        measured={**clean.measured, Component.SPINDLE: spoilt},
    )
    found = by_name(fitted([noisy], PRIORS, efficiency=EFFICIENCY))
    assert found[Parameter.IDLE_PER_SPEED].value == pytest.approx(3.5, rel=0.05)


def test_noise_is_found_by_component() -> None:
    found = fitted([run(9, ALL, speeds=VARIED)], PRIORS, efficiency=EFFICIENCY)
    assert found.noise[Component.SPINDLE] == pytest.approx(NOISE, rel=0.1)


def test_an_axis_that_stands_all_the_time_hinders_no_fit() -> None:
    moving = run(5, ALL, speeds=VARIED)
    standing = {**moving.measured, Component.Y: np.zeros(len(moving))}
    found = by_name(fitted([replace(moving, measured=standing)], PRIORS, efficiency=EFFICIENCY))
    assert found[Parameter.BASE].value == pytest.approx(TRUTH[Parameter.BASE], rel=0.05)
    assert not found[Parameter.FRICTION_Y].is_identified


def test_run_without_a_power_is_refused() -> None:
    with pytest.raises(CalibrationError, match="no measured power"):
        fitted([run(10, (), speeds=VARIED)], PRIORS, efficiency=EFFICIENCY)
