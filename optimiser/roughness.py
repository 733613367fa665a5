"""Roughness that a feed leaves, and the feed limit of a required roughness.

Surface roughness that a program requires.

It is read from ISO 14649-10 ``surface_texture_parameter`` on ``machined_surface``. The standard
does not fix the unit; roughness is customarily given in micrometres, so µm is assumed.
"""

from collections.abc import Iterator
from dataclasses import replace

from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut, Texture
from optimiser.problem import Limit, LimitName, Monomial
from simulator.physics.surface import RA_FLOOR, RZ_PER_RA, corner_coefficient, wall_coefficient
from stepnc_model.entities.enums import BottomOrSide
from stepnc_model.entities.milling import PlaneMilling, SideMilling
from stepnc_model.entities.profiles import SurfaceTextureParameter
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.units import UM_PER_MM, mm_from_um

LAND_SHARE = 0.8
"""Greatest feed per revolution over the parallel land of a face mill's inserts.

Each revolution then smooths the surface of the previous one; Sandvik Coromant, milling surface
generation.
"""

WIPER_FEED = 2.0
"""Feed of a wiper insert over that of a round nose for the same surface.

Kyocera, chipbreaker selection for steel, WP and WQ: double feed rate while maintaining a smooth
finish.
"""


def surface_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limit on the roughness of the finished surface, where it depends on the feed."""
    if at.roughness is None:
        return
    if cut.parallel_land > 0.0 and at.roughness >= RA_FLOOR:
        yield Limit(
            name=LimitName.ROUGHNESS,
            label="feed per revolution on the parallel land",
            load=Monomial(coefficient=float(cut.tool.teeth), feed_exponent=1.0),
            bound=LAND_SHARE * cut.parallel_land,
            unit="mm",
            step=0.1,
        )
    elif roughness_load(replace(cut, parallel_land=0.0)) is not None:
        yield roughness_limit(replace(cut, parallel_land=0.0), at.roughness)


IDEAL = "ideal, not measured"
"""What every planned Ra is: the trace of feed and corner, which no measurement calibrates."""


def roughness_limit(cut: Cut, roughness: float) -> Limit:
    """Limit on roughness Ra, mm; ValueError if the surface does not depend on the feed."""
    load = roughness_load(cut)
    if load is None:
        raise ValueError("the roughness of this surface does not follow from the feed")
    return Limit(
        name=LimitName.ROUGHNESS,
        load=load,
        bound=roughness,
        unit="µm",
        scale=UM_PER_MM,
        label=f"roughness Ra ({IDEAL})",
    )


def roughness_load(cut: Cut) -> Monomial | None:
    """Roughness Ra, mm, as a function of the feed; None where it does not depend on the feed.

    Ideal roughness of :mod:`simulator.physics.surface` and the floor; the feed of a corner is
    per revolution for one high tooth, per tooth for equal ones, over :data:`WIPER_FEED` with a
    wiper.
    """
    if cut.texture is Texture.NONE or cut.parallel_land > 0.0:
        return None
    if cut.texture is Texture.WALL:
        coefficient = wall_coefficient(cut.diameter)
    elif cut.corner_radius > 0.0:
        marked_by = cut.tool.teeth if cut.texture is Texture.CORNER_PER_REVOLUTION else 1
        smoothed = WIPER_FEED**2 if cut.tool.has_wiper else 1.0
        coefficient = marked_by**2 * corner_coefficient(cut.corner_radius) / smoothed
    else:
        return None
    return Monomial(coefficient=coefficient, offset=RA_FLOOR, feed_exponent=2.0)


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
    """True if the operation cuts the bottom or the side to which a texture applies."""
    if isinstance(step.operation, PlaneMilling):
        return element is not BottomOrSide.SIDE
    if isinstance(step.operation, SideMilling):
        return element is not BottomOrSide.BOTTOM
    return True
