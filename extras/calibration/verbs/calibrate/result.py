"""Result of ``calibrate``: parameters, cycle times, and errors on data that were not fitted."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite

from extras.calibration.model.calibrated_machine import Delay
from extras.calibration.model.features import Calibration, Estimate, Parameter
from extras.calibration.model.fit import HeldOut
from extras.calibration.model.measured_run import Component
from extras.calibration.model.simulated_features import Skill
from service.rendering.columns import Cell, Column, record
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.verbs.result import Result
from simulator.spec import Machine
from stepnc_model.errors import Finding

CUTS = {Component.SPINDLE, Component.TOTAL}
"""Power components that include the cutting power."""

MOST_NET = 10.0
"""Relative error above which a net cutting energy is not shown, because noise dominates it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleTime:
    """Time of one run, measured and simulated."""

    name: str
    measured: float
    """Measured time, in s."""
    simulated: float
    """Simulated time, in s."""

    @property
    def error(self) -> float:
        """Relative error of the simulated time; positive if it is longer."""
        return self.simulated / self.measured - 1.0


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


PREDICTION = (
    "prediction error on data that were not fitted: each run with the others fitted, or the",
    "end of a single run with its start fitted; baseline: mean fitted power times the time",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationResult(Result):
    """Result of ``calibrate``."""

    machine: Machine
    """Calibrated machine."""
    calibration: Calibration
    delay: Delay
    """Delay of the main drive."""
    held_out: tuple[HeldOut, ...]
    times: tuple[CycleTime, ...]
    findings: tuple[Finding, ...]

    @property
    def kc_factor(self) -> float | None:
        """Factor on the specific cutting force; None if the runs do not determine it."""
        (found,) = (
            each for each in self.calibration.estimates if each.parameter is Parameter.CUTTING
        )
        return found.value if found.is_identified else None

    def view(self) -> ResultView:
        """Return parameters, cycle times, and prediction errors on unfitted data."""
        machine = self.machine
        held = [
            (each.name, part, skill)
            for each in self.held_out
            for part, skill in each.skills.items()
        ]
        return ResultView([
            TextLine(text=f"machine {machine.name} ({machine.title})"),
            Fact(key="machine", value=machine.name),
            Table(
                key="parameters", columns=PARAMETERS, rows=self.calibration.estimates,
                foot=_delay(self.delay),
            ),
            Fact(key="drive_delay", value=record(DELAY, self.delay)),
            TextLine(text=""),
            Table(key="cycle_times", columns=TIMES, rows=self.times),
            TextLine(text=""),
            *(TextLine(text=text) for text in PREDICTION),
            Table(key="held_out", columns=SKILLS, rows=held),
            *([] if self.kc_factor is None else [TextLine(text=_factor(self.kc_factor))]),
            Findings(findings=self.findings),
        ])  # fmt: skip


def _factor(factor: float) -> str:
    return f"the k_c factor is not part of the machine: simulate with --kc-factor {factor:.3g}"


def _delay(delay: Delay) -> dict[str, str]:
    """Return the delay of the main drive as a row of the parameter table."""
    return {
        "parameter": "delay of the main drive",
        "value": "" if delay.reason else f"{delay.value:.4g} s",
        "95 % interval": f"{delay.low:.4g} to {delay.high:.4g}" if isfinite(delay.high) else "",
        "identified": f"no: {delay.reason}" if delay.reason else "yes",
    }
