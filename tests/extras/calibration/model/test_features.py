"""The linear power model against the machine's own, which is written apart from it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from extras.calibration.model.features import (
    PARAMETERS,
    UNITS,
    Parameter,
    RunFeatures,
    design,
    powers,
    slopes,
)
from extras.calibration.model.measured_run import Component
from simulator.physics.axis import axis_power
from simulator.physics.spindle import spindle_power
from simulator.spec import AxisDrive, Spindle, SpindlePoint

EFFICIENCY = 0.8
SPINDLE = Spindle(
    curve=(SpindlePoint(speed=1.0, power=7500.0),),
    efficiency=EFFICIENCY,
    min_speed=None,
    max_speed=None,
    acceleration=None,
    inertia=0.02,
    idle_power=150.0,
    idle_power_per_speed=4.0,
    idle_power_per_speed_squared=0.02,
)
# Lead 2π mm: a radian of the screw is a millimetre.
DRIVE = AxisDrive(
    lead=2.0 * np.pi, table_mass=80.0, guide_friction=0.1, viscous=2.0, efficiency=0.9
)


def run(speed: float, ramp: float, velocity: float, push: float) -> RunFeatures:
    return RunFeatures(
        name="one",
        duration=np.ones(1),
        spindle_speed=np.array([speed]),
        spindle_acceleration=np.array([ramp]),
        velocity=np.array([[velocity, 0.0, 0.0]]),
        acceleration=np.array([[push, 0.0, 0.0]]),
        cutting_power=np.array([60.0]),
        coolant=np.array([1.0]),
        measured={},
    )


def values(**known: float) -> np.typing.NDArray[np.float64]:
    return np.array([known.get(parameter.name, 0.0) for parameter in PARAMETERS])


@settings(max_examples=25)
@given(speed=st.floats(-80.0, 80.0), ramp=st.floats(-100.0, 100.0))
def test_spindle_is_that_of_the_machine(speed: float, ramp: float) -> None:
    table = design(run(speed, ramp, 0.0, 0.0), efficiency=EFFICIENCY)
    found = powers(
        table,
        values(
            IDLE=150.0,
            IDLE_PER_SPEED=4.0,
            IDLE_PER_SPEED_SQUARED=0.02,
            INERTIA=0.02,
            CUTTING=1.3,
        ),
    )
    expected = spindle_power(SPINDLE, speed, ramp, cutting_power=1.3 * 60.0)
    assert found[Component.SPINDLE][0] == pytest.approx(expected)


@settings(max_examples=25)
@given(velocity=st.floats(-300.0, 300.0), push=st.floats(-3000.0, 3000.0))
def test_axis_is_that_of_the_machine(velocity: float, push: float) -> None:
    table = design(run(0.0, 0.0, velocity, push), efficiency=EFFICIENCY)
    mains = values(FRICTION_X=0.1 * 80.0 * 9.81 / 0.9, VISCOUS_X=2.0 / 0.9, MASS_X=80.0 / 0.9)
    expected = axis_power(DRIVE, velocity, push)
    assert powers(table, mains)[Component.X][0] == pytest.approx(expected, abs=1e-9)


def test_total_is_the_sum() -> None:
    table = design(run(50.0, 0.0, 100.0, 0.0), efficiency=EFFICIENCY)
    watts = powers(table, values(BASE=300.0, COOLANT=200.0, IDLE=100.0, FRICTION_X=500.0))
    assert watts[Component.TOTAL][0] == pytest.approx(300.0 + 200.0 + 100.0 + 50.0)


def test_slopes_are_those_of_the_powers() -> None:
    table = design(run(40.0, 20.0, 80.0, -400.0), efficiency=EFFICIENCY)
    here = values(BASE=300.0, COOLANT=9.0, IDLE=100.0, FRICTION_X=500.0, MASS_X=60.0)
    for column in range(len(PARAMETERS)):
        step = np.zeros(len(PARAMETERS))
        step[column] = 1e-4
        rise = (
            powers(table, here + step)[Component.TOTAL]
            - powers(table, here - step)[Component.TOTAL]
        )
        assert slopes(table, here)[Component.TOTAL][0, column] == pytest.approx(
            rise[0] / 2e-4, abs=1e-6
        )


def test_every_parameter_has_a_unit() -> None:
    assert set(UNITS) == set(Parameter)
