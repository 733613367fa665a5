"""Optimisation record of a machining operation: ``schemas/optimisation.exp`` in Python.

The data model follows [1]_, Fig. 10, made consistent, with additions for a machine that
optimises, measures and learns. Numbers have the units of the file, ISO 14649-10, 4.2.1: mm, s,
m/s, rev/s (signed), degrees; forces in N, powers in kW, energies in J, roughness in µm,
specific force in N/mm². They become mm, s, N, W and rad when a program is read, not here.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Fig. 10 and 11.
"""

from __future__ import annotations

from enum import StrEnum

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import NumericParameter
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.part21.values import Ref


class FaceMillingImmersion(StrEnum):
    """``face_milling_immersion``: part of the cutter's width that cuts, [1]_ Fig. 6."""

    FULL_IMMERSION = "FULL_IMMERSION"
    UNIDIRECTIONAL_PART_IMMERSION = "UNIDIRECTIONAL_PART_IMMERSION"
    BILATERAL_PART_IMMERSION = "BILATERAL_PART_IMMERSION"


class Optimisation(Entity, abstract=True):
    """Supertype ``optimisation``: optimised feed and depth of an operation."""

    its_id: str
    main_drive_motor_power: Ref[MachinePower]
    process_description: str | None = None


class TimeCriticalOptimisation(Optimisation):
    """EXPRESS ``time_critical_optimisation``: limits for the least machining time.

    The greatest feed per tooth and depth that are allowed, mm; the optimum is in the record.
    """

    feed_per_tooth_max: float
    axial_cutting_depth_max: float
    its_record: Ref[OptimisationRecord] | None = None


class QualityCriticalOptimisation(Optimisation):
    """EXPRESS ``quality_critical_optimisation``: optimum for quality, mm per tooth, mm."""

    feed_per_tooth: float
    axial_cutting_depth: float
    its_record: Ref[OptimisationRecord] | None = None


class EnergyCriticalOptimisation(Optimisation):
    """EXPRESS ``energy_critical_optimisation``: optimum for energy, mm per tooth, mm."""

    feed_per_tooth: float
    axial_cutting_depth: float
    its_record: Ref[OptimisationRecord] | None = None


class Power(Entity, abstract=True):
    """Supertype ``power``: a power as a numeric parameter in kW."""

    its_power_property: Ref[NumericParameter]


class MachinePower(Power):
    """EXPRESS ``machine_power``: power available at the main drive."""


class MainCuttingPower(Power):
    """EXPRESS ``main_cutting_power``: power of the cut, at a signed speed in rev/s."""

    its_cutting_force: Ref[CuttingForce]
    spindle_speed: float


class CuttingForce(Entity):
    """EXPRESS ``cutting_force``: data from which the mean tangential force is calculated."""

    its_face_milling_type: Ref[FaceMillingType] | None = None
    spindle_speed: float
    """rev/s, signed"""
    feed_per_tooth: float
    """mm"""
    specific_cutting_resistance: float
    """N/mm²"""
    axial_cutting_depth: float
    """mm"""


class FaceMillingType(Entity):
    """EXPRESS ``face_milling_type``: angle of contact in degrees, 180 in a full cut."""

    zeta: float
    immersion_type: FaceMillingImmersion


class OptimisationRecord(Entity):
    """EXPRESS ``optimisation_record``: conditions and reasons of an optimum."""

    number_of_passes: int
    active_limit: str
    """what forbids a greater feed"""
    predicted: Ref[PredictedValues]
    programmed: Ref[ProgrammedValues]
    its_cutting_power: Ref[MainCuttingPower] | None = None
    machine: str
    material: str
    generator: str
    plunge_feed_per_tooth: float | None = None
    """mm, on the way down into the material; absent: the feed of the cut"""
    optimum_feed_per_tooth: float | None = None
    """mm; absent in old records, whose optimum is the maximum"""
    optimum_axial_depth: float | None = None
    """mm"""
    machine_power_bound: float | None = None
    """kW, set by an earlier record of the file"""
    feed_per_tooth_bound: float | None = None
    """mm, likewise"""
    axial_depth_bound: float | None = None
    """mm, likewise"""


class PredictedValues(Entity):
    """EXPRESS ``predicted_values``: predictions of the models for the whole operation."""

    machining_time: float
    """s"""
    motor_power: float
    """kW, greatest"""
    cutting_force: float
    """N, greatest"""
    surface_roughness: float | None = None
    """µm, arithmetic mean"""
    energy: float | None = None
    """J"""


class ProgrammedValues(Entity):
    """EXPRESS ``programmed_values``: values in the file before the first optimisation."""

    feedrate: float | None = None
    """m/s"""
    feedrate_per_tooth: float | None = None
    """mm"""
    cutspeed: float | None = None
    """m/s"""
    spindle: float | None = None
    """rev/s, signed"""
    axial_cutting_depth: float | None = None
    """mm"""


class FeedProfile(Entity):
    """EXPRESS ``feed_profile``: feed along the path, linear between stations."""

    its_operation: Ref[MachiningOperation]
    its_stations: tuple[float, ...]
    """mm from the start of the path"""
    its_feedrates: tuple[float, ...]
    """m/s, one for each station"""


class Outcome(Entity):
    """EXPRESS ``outcome``: measurements taken while an operation ran."""

    its_operation: Ref[MachiningOperation]
    measured_at: str | None = None
    """ISO 8601, with zone"""
    machining_time: float | None = None
    """s"""
    cutting_force: float | None = None
    """N"""
    feedrate: float | None = None
    """m/s"""
    surface_roughness: float | None = None
    """µm"""
    trace: str | None = None
    """where the samples are kept"""


class Correction(Entity):
    """EXPRESS ``correction``: correction learned for a machine, a material and a tool."""

    machine: str
    material: str
    tool: str
    specific_force_factor: float
    confidence: float
    """0…1"""
    accepted_by: str | None = None
    """absent while it is only proposed"""
    valid_from: str
    """ISO 8601"""
