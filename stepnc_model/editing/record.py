"""Optimisation record as one flat data class, and its two forms in a file.

Profile ``optimisation`` writes entities of ``schemas/optimisation.exp``; profile ``standard``
writes parameters of ISO 14649 with a prefix and the workingstep in their names, to which no
instance refers. Both hold exactly the same numbers, so a record can be converted without loss.
Numbers have the units of the file: mm, m/s, rev/s, s, kW, N, J, µm.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from math import isfinite
from typing import Any, cast

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import (
    DescriptiveParameter,
    NumericParameter,
    PropertyParameter,
)
from stepnc_model.entities.optimisation import (
    CuttingForce,
    EnergyCriticalOptimisation,
    FaceMillingImmersion,
    FaceMillingType,
    MachinePower,
    MainCuttingPower,
    Optimisation,
    OptimisationRecord,
    PredictedValues,
    ProgrammedValues,
    QualityCriticalOptimisation,
    TimeCriticalOptimisation,
)
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.part21.writer import Edits
from stepnc_model.programs.binding import Model, is_about_values, to_parameters

PREFIX = "optimisation:"
"""Prefix of the name of every parameter that belongs to a record."""

GENERATOR = "stepnc-optimiser"


def _unit(unit: str) -> Any:
    """Field with the unit written in its parameter."""
    return field(metadata={"unit": unit})


@dataclass(frozen=True, slots=True, kw_only=True)
class AdviceRecord:
    """Optimisation advice for one operation, with its reasons."""

    mode: str
    """Goal of the optimisation: TC, QC or EC."""
    id: str
    description: str
    machine: str
    material: str
    generator: str
    active_limit: str
    number_of_passes: int = _unit("")
    feed_per_tooth: float = _unit("mm")
    axial_depth: float = _unit("mm")
    machine_power: float = _unit("kW")
    cutting_power: float = _unit("kW")
    spindle_speed: float = _unit("rev/s")
    specific_cutting_resistance: float = _unit("N/mm2")
    machining_time: float = _unit("s")
    motor_power: float = _unit("kW")
    cutting_force: float = _unit("N")
    energy: float = _unit("J")
    surface_roughness: float | None = field(default=None, metadata={"unit": "um"})
    contact_angle: float | None = field(default=None, metadata={"unit": "deg"})
    immersion: str | None = None
    programmed_feedrate: float | None = field(default=None, metadata={"unit": "m/s"})
    programmed_feedrate_per_tooth: float | None = field(default=None, metadata={"unit": "mm"})
    programmed_cutspeed: float | None = field(default=None, metadata={"unit": "m/s"})
    programmed_spindle: float | None = field(default=None, metadata={"unit": "rev/s"})
    programmed_axial_depth: float | None = field(default=None, metadata={"unit": "mm"})
    plunge_feed_per_tooth: float | None = field(default=None, metadata={"unit": "mm"})
    """Feed per tooth on the way down into the material, mm; None for the feed of the cut."""
    feed_per_tooth_max: float | None = field(default=None, metadata={"unit": "mm"})
    """Greatest feed per tooth that is allowed, mm; None where it is not told apart."""
    axial_depth_max: float | None = field(default=None, metadata={"unit": "mm"})
    """Greatest depth of a pass that is allowed, mm."""
    machine_power_bound: float | None = field(default=None, metadata={"unit": "kW"})
    """Power that an earlier record of the file allows, kW; None: it sets no bound."""
    feed_per_tooth_bound: float | None = field(default=None, metadata={"unit": "mm"})
    """Feed per tooth that an earlier record of the file allows, mm."""
    axial_depth_bound: float | None = field(default=None, metadata={"unit": "mm"})
    """Depth of a pass that an earlier record of the file allows, mm."""

    def __post_init__(self) -> None:
        maxima = (self.feed_per_tooth_max, self.axial_depth_max)
        if (maxima != (None, None) and self.mode != "TC") or maxima.count(None) == 1:
            raise ValueError("maxima belong to a time critical record, and come together")


MODES: dict[str, type[Entity]] = {
    "TC": TimeCriticalOptimisation,
    "QC": QualityCriticalOptimisation,
    "EC": EnergyCriticalOptimisation,
}


def write_entities(record: AdviceRecord, edits: Edits) -> Ref[Entity]:
    """Add the entities of a record; return the reference to the optimisation."""

    def add(entity: Entity) -> Ref[Any]:
        return cast("Ref[Any]", edits.add(entity.keyword, to_parameters(entity)))

    def power(name: str, value: float) -> Ref[NumericParameter]:
        return add(
            NumericParameter(
                parameter_name=name, its_parameter_value=value, its_parameter_unit="kW"
            )
        )

    available = add(
        MachinePower(its_power_property=power("machine power", record.machine_power))
    )
    immersion: Ref[FaceMillingType] | None = None
    if record.immersion is not None and record.contact_angle is not None:
        immersion = add(
            FaceMillingType(
                zeta=record.contact_angle,
                immersion_type=FaceMillingImmersion[record.immersion],
            )
        )
    force = add(
        CuttingForce(
            its_face_milling_type=immersion,
            spindle_speed=record.spindle_speed,
            feed_per_tooth=record.feed_per_tooth,
            specific_cutting_resistance=record.specific_cutting_resistance,
            axial_cutting_depth=record.axial_depth,
        )
    )
    cutting = add(
        MainCuttingPower(
            its_power_property=power("cutting power", record.cutting_power),
            its_cutting_force=force,
            spindle_speed=record.spindle_speed,
        )
    )
    details = add(
        OptimisationRecord(
            number_of_passes=record.number_of_passes,
            active_limit=record.active_limit,
            predicted=add(_predicted(record)),
            programmed=add(_programmed(record)),
            its_cutting_power=cutting,
            machine=record.machine,
            material=record.material,
            generator=record.generator,
            plunge_feed_per_tooth=record.plunge_feed_per_tooth,
            optimum_feed_per_tooth=_optimum(record, record.feed_per_tooth),
            optimum_axial_depth=_optimum(record, record.axial_depth),
            machine_power_bound=record.machine_power_bound,
            feed_per_tooth_bound=record.feed_per_tooth_bound,
            axial_depth_bound=record.axial_depth_bound,
        )
    )
    return add(_optimisation(record, available, details))


def _optimum(record: AdviceRecord, value: float) -> float | None:
    """Optimum beside the maxima of a time critical record; absent in all others."""
    return value if record.feed_per_tooth_max is not None else None


def read_entities(model: Model, ref: Ref[Entity]) -> AdviceRecord | None:
    """Read the record of an operation's optimisation; None if it is incomplete."""
    try:
        return _checked(_from_entities(model, ref))
    except (AttributeError, TypeError, ValueError, SchemaError) as error:
        if not is_about_values(error):
            raise
        # A record of another program: some reference is dangling or leads to something else.
        return None


def _from_entities(model: Model, ref: Ref[Entity]) -> AdviceRecord | None:
    """Build a record from its entities, without checking the values."""
    optimum: Any = model.entity(int(ref))
    if not isinstance(optimum, Optimisation) or getattr(optimum, "its_record", None) is None:
        return None
    named: Any = optimum
    details = model.get(named.its_record)
    mode = next(name for name, cls in MODES.items() if isinstance(optimum, cls))
    suffix = "_max" if mode == "TC" else ""
    optimum, depth = details.optimum_feed_per_tooth, details.optimum_axial_depth
    is_old = optimum is None or depth is None or mode != "TC"
    cutting = model.get(details.its_cutting_power)
    force = model.get(cutting.its_cutting_force)
    face = force.its_face_milling_type
    immersion = model.get(face) if face is not None else None
    predicted, programmed = model.get(details.predicted), model.get(details.programmed)
    available = model.get(model.get(named.main_drive_motor_power).its_power_property)
    return AdviceRecord(
        mode=mode,
        id=named.its_id,
        description=named.process_description or "",
        machine=details.machine,
        material=details.material,
        generator=details.generator,
        active_limit=details.active_limit,
        number_of_passes=details.number_of_passes,
        feed_per_tooth=getattr(named, f"feed_per_tooth{suffix}") if is_old else optimum,
        axial_depth=getattr(named, f"axial_cutting_depth{suffix}") if is_old else depth,
        feed_per_tooth_max=None if is_old else named.feed_per_tooth_max,
        axial_depth_max=None if is_old else named.axial_cutting_depth_max,
        machine_power_bound=details.machine_power_bound,
        feed_per_tooth_bound=details.feed_per_tooth_bound,
        axial_depth_bound=details.axial_depth_bound,
        machine_power=available.its_parameter_value,
        cutting_power=model.get(cutting.its_power_property).its_parameter_value,
        spindle_speed=force.spindle_speed,
        specific_cutting_resistance=force.specific_cutting_resistance,
        machining_time=predicted.machining_time,
        motor_power=predicted.motor_power,
        cutting_force=predicted.cutting_force,
        energy=predicted.energy,
        surface_roughness=predicted.surface_roughness,
        contact_angle=immersion.zeta if immersion else None,
        immersion=immersion.immersion_type.value if immersion else None,
        programmed_feedrate=programmed.feedrate,
        programmed_feedrate_per_tooth=programmed.feedrate_per_tooth,
        programmed_cutspeed=programmed.cutspeed,
        programmed_spindle=programmed.spindle,
        programmed_axial_depth=programmed.axial_cutting_depth,
        plunge_feed_per_tooth=details.plunge_feed_per_tooth,
    )


def parameters_of(record: AdviceRecord, key: str = "") -> Iterator[PropertyParameter]:
    """Parameters with a prefix that hold a record, one for each number or text.

    Parameters
    ----------
    key : str
        Workingstep of the record, ``1:ROUGH THE FACE``, which ends the names; empty: none.
    """
    for each in fields(record):
        value = getattr(record, each.name)
        if value is None:
            continue
        name = PREFIX + each.name + (f":{key}" if key else "")
        if isinstance(value, str):
            yield DescriptiveParameter(parameter_name=name, descriptive_string=value)
        else:
            yield NumericParameter(
                parameter_name=name,
                its_parameter_value=float(value),
                its_parameter_unit=each.metadata["unit"],
            )


def read_parameters(values: Mapping[str, float | str]) -> AdviceRecord | None:
    """Build a record from its parameters by name; None if some are missing."""
    known = {each.name for each in fields(AdviceRecord)}
    found: dict[str, Any] = {name: value for name, value in values.items() if name in known}
    count = found.get("number_of_passes")
    if isinstance(count, float) and count.is_integer():
        found["number_of_passes"] = int(count)
    try:
        return _checked(AdviceRecord(**found))
    except (TypeError, ValueError):
        return None


def _checked(record: AdviceRecord | None) -> AdviceRecord | None:
    """Return the record if every value has the right type, else None."""
    if record is None or record.mode not in MODES:
        return None
    for each in fields(record):
        value = getattr(record, each.name)
        if value is None and each.default is None:
            continue
        if "unit" not in each.metadata:
            is_good = isinstance(value, str)
        else:
            is_good = isinstance(value, int | float) and isfinite(value)
        if not is_good:
            return None
    return record


def _predicted(record: AdviceRecord) -> PredictedValues:
    """Entity with the predicted results of the advice."""
    return PredictedValues(
        machining_time=record.machining_time,
        motor_power=record.motor_power,
        cutting_force=record.cutting_force,
        surface_roughness=record.surface_roughness,
        energy=record.energy,
    )


def _programmed(record: AdviceRecord) -> ProgrammedValues:
    """Entity with the values that the file originally programmed."""
    return ProgrammedValues(
        feedrate=record.programmed_feedrate,
        feedrate_per_tooth=record.programmed_feedrate_per_tooth,
        cutspeed=record.programmed_cutspeed,
        spindle=record.programmed_spindle,
        axial_cutting_depth=record.programmed_axial_depth,
    )


def _optimisation(
    record: AdviceRecord, power: Ref[MachinePower], details: Ref[OptimisationRecord]
) -> Entity:
    """Optimisation entity for the record's mode."""
    suffix = "_max" if record.mode == "TC" else ""
    values: dict[str, object] = {
        "its_id": record.id,
        "main_drive_motor_power": power,
        "process_description": record.description,
        f"feed_per_tooth{suffix}": record.feed_per_tooth,
        f"axial_cutting_depth{suffix}": record.axial_depth,
        **_maxima(record),
        "its_record": details,
    }
    return MODES[record.mode](**values)


def _maxima(record: AdviceRecord) -> dict[str, object]:
    """Maxima of a time critical optimisation, where the record tells them from the optimum."""
    if record.mode != "TC" or record.feed_per_tooth_max is None:
        return {}
    return {
        "feed_per_tooth_max": record.feed_per_tooth_max,
        "axial_cutting_depth_max": record.axial_depth_max,
    }
