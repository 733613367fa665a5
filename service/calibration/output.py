"""Results of ``calibrate`` as text and JSON; JSON keys carry their units and never change."""

from collections.abc import Callable
from math import isfinite

from service.calibration.run import CalibrationResult, CycleTime
from service.rendering.columns import Cell, Column
from service.rendering.records import dump, finding_record, record, records
from service.rendering.text import print_findings, print_line, print_table
from simulator.calibration.calibrated import Delay
from simulator.calibration.features import Estimate
from simulator.calibration.measured_run import Component
from simulator.calibration.skill import Skill

CUTS = {Component.SPINDLE, Component.TOTAL}
"""Power components that include the cutting power."""

MOST_NET = 10.0
"""Relative error above which a net cutting energy is not shown, because noise dominates it."""

HeldSkill = tuple[str, Component, Skill]
"""Run, power component, and quality of its prediction."""


def _of(value: Callable[[Skill], Cell]) -> Callable[[HeldSkill], Cell]:
    return lambda held: value(held[2])


def _net(held: HeldSkill) -> str:
    """Relative error of the net cutting energy, for power components that include it."""
    _, part, skill = held
    if part not in CUTS:
        return ""
    return f"{skill.net_error:+.1%}" if abs(skill.net_error) < MOST_NET else "not measurable"


PARAMETERS: tuple[Column[Estimate], ...] = (
    Column(key="parameter", heading="parameter", value=lambda each: each.parameter.value),
    Column(
        heading="value",
        value=lambda each: (
            f"{each.value:.4g} {each.unit}".strip() + ("" if each.is_identified else " kept")
        ),
    ),
    Column(
        heading="95 % interval",
        value=lambda each: f"{each.low:.4g} to {each.high:.4g}" if each.is_identified else "",
    ),
    Column(
        heading="identified",
        value=lambda each: "yes" if each.is_identified else f"no: {each.reason}",
    ),
    Column(key="unit", value=lambda each: each.unit),
    Column(key="value", value=lambda each: each.value),
    Column(key="low", value=lambda each: each.low),
    Column(key="high", value=lambda each: each.high),
    Column(key="is_identified", value=lambda each: each.is_identified),
    Column(key="reason", value=lambda each: each.reason),
)

DELAY: tuple[Column[Delay], ...] = (
    Column(key="value_s", value=lambda delay: delay.value),
    Column(key="low_s", value=lambda delay: delay.low),
    Column(key="high_s", value=lambda delay: delay.high),
    Column(key="is_identified", value=lambda delay: not delay.reason),
    Column(key="reason", value=lambda delay: delay.reason),
)

TIMES: tuple[Column[CycleTime], ...] = (
    Column(key="run", heading="run", value=lambda time: time.name),
    Column(
        key="measured_s", heading="measured s", form=".1f", value=lambda time: time.measured
    ),
    Column(
        key="simulated_s", heading="simulated s", form=".1f", value=lambda time: time.simulated
    ),
    Column(heading="error", form="+.2%", value=lambda time: time.error),
)

SKILLS: tuple[Column[HeldSkill], ...] = (
    Column(key="run", heading="run", value=lambda held: held[0]),
    Column(key="power", heading="power", value=lambda held: held[1].value),
    Column(
        key="rmse_w", heading="RMSE W", form=".1f", value=_of(lambda skill: skill.model_rmse)
    ),
    Column(
        key="baseline_rmse_w", heading="baseline", form=".1f",
        value=_of(lambda skill: skill.baseline_rmse),
    ),
    Column(key="measured_energy_j", value=_of(lambda skill: skill.measured_energy)),
    Column(
        key="energy_error", heading="energy", form="+.2%",
        value=_of(lambda skill: skill.energy_error),
    ),
    Column(
        key="baseline_energy_error", heading="baseline", form="+.2%",
        value=_of(lambda skill: skill.baseline_energy_error),
    ),
    Column(
        key="energy_skill", heading="skill", form=".2f",
        value=_of(lambda skill: skill.energy_skill),
    ),
    Column(heading="cutting energy", value=_net),
    Column(
        key="measured_net_cutting_energy_j", value=_of(lambda skill: skill.measured_net)
    ),
    Column(key="net_cutting_energy_j", value=_of(lambda skill: skill.model_net)),
)  # fmt: skip


def _held(result: CalibrationResult) -> list[HeldSkill]:
    return [
        (held.name, part, skill)
        for held in result.held_out
        for part, skill in held.skills.items()
    ]


def print_calibration(result: CalibrationResult) -> None:
    """Print parameters, cycle times, and prediction errors on data that were not fitted."""
    print_line(f"machine {result.machine.name} ({result.machine.title})")
    print_table(PARAMETERS, result.calibration.estimates, foot=_delay(result.delay))
    print_line("")
    print_table(TIMES, result.times)
    print_line("")
    print_line(
        "prediction error on data that were not fitted: each run with the others fitted, or the"
    )
    print_line(
        "end of a single run with its start fitted; baseline: mean fitted power times the time"
    )
    print_table(SKILLS, _held(result))
    factor = result.kc_factor
    if factor is not None:
        print_line(
            f"the k_c factor is not part of the machine: simulate with --kc-factor {factor:.3g}"
        )
    print_findings(result.findings)


def _delay(delay: Delay) -> dict[str, str]:
    """Return the delay of the main drive as a row of the parameter table."""
    return {
        "parameter": "delay of the main drive",
        "value": "" if delay.reason else f"{delay.value:.4g} s",
        "95 % interval": f"{delay.low:.4g} to {delay.high:.4g}" if isfinite(delay.high) else "",
        "identified": f"no: {delay.reason}" if delay.reason else "yes",
    }


def calibration_json(result: CalibrationResult) -> str:
    """Return parameters, cycle times, and prediction errors on unfitted data as JSON."""
    return dump({
        "machine": result.machine.name,
        "parameters": records(PARAMETERS, result.calibration.estimates),
        "drive_delay": record(DELAY, result.delay),
        "cycle_times": records(TIMES, result.times),
        "held_out": records(SKILLS, _held(result)),
        "findings": [finding_record(finding) for finding in result.findings],
    })
