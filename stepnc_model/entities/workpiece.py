"""The workpiece and its material (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import (
    AdvancedBrepShapeRepresentation,
    Block,
    CartesianPoint,
    RightCircularCylinder,
)
from stepnc_model.entities.measures import PropertyParameter
from stepnc_model.part21.values import Ref


class Material(Entity):
    """Material, given by its names and properties."""

    standard_identifier: str
    material_identifier: str
    material_property: tuple[Ref[PropertyParameter], ...]


class Workpiece(Entity):
    """Workpiece: the finished part, or the raw piece that it is made from."""

    its_id: str
    its_material: Ref[Material] | None = None
    global_tolerance: float | None = None
    """mm, where nothing closer is asked"""
    its_rawpiece: Ref[Workpiece] | None = None
    its_geometry: Ref[AdvancedBrepShapeRepresentation] | None = None
    its_bounding_geometry: (
        Ref[Block | RightCircularCylinder | AdvancedBrepShapeRepresentation] | None
    ) = None
    clamping_positions: tuple[Ref[CartesianPoint], ...]
