"""What ``calibrate`` found, as tables on a terminal."""

from math import isfinite

from service.calibration.run import CalibrationResult
from service.tables import print_findings, print_line, print_table
from simulator.calibration.delay import Delay
from simulator.calibration.estimates import Estimate
from simulator.calibration.measured_run import Component
from simulator.calibration.skill import Skill

CUTS = {Component.SPINDLE, Component.TOTAL}
"""powers that hold that of the cut"""

MOST_NET = 10.0
"""share of error from which a net cutting energy is lost in the noise"""


def print_calibration(result: CalibrationResult) -> None:
    """Parameters, cycle times, and errors on what was not fitted beside the baseline's."""
    print_line(f"machine {result.machine.name} ({result.machine.title})")
    found = [_estimate_row(each) for each in result.calibration.estimates]
    found.append(_delay_row(result.delay))
    print_table(("parameter", "value", "95 % interval", "identified"), found)
    print_line("")
    times = [
        (time.name, f"{time.measured:.1f}", f"{time.simulated:.1f}", f"{time.error:+.2%}")
        for time in result.times
    ]
    print_table(("run", "measured s", "simulated s", "error"), times)
    print_line("")
    print_line(
        "error on what was not fitted: of each run when the others are fitted, of a single"
    )
    print_line(
        "run's end when its start is; baseline: mean power of what was fitted times the time"
    )
    errors = [
        (held.name, part.value, *_skill_row(part, skill))
        for held in result.held_out
        for part, skill in held.skills.items()
    ]
    header = (
        "run", "power", "RMSE W", "baseline", "energy", "baseline", "skill", "cutting energy",
    )  # fmt: skip
    print_table(header, errors)
    factor = result.kc_factor
    if factor is not None:
        print_line(
            f"the factor on k_c is no part of a machine: simulate with --kc-factor {factor:.3g}"
        )
    print_findings(result.findings)


def _estimate_row(each: Estimate) -> tuple[str, str, str, str]:
    value = f"{each.value:.4g} {each.unit}".strip()
    if not each.is_identified:
        return each.parameter.value, f"{value} kept", "", f"no: {each.reason}"
    return each.parameter.value, value, f"{each.low:.4g} to {each.high:.4g}", "yes"


def _delay_row(delay: Delay) -> tuple[str, str, str, str]:
    span = f"{delay.low:.4g} to {delay.high:.4g}" if isfinite(delay.high) else ""
    if delay.reason:
        return "delay of the main drive", "", span, f"no: {delay.reason}"
    return "delay of the main drive", f"{delay.value:.4g} s", span, "yes"


def _skill_row(part: Component, skill: Skill) -> tuple[str, ...]:
    net = ""
    if part in CUTS:
        net = f"{skill.net_error:+.1%}" if abs(skill.net_error) < MOST_NET else "none to tell"
    return (
        f"{skill.model_rmse:.1f}",
        f"{skill.baseline_rmse:.1f}",
        _finite(skill.energy_error, "+.2%"),
        _finite(skill.baseline_energy_error, "+.2%"),
        _finite(skill.energy_skill, ".2f"),
        net,
    )


def _finite(number: float, form: str) -> str:
    """The number, or nothing: it is a share of no energy."""
    return format(number, form) if isfinite(number) else ""
