"""Approach and retract (ISO 14649-11); angles in degrees, lengths in mm."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.toolpaths import ToolpathList
from stepnc_model.part21.values import Ref


@abstract
class ApproachRetractStrategy(Entity):
    """How the tool comes to the cut or leaves it."""

    tool_orientation: Ref[Direction] | None = None


@abstract
class PlungeStrategy(ApproachRetractStrategy):
    """Way into material."""


@entity
class PlungeToolaxis(PlungeStrategy):
    """Straight down the tool axis."""


@entity
class PlungeRamp(PlungeStrategy):
    """Down a straight ramp."""

    angle: float


@entity
class PlungeHelix(PlungeStrategy):
    """Down a helix."""

    radius: float
    angle: float


@entity
class PlungeZigzag(PlungeStrategy):
    """Down a ramp to and fro."""

    angle: float
    width: float


@abstract
class AirStrategy(ApproachRetractStrategy):
    """Way through air."""


@entity
class ApRetractAngle(AirStrategy):
    """Straight, at an angle to the path."""

    angle: float
    travel_length: float


@entity
class ApRetractTangent(AirStrategy):
    """Along an arc that meets the path tangentially."""

    radius: float


@entity
class AlongPath(ApproachRetractStrategy):
    """Along tool paths of its own."""

    path: Ref[ToolpathList]
