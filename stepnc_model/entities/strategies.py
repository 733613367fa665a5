"""Machining strategies of milling and drilling (ISO 14649-11).

Overlaps and reductions are ratios from 0 to 1; files of the draft of 2001 write percent.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.enums import (
    CutmodeType,
    LeftOrRight,
    PathmodeType,
    RotDirection,
    StrokeConnectionStrategy,
)
from stepnc_model.entities.geometry import BoundedCurve, Direction
from stepnc_model.part21.values import Ref


@abstract
class Two5dMillingStrategy(Entity):
    """How an area is covered at constant depth."""

    overlap: float | None = None
    """of neighbouring strokes, as a ratio of the tool diameter"""
    allow_multiple_passes: bool | None = None


@entity
class UnidirectionalMilling(Two5dMillingStrategy):
    """Strokes in one direction; UNIDIRECTIONAL in the draft of 2001."""

    feed_direction: Ref[Direction] | None = None
    cutmode: CutmodeType | None = None


@entity
class BidirectionalMilling(Two5dMillingStrategy):
    """Strokes to and fro; BIDIRECTIONAL in the draft of 2001."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    its_stroke_connection_strategy: StrokeConnectionStrategy | None = None


@entity
class ContourParallel(Two5dMillingStrategy):
    """Offsets of the contour."""

    rotation_direction: RotDirection
    cutmode: CutmodeType | None = None


@entity
class BidirectionalContour(Two5dMillingStrategy):
    """Strokes to and fro, then along the contour."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    rotation_direction: RotDirection | None = None
    spiral_cutmode: CutmodeType | None = None


@entity
class ContourBidirectional(Two5dMillingStrategy):
    """Along the contour, then strokes to and fro."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    rotation_direction: RotDirection | None = None
    spiral_cutmode: CutmodeType | None = None


@entity
class ContourSpiral(Two5dMillingStrategy):
    """Spiral that follows the contour."""

    rotation_direction: RotDirection
    cutmode: CutmodeType | None = None


@entity
class CenterMilling(Two5dMillingStrategy):
    """One stroke in the middle of the slot."""


@entity
class ExplicitStrategy(Two5dMillingStrategy):
    """As the tool path says; EXPLICIT in the draft of 2001."""


@entity
class Tolerances(Entity):
    """Deviations allowed on a free-form surface, mm."""

    chordal_tolerance: float
    scallop_height: float


@abstract
class FreeformStrategy(Entity):
    """How a free-form surface is covered."""

    pathmode: PathmodeType
    cutmode: CutmodeType
    its_milling_tolerances: Ref[Tolerances]
    stepover: float | None = None


@entity
class UvStrategy(FreeformStrategy):
    """Along the parameters of the surface."""

    forward_direction: Ref[Direction]
    sideward_direction: Ref[Direction]


@entity
class PlaneCcStrategy(FreeformStrategy):
    """Contact points in parallel planes."""

    its_plane_normal: Ref[Direction]


@entity
class PlaneClStrategy(FreeformStrategy):
    """Tool centre points in parallel planes."""

    its_plane_normal: Ref[Direction]


@entity
class LeadingLineStrategy(FreeformStrategy):
    """Strokes parallel to a curve."""

    its_line: Ref[BoundedCurve]


@entity
class DrillingTypeStrategy(Entity):
    """Reduced cut and feed where a drill enters and leaves; depths in mm."""

    reduced_cut_at_start: float | None = None
    reduced_feed_at_start: float | None = None
    depth_of_start: float | None = None
    reduced_cut_at_end: float | None = None
    reduced_feed_at_end: float | None = None
    depth_of_end: float | None = None
