"""Technology, machine functions and operations of turning (ISO 14649-12).

Numbers are kept in the units of ISO 14649-10 §4.2.1: m/s, rev/s, mm per revolution, Pa.

Order of the attributes after the flattened XSD of ISO 14649-12, less its private
``ref_dt_cutting_tool``; it was not checked against the text of the standard.
"""

from __future__ import annotations

from stepnc_model.entities.approach import ApproachRetractStrategy
from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.enums import CoolantSelect
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.measures import PropertyParameter
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.technology import (
    AdaptiveControl,
    MachineFunctions,
    ProcessModelList,
    Technology,
)
from stepnc_model.entities.turning_strategies import TurningMachiningStrategy
from stepnc_model.part21.values import Ref, Typed


@entity
class ConstSpindleSpeed(Entity):
    """The spindle turns evenly."""

    rot_speed: float
    """rev/s; negative is clockwise"""


@entity
class ConstCuttingSpeed(Entity):
    """The spindle follows the diameter."""

    speed: float
    """m/s"""
    max_speed: float | None = None
    """rev/s"""


@entity
class TurningTechnology(Technology):
    """Cutting conditions of a lathe."""

    spindle_speed: Ref[ConstSpindleSpeed | ConstCuttingSpeed]
    feed_per_revolution: float | None = None
    """mm"""
    sync_spindle_and_z_feed: bool
    inhibit_feedrate_override: bool
    inhibit_spindle_override: bool
    its_adaptive_control: Ref[AdaptiveControl] | None = None


@entity
class TurningMachineFunctions(MachineFunctions):
    """Coolant, clamping, chips and rests of a lathe; pressure in Pa."""

    coolant: bool
    coolant_type: CoolantSelect | None = None
    coolant_pressure: float | None = None
    axis_clamping: tuple[str, ...]
    chip_removal: bool | None = None
    oriented_spindle_stop: Ref[Direction] | None = None
    its_process_model: Ref[ProcessModelList] | None = None
    other_functions: tuple[Ref[PropertyParameter], ...]
    tail_stock: bool | None = None
    steady_rest: bool | None = None
    follow_rest: bool | None = None


@abstract
class TurningMachiningOperation(MachiningOperation):
    """Operation of a lathe."""

    approach: Ref[ApproachRetractStrategy] | None = None
    retract: Ref[ApproachRetractStrategy] | None = None
    its_machining_strategy: Ref[TurningMachiningStrategy] | None = None


@abstract
class Facing(TurningMachiningOperation):
    """Turning of a face."""

    allowance: float | None = None


@entity
class FacingRough(Facing):
    """Roughing of a face."""


@entity
class FacingFinish(Facing):
    """Finishing of a face."""


@abstract
class Grooving(TurningMachiningOperation):
    """Plunging into a groove."""

    dwell: Typed | float | None = None
    """DWELL_TIME in s or DWELL_REVOLUTION in revolutions, as the typed value says"""
    allowance: float | None = None


@entity
class GroovingRough(Grooving):
    """Roughing of a groove."""


@entity
class GroovingFinish(Grooving):
    """Finishing of a groove."""


@entity
class CuttingIn(Grooving):
    """Cutting in or off."""


@abstract
class Contouring(TurningMachiningOperation):
    """Turning along a contour."""

    allowance: float | None = None


@entity
class ContouringRough(Contouring):
    """Roughing of a contour."""


@entity
class ContouringFinish(Contouring):
    """Finishing of a contour."""


@abstract
class Threading(TurningMachiningOperation):
    """Turning of a thread."""

    allowance: float | None = None


@entity
class ThreadingRough(Threading):
    """Roughing of a thread."""


@entity
class ThreadingFinish(Threading):
    """Finishing of a thread."""


@entity
class Knurling(TurningMachiningOperation):
    """Pressing of a knurl."""
