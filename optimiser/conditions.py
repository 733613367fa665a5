"""Conditions of a cut: machine, material, tool grade, work-holding and permitted values."""

from dataclasses import dataclass

from optimiser.bar_grip import BarGrip
from simulator.spec import CuttingMaterial, Machine, ToolGrade, ToolKind, WorkMaterial
from simulator.tool_windows import grade_for
from simulator.work_holding import Holding
from stepnc_model.record_limits import NO_LIMITS, RecordLimits

GREATEST_DEFLECTION = 0.1
"""Greatest permitted deflection at the tip of any end mill, mm (customary).

Beyond it the teeth share the work unevenly.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PermittedDeflection:
    """Permitted deflection of an end mill or bar, with its origin."""

    value: float = GREATEST_DEFLECTION
    """Greatest permitted deflection, mm."""
    origin: str = ""
    """Origin of the value, as the end of a sentence; empty for the customary value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingConditions:
    """Machine, material, tool grade, work-holding and permitted values of one cut."""

    machine: Machine
    material: WorkMaterial
    cutting_material: CuttingMaterial
    grade: ToolGrade | None
    """Tool with its windows; ``None`` on a machine with only stated limits whose material
    names no group: its source has no tool limits."""
    roughness: float | None
    """Roughness Ra that this surface must keep, mm; None: no requirement."""
    deflection: PermittedDeflection = PermittedDeflection()
    """Permitted deflection of an end mill from the tolerance or allowance of its wall."""
    force_factor: float = 1.0
    """Accepted correction factor of k_c from measurements."""
    centre_cutting: bool | None = None
    """Whether the end edges of a mill reach its axis; None when unknown."""
    safety_factor: float = 1.0
    """k_c at the planned quantile, relative to the nominal k_c."""
    holding: Holding | None = None
    """Chuck, vice or clamps that hold the workpiece; None: no holding limit applies."""
    bounds: RecordLimits = NO_LIMITS
    """Limits that the record in the file sets."""
    grip: BarGrip | None = None
    """Where the bar is gripped; None when not turned or not stated."""
    bar_deflection: PermittedDeflection | None = None
    """Permitted bending of a bar; None when it is not limited."""


def tool_grade(
    kind: ToolKind, cutting_material: CuttingMaterial, machine: Machine, material: WorkMaterial
) -> ToolGrade | None:
    """Tool with its windows in a material, as a machine takes them.

    The source of a machine with only stated limits may name a material without a group: then
    nothing of the tool is added to it.
    """
    if machine.only_stated_limits and not material.iso_group:
        return None
    return grade_for(kind, cutting_material, material)
