"""A calibration, made by hand."""

from math import inf

import pytest

from extras.calibration.model.calibrated_machine import Delay
from extras.calibration.model.features import Calibration, Estimate, Parameter
from extras.calibration.model.fit import HeldOut
from extras.calibration.model.measured_run import Component
from extras.calibration.model.simulated_features import Skill
from extras.calibration.verbs.calibrate.result import CalibrationResult, CycleTime
from simulator.library import load_machine
from stepnc_model.errors import Finding, Severity


@pytest.fixture(scope="session")
def calibration() -> CalibrationResult:
    """A run that cut nothing and held no coolant: open ends, and shares of no energy."""
    estimates = (
        Estimate(parameter=Parameter.BASE, value=1200.0, low=1190.0, high=1210.0),
        Estimate(
            parameter=Parameter.CUTTING, value=1.0, low=0.0, high=inf, reason="nothing was cut"
        ),
    )
    none = Skill(
        measured_energy=0.0, model_energy=1.0, baseline_energy=1.0, model_rmse=2.0,
        baseline_rmse=4.0, measured_net=0.0, model_net=0.0,
    )  # fmt: skip
    some = Skill(
        measured_energy=1000.0, model_energy=1010.0, baseline_energy=1100.0, model_rmse=2.0,
        baseline_rmse=4.0, measured_net=100.0, model_net=103.0,
    )  # fmt: skip
    skills = {Component.COOLANT: none, Component.SPINDLE: some, Component.TOTAL: none}
    return CalibrationResult(
        machine=load_machine("vmc15"),
        calibration=Calibration(estimates=estimates, noise={}, blocks=4),
        delay=Delay(value=0.0, low=0.0, high=inf, reason="no spindle or total power"),
        held_out=(HeldOut(name="run", skills=skills),),
        times=(CycleTime(name="run", measured=100.0, simulated=101.0),),
        findings=(Finding(severity=Severity.WARNING, message="gap of 2 s", line=7),),
    )
