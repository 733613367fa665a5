"""Machining strategies of turning (ISO 14649-12); mm and degrees.

A feed is a typed value, ``FEED_VELOCITY_TYPE`` in m/s or ``FEED_PER_REV_TYPE`` in mm.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.enums import ThreadCutDepthType, ThreadingDirectionType
from stepnc_model.entities.geometry import Direction
from stepnc_model.part21.values import Ref, Typed


@abstract
class TurningMachiningStrategy(Entity):
    """How material is turned off."""

    overcut_length: float | None = None
    allow_multiple_passes: bool | None = None
    cutting_depth: tuple[float, ...]
    """one depth for all passes, or one for each"""
    variable_feedrate: float | None = None
    """ratio of the feedrate"""


@entity
class UnidirectionalTurning(TurningMachiningStrategy):
    """Passes in one direction."""

    feed_direction: Ref[Direction] | None = None
    back_path_direction: Ref[Direction] | None = None
    lift_direction: Ref[Direction] | None = None
    stepover_direction: Ref[Direction] | None = None
    lift_height: float | None = None
    lift_feed: Typed | float | None = None
    stepover_feed: Typed | float | None = None


@entity
class BidirectionalTurning(TurningMachiningStrategy):
    """Passes to and fro."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: Ref[Direction] | None = None
    stepover_feed: Typed | float | None = None


@entity
class ContourTurning(TurningMachiningStrategy):
    """Passes along the contour."""

    feed_direction: Ref[Direction] | None = None
    back_path_direction: Ref[Direction] | None = None
    lift_direction: Ref[Direction] | None = None
    stepover_direction: Ref[Direction] | None = None
    lift_height: float | None = None
    lift_feed: Typed | float | None = None
    stepover_feed: Typed | float | None = None
    variable_stepover_feed: float | None = None


@entity
class ThreadStrategy(TurningMachiningStrategy):
    """Passes of a thread."""

    cut_in_amount_function: ThreadCutDepthType
    threading_direction: ThreadingDirectionType
    path_return_angle: float | None = None
    lift_height: float | None = None


@entity
class GroovingStrategy(TurningMachiningStrategy):
    """Plunges side by side."""

    grooving_direction: Ref[Direction] | None = None
    travel_distance: float | None = None


@entity
class MultistepGroovingStrategy(GroovingStrategy):
    """Plunges with retracts that break the chip."""

    retract_distance: float


@entity
class ExplicitTurningStrategy(TurningMachiningStrategy):
    """As the tool path says."""
