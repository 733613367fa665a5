"""A machine that was calibrated draws what was found."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from extras.calibration.model.calibrated_machine import Delay, calibrated, notes, priors
from extras.calibration.model.features import PARAMETERS, Calibration, Estimate, Parameter
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from simulator.physics.axis import axis_power
from simulator.physics.spindle import spindle_power
from simulator.spec import AxisDrive, Machine

FOUND = {
    Parameter.BASE: 900.0,
    Parameter.IDLE: 200.0,
    Parameter.IDLE_PER_SPEED: 6.0,
    Parameter.INERTIA: 0.03,
    Parameter.FRICTION_X: 400.0,
    Parameter.VISCOUS_X: 2.0,
    Parameter.MASS_X: 150.0,
}

NO_DELAY = Delay(value=0.0, low=0.0, high=0.0, reason="shorter than these samples can show")
DELAY = Delay(value=0.08, low=0.07, high=0.09)


def machine() -> Machine:
    return load_machine("vmc15")


def calibration(before: Machine) -> Calibration:
    known = priors(before)
    return Calibration(
        estimates=tuple(
            Estimate(parameter=name, value=FOUND[name], low=0.0, high=2.0 * FOUND[name])
            if name in FOUND
            else Estimate(
                parameter=name, value=known[name].value, low=0.0, high=1.0, reason="too small"
            )
            for name in PARAMETERS
        ),
        noise={},
        blocks=1,
    )


def test_found_values_are_in_the_machine_and_others_stay() -> None:
    before = machine()
    after = calibrated(before, calibration(before), NO_DELAY)
    assert after.base_power == 900.0
    assert after.coolant_power == before.coolant_power
    assert after.spindle.inertia == 0.03
    assert after.axes[2] == before.axes[2]
    idle = spindle_power(after.spindle, 50.0)
    assert idle == pytest.approx(
        200.0 + 6.0 * 50.0 + before.spindle.idle_power_per_speed_squared * 50.0**2
    )


@pytest.mark.parametrize(
    "drive", [None, AxisDrive(lead=16.0, table_mass=300.0, efficiency=0.8)]
)
def test_axis_draws_the_power_that_was_found(drive: AxisDrive | None) -> None:
    before = machine()
    before = replace(before, axes=(replace(before.axes[0], drive=drive), *before.axes[1:]))
    after = calibrated(before, calibration(before), NO_DELAY).axes[0].drive
    assert after is not None
    for velocity, push in ((100.0, 0.0), (-100.0, 0.0), (200.0, 1000.0)):
        expected = (400.0 * abs(velocity) + 2.0 * velocity**2) / 1e3
        expected += 150.0 * velocity * push / 1e6
        assert axis_power(after, velocity, push) == pytest.approx(expected)


def test_priors_are_those_of_the_file() -> None:
    drive = AxisDrive(
        lead=10.0, table_mass=100.0, guide_friction=0.1, viscous=3.0, efficiency=0.9
    )
    before = machine()
    before = replace(before, axes=(replace(before.axes[0], drive=drive), *before.axes[1:]))
    known = priors(before)
    assert set(known) == set(Parameter)
    assert known[Parameter.IDLE].value == before.spindle.idle_power
    friction, viscous, mass = (
        known[name].value
        for name in (Parameter.FRICTION_X, Parameter.VISCOUS_X, Parameter.MASS_X)
    )
    expected = axis_power(drive, 80.0, 500.0)
    found = (friction * 80.0 + viscous * 80.0**2) / 1e3 + mass * 80.0 * 500.0 / 1e6
    assert found == pytest.approx(expected)


def test_machine_file_reads_back(tmp_path: Path) -> None:
    before = machine()
    found = calibration(before)
    after = calibrated(before, found, DELAY)
    path = tmp_path / "mine.toml"
    path.write_text(machine_toml(after, notes=notes(found, DELAY)), encoding="utf-8")
    again = load_machine(str(path))
    drives = [each.axes[0].drive for each in (after, again)]
    powers = [axis_power(drive, 120.0, 700.0) for drive in drives if drive is not None]
    np.testing.assert_allclose(powers[0], powers[1])
    assert "kept at" in path.read_text(encoding="utf-8")
