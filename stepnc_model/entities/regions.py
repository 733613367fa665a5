"""Manufacturing features at large, and regions of free-form surfaces (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.geometry import (
    Axis2Placement3d,
    BoundedCurve,
    BoundedSurface,
    Direction,
)
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.workpiece import Workpiece
from stepnc_model.part21.values import Ref


@abstract
class ManufacturingFeature(Entity):
    """Shape to be made, with the operations that make it."""

    its_id: str
    its_workpiece: Ref[Workpiece]
    its_operations: tuple[Ref[MachiningOperation], ...]


@abstract
class Region(ManufacturingFeature):
    """Part of a free-form surface."""

    feature_placement: Ref[Axis2Placement3d] | None = None


@entity
class RegionProjection(Region):
    """What lies below a closed curve."""

    proj_curve: Ref[BoundedCurve]
    proj_dir: Ref[Direction]
    depth: Ref[TolerancedLengthMeasure]


@entity
class RegionSurfaceList(Region):
    """Surfaces one by one."""

    surface_list: tuple[Ref[BoundedSurface], ...]


@entity
class TopologicalRegion(Region):
    """Faces that hang together; the second supertype, ``open_shell``, is spelt out."""

    name: str
    cfs_faces: tuple[Ref[Entity], ...]
