"""Roughness that a feed leaves, and the feed limit of a required roughness.

A limit keeps the Ra of a share of real surfaces (:mod:`simulator.physics.surface_spread`), not
the ideal one. Where even the least feed would not keep it, nothing is promised: the feed stays
within the program's and within the ideal.

The required roughness is read from ISO 14649-10 ``surface_texture_parameter`` on
``machined_surface``. The standard does not fix the unit; roughness is customarily given in
micrometres, so µm is assumed.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import pi

from optimiser.bounds.speed_limits import held_speed
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind, Texture
from optimiser.solver.problem import Limit, LimitName, Monomial
from simulator.physics.surface import RA_FLOOR, RZ_PER_RA, corner_coefficient, wall_coefficient
from simulator.physics.surface_spread import (
    RoughnessForecast,
    forecast,
    unmeasured_spread,
)
from simulator.spec import ToolKind
from simulator.surface_law import SurfaceSpread
from stepnc_model.entities.enums import BottomOrSide
from stepnc_model.entities.milling import PlaneMilling, SideMilling
from stepnc_model.entities.profiles import SurfaceTextureParameter
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.units import UM_PER_MM, mm_from_um, um_from_mm

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
        yield from _kept_roughness(replace(cut, parallel_land=0.0), at, at.roughness)


IDEAL = "ideal, not measured"
"""Basis of a roughness that is the trace of feed and corner alone."""

OWN_MEASUREMENTS = "Ra measured on own cuts: stepnc calibrate --table CUTS --material NAME"
"""Datum that brings a promise."""

GREATEST_TRACE = 10.0
"""Feed over the corner radius beyond which no feed is looked for."""


def _kept_roughness(cut: Cut, at: CuttingConditions, roughness: float) -> Iterator[Limit]:
    """Limits that keep an Ra, mm, at the planned share of surfaces."""
    ideal = roughness_limit(cut, roughness)
    if at.machine.only_stated_limits:
        yield ideal
        return
    outside = _outside(cut)
    if outside:
        yield replace(ideal, datum=OWN_MEASUREMENTS, origin=outside)
        return
    speed, share = _surface_speed(cut, at), at.roughness_quantile

    def kept(feed: float) -> float:
        return _forecast(cut, at, feed, speed).quantile(share)

    floor = kept(0.0)
    if floor >= roughness:
        yield ideal
        yield _not_promised(cut, at, floor)
        return
    low, high = 0.0, GREATEST_TRACE * max(cut.corner_radius, cut.diameter, 1.0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if kept(middle) < roughness else (low, middle)
    # Exact at the floor and at the bound, and between them where the median is kept.
    yield Limit(
        name=LimitName.ROUGHNESS,
        load=Monomial(
            coefficient=(roughness - floor) / low**2, offset=floor, feed_exponent=2.0
        ),
        bound=roughness,
        unit="µm",
        scale=UM_PER_MM,
        label=f"roughness Ra of {100.0 * share:g} % of surfaces",
    )


def _not_promised(cut: Cut, at: CuttingConditions, floor: float) -> Limit:
    """Programmed feed in place of a roughness that no feed is sure to keep."""
    return Limit(
        name=LimitName.PROGRAMMED_FEED,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=cut.programmed.feed,
        unit="mm",
        step=0.01,
        label="programmed feed (roughness not promised)",
        origin=(
            f"Ra not promised before this shop has measured: {100.0 * at.roughness_quantile:g} "
            f"% of surfaces keep no less than {um_from_mm(floor):.2g} µm at any feed"
        ),
        datum=OWN_MEASUREMENTS,
        stands_for=LimitName.ROUGHNESS,
    )


def basis_of(at: CuttingConditions) -> str:
    """Words on what an expected Ra rests on."""
    count = at.material.surface.count if at.material.surface is not None else 0
    return f"from {count} measured" if count else "spread of published studies, not measured"


def roughness_forecast(
    cut: Cut, at: CuttingConditions, *, feed: float, speed: float
) -> RoughnessForecast | None:
    """Ra that a feed per tooth, mm, leaves at a spindle speed, rev/s.

    None where the feed does not determine it, where no study covers the tool, and on a machine
    whose source states the law of Ra.
    """
    if at.machine.only_stated_limits or roughness_load(cut) is None or _outside(cut):
        return None
    return _forecast(cut, at, feed, pi * cut.diameter * speed)


def _forecast(
    cut: Cut, at: CuttingConditions, feed: float, cutting_speed: float
) -> RoughnessForecast:
    return forecast(
        _spread(at),
        _trace_coefficient(cut) * feed**2,
        cutting_speed=cutting_speed,
        is_dry=at.is_dry,
        teeth=cut.tool.teeth if cut.kind is CutKind.MILLING else 1,
    )


def _spread(at: CuttingConditions) -> SurfaceSpread:
    return at.material.surface or unmeasured_spread(at.material.iso_group)


def _surface_speed(cut: Cut, at: CuttingConditions) -> float:
    """Cutting speed at which a roughness is kept, mm/s: the floor falls as it rises."""
    if at.finishing_speed is not None:
        return at.finishing_speed
    return pi * cut.diameter * held_speed(cut, at)


def is_dry(program: Program, step: ResolvedWorkingstep) -> bool:
    """True unless the machine functions of a workingstep switch a coolant on."""
    functions = program.get(step.functions_ref) if step.functions_ref is not None else None
    return not any(
        getattr(functions, name, None)
        for name in ("coolant", "mist", "through_spindle_coolant")
    )


def _outside(cut: Cut) -> str:
    """Reason why no study covers the surface of a cut; empty if one does."""
    if cut.tool.has_wiper:
        return "no published study of wiper inserts is known"
    if cut.tool_kind is ToolKind.BORING_BAR:
        return "no published study of boring bars is known"
    return ""


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
    if cut.texture is not Texture.WALL and not cut.corner_radius > 0.0:
        return None
    marked_by = cut.tool.teeth if cut.texture is Texture.CORNER_PER_REVOLUTION else 1
    coefficient = marked_by**2 * _trace_coefficient(cut)
    return Monomial(coefficient=coefficient, offset=RA_FLOOR, feed_exponent=2.0)


def _trace_coefficient(cut: Cut) -> float:
    """Ideal Ra over the square of the feed per tooth, 1/mm."""
    if cut.texture is Texture.WALL:
        return wall_coefficient(cut.diameter)
    smoothed = WIPER_FEED**2 if cut.tool.has_wiper else 1.0
    return corner_coefficient(cut.corner_radius) / smoothed


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
