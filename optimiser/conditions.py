"""Conditions of a cut: machine, material, tool grade and permitted values."""

from dataclasses import dataclass

from optimiser.bar_grip import BarGrip
from simulator.spec import CuttingMaterial, Machine, ToolGrade, WorkMaterial
from simulator.work_holding import Holding

GREATEST_DEFLECTION = 0.1
"""mm at the tip of an end mill, whatever it leaves: beyond it teeth share the work unevenly;
customary"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PermittedDeflection:
    """Permitted deflection of an end mill."""

    value: float = GREATEST_DEFLECTION
    """Value, mm at its tip"""
    origin: str = ""
    """where the value comes from, as a sentence goes on; empty: custom"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingConditions:
    """Conditions of a cut: machine, material, tool grade and permitted values."""

    machine: Machine
    material: WorkMaterial
    cutting_material: CuttingMaterial
    grade: ToolGrade | None
    """``None``: the material carries no tool limits"""
    roughness: float | None
    """Ra in mm that this surface must keep"""
    deflection: PermittedDeflection = PermittedDeflection()
    """what tolerance or allowance of its wall leaves to an end mill"""
    force_factor: float = 1.0
    """accepted correction of k_c from measurements"""
    centre_cutting: bool | None = None
    """whether the edges of a mill reach its axis; None: unknown"""
    safety_factor: float = 1.0
    """k_c at the quantile that is planned with, over the nominal one"""
    holding: Holding | None = None
    """what holds the workpiece; None: nothing of it is bounded"""
    grip: BarGrip | None = None
    """where a bar is held; None: not turned, or nothing says it"""
    bar_deflection: PermittedDeflection | None = None
    """how far a bar may bend; None: as far as it does"""
