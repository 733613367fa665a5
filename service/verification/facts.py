"""Rows of a verification: greatest deviations by workingstep, tolerance bands, resolution."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np

from service.verification.run import Verification
from simulator.motion.segments import Bools
from simulator.verification.deviation import (
    SurfaceKind,
    SurfacePlaces,
    arc_uncertainty,
    corner_uncertainty,
    rounding_uncertainty,
    smallest_arc,
)
from simulator.verification.surface import EXACT

BANDS = (0.005, 0.01, 0.0254, 0.05, 0.1, 0.2, 0.5)
"""Half widths of the tolerance bands, mm."""

RAW = "raw part"
"""Name of the surface that the program does not cut."""

UNSEEN = (
    "deflection of tool, holder and workpiece: --with-deflection adds the predicted deflection "
    "of the tool",
    "the true radius, length, runout and wear of tools",
    "thermal growth of spindle and workpiece, and geometric errors beyond the scales",
    "backlash and lag that the scales do not measure, and chatter between samples",
    "how the workpiece was clamped: an offset of the whole part looks like another zero",
)
"""What position feedback cannot see."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviationSpot:
    """Greatest deviation of one sign on a surface."""

    size: float
    """Size of the deviation, mm."""
    uncertainty: float
    """mm"""
    least: float
    """Size that the deviation has at least, mm; not positive where it may be none."""
    position: tuple[float, float, float]
    """mm"""
    block: int
    """Block of the program that makes the surface there; 0: none."""
    time: float
    """Time of the nearest sample, s; NaN: none came near."""
    cut_by: str
    """Workingstep that the log shows then; empty: unknown."""

    @property
    def is_beyond(self) -> bool:
        """Whether the deviation exceeds its uncertainty, or is certain by the samples alone."""
        return self.least > 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceDeviation:
    """Greatest gouge and excess on the walls or floors of a workingstep."""

    workingstep: str
    feature: str
    tool: int
    """Number of the tool; 0: unknown."""
    kind: SurfaceKind
    gouge: DeviationSpot
    excess: DeviationSpot
    area: float
    """Area of the surface, mm²."""
    beyond: float
    """Share of the area whose deviation exceeds its uncertainty."""

    nominal: tuple[float, float] | None
    """Least and greatest deviation of the logged surface from the nominal feature, mm: excess
    positive. None without a feature."""

    bent: float | None
    """Predicted deflection of the tool away from the wall, mm, which the log does not see: it
    comes on top of the excess. None where it is unknown."""

    @property
    def worse(self) -> DeviationSpot:
        """The one of both that exceeds its uncertainty by more."""
        pair = (self.gouge, self.excess)
        return max(pair, key=lambda spot: spot.least)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToleranceBand:
    """Share of the surface whose deviation is within ± a width."""

    width: float
    """Half width of the band, mm."""
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LogResolution:
    """What a log can resolve normal to a surface, mm."""

    step: float
    """Way of the tool between samples."""
    straight: float
    arc: float
    """On the smallest arc of the program."""
    radius: float
    """Radius of that arc; infinite without an arc, or without a program."""
    corner: float
    """At square corners."""


def surface_deviations(found: Verification) -> Iterator[SurfaceDeviation]:
    """Yield the greatest deviations by workingstep, walls before floors."""
    places = found.places
    for index in range(-1, len(found.steps)):
        for is_wall in (True, False):
            rows = (places.workingstep == index) & (places.is_wall == is_wall)
            if rows.any():
                yield _surface(found, index, is_wall, rows)


def _surface(found: Verification, index: int, is_wall: bool, rows: Bools) -> SurfaceDeviation:
    places, nominal = found.places[rows], found.nominal[rows]
    against = (places.deviation + nominal)[np.isfinite(nominal)]
    whole = float(places.area.sum())
    step = found.steps[index] if index >= 0 else None
    return SurfaceDeviation(
        workingstep=step.workingstep if step else RAW,
        feature=step.feature if step else "",
        tool=step.tool if step else 0,
        kind=_kind(found, is_wall),
        gouge=_spot(found, places, -1.0),
        excess=_spot(found, places, 1.0),
        area=whole,
        nominal=(float(against.min()), float(against.max())) if len(against) else None,
        bent=found.bent.get(step.workingstep) if step and is_wall else None,
        beyond=float(places.area[places.is_beyond].sum()) / whole,
    )


def _kind(found: Verification, is_wall: bool) -> SurfaceKind:
    if found.is_turned:
        return SurfaceKind.FACE if is_wall else SurfaceKind.DIAMETER
    return SurfaceKind.WALL if is_wall else SurfaceKind.FLOOR


def _spot(found: Verification, places: SurfacePlaces, sign: float) -> DeviationSpot:
    """Deviation of a sign with the greatest least size, or the nearest to its uncertainty."""
    size = np.maximum(sign * places.deviation, 0.0)
    least = np.where(size > 0.0, places.least, -places.uncertainty)
    row = int(least.argmax())
    x, y, z = places.position[row].tolist()
    by = int(places.cut_by[row])
    return DeviationSpot(
        size=float(size[row]),
        uncertainty=float(places.uncertainty[row]),
        least=float(least[row]),
        position=(x, y, z),
        block=int(places.block[row]),
        time=float(places.time[row]),
        cut_by=found.steps[by].workingstep if by >= 0 else "",
    )


def tolerance_bands(found: Verification) -> tuple[ToleranceBand, ...]:
    """Shares of the surface within bands of the deviation, by area."""
    places = found.places
    whole, size = float(places.area.sum()), np.abs(places.deviation)
    return tuple(
        ToleranceBand(width=width, share=float(places.area[size <= width].sum()) / whole)
        for width in BANDS
    )


def log_resolution(found: Verification) -> LogResolution:
    """What the log can resolve, by its usual step, its rounding and the limit of the method."""
    facts = found.facts
    rounding = rounding_uncertainty(facts) + EXACT
    radius = inf if found.path is None else smallest_arc(found.path)
    return LogResolution(
        step=found.step,
        straight=rounding,
        arc=rounding + arc_uncertainty(found.step, radius),
        radius=radius,
        corner=rounding + corner_uncertainty(found.step),
    )
