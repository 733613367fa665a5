"""Surface roughness that a program requires.

It is read from ISO 14649-10 ``surface_texture_parameter`` on ``machined_surface``. The standard
does not fix the unit; roughness is customarily given in micrometres, so µm is assumed.
"""

from simulator.physics.surface import RZ_PER_RA
from stepnc_model.entities.enums import BottomOrSide
from stepnc_model.entities.milling import PlaneMilling, SideMilling
from stepnc_model.entities.profiles import SurfaceTextureParameter
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.units import mm_from_um


def required_roughness(program: Program, step: ResolvedWorkingstep) -> float | None:
    """Smallest Ra required of a surface that this workingstep leaves, mm, or None."""
    asked = [
        _arithmetic(texture)
        for feature in step.features
        for texture, surface in program.textures_of(feature)
        if _leaves(step, surface.surface_element)
    ]
    known = [value for value in asked if value is not None]
    return min(known) if known else None


def _arithmetic(texture: SurfaceTextureParameter) -> float | None:
    """Arithmetic roughness Ra of a parameter, mm; None if it is neither Ra nor Rz."""
    name = texture.parameter_name.strip().upper()
    value = texture.its_value
    if value is None or value <= 0.0:
        return None
    if name in {"RA", "R"}:
        return mm_from_um(value)
    return mm_from_um(value) / RZ_PER_RA if name == "RZ" else None


def _leaves(step: ResolvedWorkingstep, element: BottomOrSide | None) -> bool:
    """Whether the operation cuts the bottom or the side to which a texture applies."""
    if isinstance(step.operation, PlaneMilling):
        return element is not BottomOrSide.SIDE
    if isinstance(step.operation, SideMilling):
        return element is not BottomOrSide.BOTTOM
    return True
