"""Drilling, boring, reaming and tapping (ISO 14649-11); lengths in mm, times in s."""

from __future__ import annotations

from stepnc_model.entities.entity import abstract, entity
from stepnc_model.entities.geometry import CartesianPoint
from stepnc_model.entities.milling import MillingMachiningOperation
from stepnc_model.entities.strategies import DrillingTypeStrategy
from stepnc_model.part21.values import Ref


@abstract
class DrillingTypeOperation(MillingMachiningOperation):
    """Operation along the axis of a hole."""

    cutting_depth: float | None = None
    previous_diameter: float | None = None
    dwell_time_bottom: float | None = None
    feed_on_retract: float | None = None
    """ratio of the feedrate"""
    its_machining_strategy: Ref[DrillingTypeStrategy] | None = None


@abstract
class DrillingOperation(DrillingTypeOperation):
    """Operation of a drill."""


@entity
class Drilling(DrillingOperation):
    """Drilling in one go."""


@entity
class CenterDrilling(DrillingOperation):
    """Drilling of a centre hole."""


@entity
class CounterSinking(DrillingOperation):
    """Sinking of a cone."""


@entity
class MultistepDrilling(DrillingOperation):
    """Drilling with retracts that break or remove the chip."""

    retract_distance: float
    first_depth: float
    depth_of_step: float
    dwell_time_step: float | None = None


@abstract
class BoringOperation(DrillingTypeOperation):
    """Widening of a hole."""

    spindle_stop_at_bottom: bool
    depth_of_testcut: float | None = None
    waiting_position: Ref[CartesianPoint] | None = None


@entity
class Boring(BoringOperation):
    """Widening with a boring tool."""


@entity
class Reaming(BoringOperation):
    """Finishing with a reamer."""


@entity
class BackBoring(DrillingTypeOperation):
    """Boring from behind."""


@entity
class Tapping(DrillingTypeOperation):
    """Tapping; ``compensation_chuck`` after the draft of 2001."""

    compensation_chuck: bool


@entity
class ThreadDrilling(DrillingTypeOperation):
    """Thread drilling; ``helical_movement_on_forward`` after the draft of 2001."""

    helical_movement_on_forward: bool
