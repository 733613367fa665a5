"""Bottoms of holes and pockets, floors of profiles (ISO 14649-10); mm and degrees."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.geometry import CartesianPoint, Plane
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.entities.regions import Region
from stepnc_model.part21.values import Ref


@abstract
class HoleBottomCondition(Entity):
    """How a hole ends."""


@entity
class ThroughBottomCondition(HoleBottomCondition):
    """The hole goes through."""


@abstract
class BlindBottomCondition(HoleBottomCondition):
    """The hole has a bottom."""


@entity
class FlatHoleBottom(BlindBottomCondition):
    """Flat bottom."""


@entity
class FlatWithRadiusHoleBottom(BlindBottomCondition):
    """Flat bottom with a rounded edge."""

    corner_radius: Ref[TolerancedLengthMeasure]


@entity
class SphericalHoleBottom(BlindBottomCondition):
    """Round bottom."""

    radius: Ref[TolerancedLengthMeasure]


@entity
class ConicalHoleBottom(BlindBottomCondition):
    """Bottom that a drill leaves."""

    tip_angle: float
    tip_radius: Ref[TolerancedLengthMeasure] | None = None


@abstract
class PocketBottomCondition(Entity):
    """How a pocket ends."""


@entity
class ThroughPocketBottomCondition(PocketBottomCondition):
    """The pocket goes through."""


@entity
class PlanarPocketBottomCondition(PocketBottomCondition):
    """Flat floor."""


@entity
class RadiusedPocketBottomCondition(PocketBottomCondition):
    """Floor that is part of a sphere."""

    floor_radius_center: Ref[CartesianPoint]
    floor_radius: Ref[TolerancedLengthMeasure]


@entity
class GeneralPocketBottomCondition(PocketBottomCondition):
    """Floor of any shape."""

    shape: Ref[Region]


@entity
class ThroughProfileFloor(Entity):
    """The profile has no floor."""


@abstract
class ProfileFloor(Entity):
    """Floor of a profile."""

    floor_radius: Ref[NumericParameter] | None = None
    start_or_end: bool


@entity
class GeneralProfileFloor(ProfileFloor):
    """Floor of any shape, by its face."""

    floor: Ref[Entity]


@entity
class PlanarProfileFloor(ProfileFloor):
    """Flat floor."""

    floor: Ref[Plane]
