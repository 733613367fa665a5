"""How workpieces stand on the machine (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, entity
from stepnc_model.entities.expressions import NcVariable
from stepnc_model.entities.geometry import (
    AdvancedBrepShapeRepresentation,
    Axis2Placement3d,
    Block,
    BoundedSurface,
    ElementarySurface,
    RightCircularCylinder,
)
from stepnc_model.entities.workpiece import Workpiece
from stepnc_model.part21.values import Ref


@entity
class OffsetVector(Entity):
    """Offset that the control measures: three variables each."""

    translate: tuple[Ref[NcVariable], ...]
    rotate: tuple[Ref[NcVariable], ...] | None = None


@entity
class SetupInstruction(Entity):
    """What the person at the machine has to do."""

    description: str | None = None
    external_document: str | None = None


@entity
class WorkpieceSetup(Entity):
    """One workpiece in a setup; ``its_origin`` is given in the setup's coordinates."""

    its_workpiece: Ref[Workpiece]
    its_origin: Ref[Axis2Placement3d]
    its_offset: Ref[OffsetVector] | None = None
    its_restricted_area: (
        Ref[BoundedSurface | Block | RightCircularCylinder | AdvancedBrepShapeRepresentation]
        | None
    ) = None
    its_instructions: tuple[Ref[SetupInstruction], ...]


@entity
class Setup(Entity):
    """Clamping; ``its_origin`` is given in the machine's coordinates."""

    its_id: str
    its_origin: Ref[Axis2Placement3d] | None = None
    its_secplane: Ref[ElementarySurface]
    its_workpiece_setup: tuple[Ref[WorkpieceSetup], ...]
