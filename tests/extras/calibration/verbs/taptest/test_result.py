"""A tap test as people read it."""

import json

from extras.calibration.model.modal_fit import FittedMode, ModalFit
from extras.calibration.verbs.taptest.result import TapTestResult
from simulator.spec import ModeDirection, VibratingPart, VibrationMode
from stepnc_model.errors import Finding, Severity

RESULT = TapTestResult(
    modes=(
        VibrationMode(
            part=VibratingPart.TOOL,
            tool="MILL",
            direction=ModeDirection.X,
            natural_frequency=922.0,
            damping_ratio=0.011,
            stiffness=1_340.0,
            source="bench",
        ),
    ),
    fit=ModalFit(
        modes=(FittedMode(natural_frequency=922.0, damping_ratio=0.011, stiffness=1_340.0),),
        residual=0.011,
        unexplained=0.25,
    ),
    findings=(Finding(severity=Severity.WARNING, message="look at it"),),
)


def test_modes_and_what_they_leave_are_printed() -> None:
    printed = str(RESULT)
    assert "x          922           0.011          1.34" in printed
    assert "unexplained: 25.0% of the response, 1.1% after adding residues" in printed
    assert 'stiffness_n_um = 1.34\nsource = "bench"' in printed
    assert "warning: look at it" in printed


def test_json_says_the_same() -> None:
    found = json.loads(json.dumps(RESULT.record()))
    assert found["modes"][0]["frequency_hz"] == 922.0
    assert (found["residual"], found["unexplained"]) == (0.011, 0.25)
    assert found["findings"][0]["message"] == "look at it"
