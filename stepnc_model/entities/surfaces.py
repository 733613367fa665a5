"""Surface finish asked of features (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, entity
from stepnc_model.entities.enums import BottomOrSide
from stepnc_model.entities.regions import ManufacturingFeature
from stepnc_model.part21.values import Ref


@entity
class MachinedSurface(Entity):
    """Bottom or side of a feature.

    ISO 14649-10 names ``machining_feature``, which leaves out turning features; a turned seat
    has a roughness too, so any manufacturing feature is read.
    """

    its_machining_feature: Ref[ManufacturingFeature]
    surface_element: BottomOrSide


@entity
class SurfaceTextureParameter(Entity):
    """Roughness by its parameter, the unit as the parameter's standard has it (µm)."""

    its_value: float
    parameter_name: str
    measuring_method: str
    parameter_index: str | None = None
    applied_surfaces: tuple[Ref[MachinedSurface], ...]
