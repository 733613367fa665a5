"""A calibration as JSON. Keys carry their units and are fixed: others parse them."""

from math import isfinite
from typing import Any

from service.calibration.run import CalibrationResult
from service.wire import dump, finding_json
from simulator.calibration.delay import Delay
from simulator.calibration.estimates import Estimate
from simulator.calibration.skill import Skill


def calibration_json(result: CalibrationResult) -> str:
    """Parameters, cycle times, and errors on what was not fitted beside the baseline's."""
    return dump({
        "machine": result.machine.name,
        "parameters": [_estimate(each) for each in result.calibration.estimates],
        "drive_delay": _delay(result.delay),
        "cycle_times": [
            {"run": time.name, "measured_s": time.measured, "simulated_s": time.simulated}
            for time in result.times
        ],
        "held_out": [
            {"run": held.name, "power": part.value, **_skill(skill)}
            for held in result.held_out
            for part, skill in held.skills.items()
        ],
        "findings": [finding_json(finding) for finding in result.findings],
    })


def _estimate(each: Estimate) -> dict[str, Any]:
    return {
        "parameter": each.parameter.value,
        "unit": each.unit,
        "value": each.value,
        "low": _finite(each.low),
        "high": _finite(each.high),
        "is_identified": each.is_identified,
        "reason": each.reason,
    }


def _delay(delay: Delay) -> dict[str, Any]:
    return {
        "value_s": delay.value,
        "low_s": _finite(delay.low),
        "high_s": _finite(delay.high),
        "is_identified": not delay.reason,
        "reason": delay.reason,
    }


def _skill(skill: Skill) -> dict[str, Any]:
    return {
        "rmse_w": skill.model_rmse,
        "baseline_rmse_w": skill.baseline_rmse,
        "measured_energy_j": skill.measured_energy,
        "energy_error": _finite(skill.energy_error),
        "baseline_energy_error": _finite(skill.baseline_energy_error),
        "energy_skill": _finite(skill.energy_skill),
        "measured_net_cutting_energy_j": skill.measured_net,
        "net_cutting_energy_j": skill.model_net,
    }


def _finite(number: float) -> float | None:
    """The number, or nothing: an open end, or a share of nothing."""
    return number if isfinite(number) else None
