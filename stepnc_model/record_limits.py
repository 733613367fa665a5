"""Limits in the optimisation record of a file, which bound the next plan.

Paper 002, Fig. 10, gives an optimisation the power of the main drive and the greatest feed per
tooth and depth that are allowed. A record of that form is an input. A record that this project
wrote binds only by the limits that it took over from one: what it wrote as its own optimum, as
records did before they kept the two apart, never binds. Units mm, W.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Any

from stepnc_model.entities.measures import NumericParameter
from stepnc_model.entities.optimisation import (
    MachinePower,
    Optimisation,
    OptimisationRecord,
    TimeCriticalOptimisation,
)
from stepnc_model.paper002 import read_printed
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.record_edit import find_record
from stepnc_model.units import kw_from_watts, watts_from_kw


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordLimits:
    """Limits of one operation; None where the record sets none."""

    motor_power: float | None = None
    """Power that the cut may draw from the main drive, W."""
    feed_per_tooth: float | None = None
    """Greatest feed per tooth, mm."""
    axial_depth: float | None = None
    """Greatest axial depth of one pass, mm."""

    def __bool__(self) -> bool:
        return any(
            value is not None
            for value in (self.motor_power, self.feed_per_tooth, self.axial_depth)
        )

    @property
    def words(self) -> str:
        """Limits with their units."""
        parts = []
        if self.motor_power is not None:
            parts.append(f"motor power {kw_from_watts(self.motor_power):.4g} kW")
        if self.feed_per_tooth is not None:
            parts.append(f"feed per tooth {self.feed_per_tooth:.4g} mm")
        if self.axial_depth is not None:
            parts.append(f"axial depth {self.axial_depth:.4g} mm")
        return ", ".join(parts)


NO_LIMITS = RecordLimits()
"""Limits of a workingstep whose record does not bind."""


def record_limits(program: Program, step: ResolvedWorkingstep) -> RecordLimits:
    """Limits of the optimisation record of a workingstep.

    Parameters
    ----------
    program : Program
    step : ResolvedWorkingstep

    Returns
    -------
    RecordLimits
        Without values where there is no record, or none that binds.
    """
    own = find_record(program, step)
    if own is not None:
        power = own.machine_power_bound
        return RecordLimits(
            motor_power=None if power is None else watts_from_kw(power),
            feed_per_tooth=own.feed_per_tooth_bound,
            axial_depth=own.axial_depth_bound,
        )
    reference = step.operation.its_optimisation
    found: Any = None if reference is None else program.model.entity(int(reference))
    if not isinstance(found, Optimisation) or _has_details(program, found):
        return NO_LIMITS
    power = _motor_power(program, found)
    if not isinstance(found, TimeCriticalOptimisation):
        return RecordLimits(motor_power=power)
    return RecordLimits(
        motor_power=power,
        feed_per_tooth=_positive(found.feed_per_tooth_max),
        axial_depth=_positive(found.axial_cutting_depth_max),
    )


def _has_details(program: Program, optimum: Optimisation) -> bool:
    """Whether an optimisation is one that this project wrote, even if damaged since."""
    reference: Any = getattr(optimum, "its_record", None)
    if reference is None:
        return False
    return isinstance(program.model.entity(int(reference)), OptimisationRecord)


def _motor_power(program: Program, optimum: Optimisation) -> float | None:
    """Power of the main drive, W: as the schema gives it, or as Fig. 11 prints it."""
    reference: Any = optimum.main_drive_motor_power
    number = None if reference is None else int(reference)
    if number is None or number not in program.file:
        return None
    keyword = program.file.keyword(number)
    printed = read_printed(keyword, program.file.parameters(number))
    if printed is not None:
        return _watts(printed.inlined)
    entity: Any = program.model.entity(number)
    if not isinstance(entity, MachinePower):
        return None
    inner: Any = entity.its_power_property
    return _watts(None if inner is None else program.model.entity(int(inner)))


def _watts(parameter: object) -> float | None:
    """Power of a numeric parameter in kW or W; None for any other."""
    if not isinstance(parameter, NumericParameter):
        return None
    value = _positive(parameter.its_parameter_value)
    unit = (parameter.its_parameter_unit or "").strip().upper()
    if value is None or unit not in {"KW", "W"}:
        return None
    return watts_from_kw(value) if unit == "KW" else value


def _positive(value: float | None) -> float | None:
    """Positive finite number; None for any other."""
    return value if value is not None and isfinite(value) and value > 0.0 else None
