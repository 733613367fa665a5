"""Threads (ISO 14649-10); mm."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.features import MachiningFeature
from stepnc_model.entities.geometry import Axis2Placement3d
from stepnc_model.entities.measures import DescriptiveParameter, NumericParameter
from stepnc_model.part21.values import Ref


@entity
class PartialAreaDefinition(Entity):
    """Part of a feature's length."""

    effective_length: float
    placement: Ref[Axis2Placement3d]
    maximum_length: float | None = None


@entity
class SpecificationUsageConstraint(Entity):
    """Element of a document that applies."""

    element: str
    class_id: str


@entity
class Specification(Entity):
    """Document by its name."""

    constraint: tuple[Ref[SpecificationUsageConstraint], ...]
    specification_id: str
    specification_description: str | None = None
    specification_class: str | None = None


@abstract
class Thread(MachiningFeature):
    """Thread on a shape."""

    partial_profile: Ref[PartialAreaDefinition]
    applied_shape: tuple[Ref[MachiningFeature], ...]
    inner_or_outer_thread: bool
    qualifier: Ref[DescriptiveParameter] | None = None
    fit_class: Ref[DescriptiveParameter]
    form: Ref[DescriptiveParameter]
    major_diameter: float
    number_of_threads: Ref[NumericParameter]
    thread_hand: Ref[DescriptiveParameter]


@entity
class CatalogueThread(Thread):
    """Thread by a standard."""

    documentation: Ref[Specification]


@entity
class DefinedThread(Thread):
    """Thread by its sizes."""

    pitch_diameter: float
    minor_diameter: float | None = None
    crest: float | None = None
