"""Milling operations (ISO 14649-11); lengths in mm."""

from __future__ import annotations

from stepnc_model.entities.approach import ApproachRetractStrategy
from stepnc_model.entities.entity import abstract, entity
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.strategies import FreeformStrategy, Two5dMillingStrategy
from stepnc_model.part21.values import Ref


@abstract
class MillingMachiningOperation(MachiningOperation):
    """Operation of a rotating tool."""

    overcut_length: float | None = None


@abstract
class MillingTypeOperation(MillingMachiningOperation):
    """Operation that mills."""

    approach: Ref[ApproachRetractStrategy] | None = None
    retract: Ref[ApproachRetractStrategy] | None = None


@entity
class FreeformOperation(MillingTypeOperation):
    """Milling of a free-form surface."""

    its_machining_strategy: Ref[FreeformStrategy] | None = None


@abstract
class Two5dMillingOperation(MillingTypeOperation):
    """Milling at constant depth, layer by layer."""

    its_machining_strategy: Ref[Two5dMillingStrategy] | None = None


@abstract
class PlaneMilling(Two5dMillingOperation):
    """Milling of a face."""

    axial_cutting_depth: float | None = None
    allowance_bottom: float | None = None


@entity
class PlaneRoughMilling(PlaneMilling):
    """Roughing of a face."""


@entity
class PlaneFinishMilling(PlaneMilling):
    """Finishing of a face."""


@abstract
class SideMilling(Two5dMillingOperation):
    """Milling of a wall."""

    axial_cutting_depth: float | None = None
    radial_cutting_depth: float | None = None
    allowance_side: float | None = None


@entity
class SideRoughMilling(SideMilling):
    """Roughing of a wall."""


@entity
class SideFinishMilling(SideMilling):
    """Finishing of a wall."""


@abstract
class BottomAndSideMilling(Two5dMillingOperation):
    """Milling of floor and walls."""

    axial_cutting_depth: float | None = None
    radial_cutting_depth: float | None = None
    allowance_side: float | None = None
    allowance_bottom: float | None = None


@entity
class BottomAndSideRoughMilling(BottomAndSideMilling):
    """Roughing of floor and walls."""


@entity
class BottomAndSideFinishMilling(BottomAndSideMilling):
    """Finishing of floor and walls."""
