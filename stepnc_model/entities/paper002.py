"""Reader of optimisation records in the form printed in Fig. 11 of [1]_.

The figure and the schema of the same paper disagree: powers contain their numeric parameter
instead of referring to one, the cutting force has another order with one value too many, the
immersion is in double quotes, and numbers have the units of Table 2. The meaning is still
clear, so such records are read, and every deviation is a finding. Records that follow
``schemas/optimisation.exp`` are read elsewhere.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Fig. 10 and 11, Table 2.
"""

from dataclasses import dataclass
from math import isfinite

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import NumericParameter
from stepnc_model.entities.optimisation import (
    CuttingForce,
    FaceMillingImmersion,
    FaceMillingType,
    MachinePower,
    MainCuttingPower,
)
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.values import Enumeration, Ref, Value
from stepnc_model.units import rev_s_from_rpm

RULE = "paper 002, Fig. 11"

PRINTED = frozenset({
    "MACHINE_POWER",
    "MAIN_CUTTING_POWER",
    "CUTTING_FORCE",
    "FACE_MILLING_TYPE",
})
"""Keywords of instances that may have the printed form."""

INLINED: Ref[NumericParameter] = Ref(0)
"""Placeholder for a numeric parameter without an instance; ids of a file start at 1."""

MAX_SPINDLE_SPEED = 300.0
"""Greatest spindle speed, rev/s; greater numbers are read as rpm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsistentRecord:
    """Record converted to the form of the schema."""

    entity: Entity
    inlined: NumericParameter | None
    """Parameter that :data:`INLINED` stands for; ``None`` if it is absent or has no value."""
    findings: tuple[Finding, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Record:
    """Parameters of one instance as in the file, with its place."""

    values: tuple[Value, ...]
    label: str
    line: int

    def slip(self, message: str, attribute: str) -> Finding:
        """Create a finding about this record."""
        return Finding(
            severity=Severity.WARNING,
            message=message,
            entity=self.label,
            attribute=attribute,
            line=self.line,
            rule=RULE,
        )


def read_printed(
    keyword: str, values: tuple[Value, ...], *, label: str = "", line: int = 0
) -> ConsistentRecord | None:
    """Read an optimisation record in the form of Fig. 11.

    Parameters
    ----------
    keyword : str
        EXPRESS name in capitals.
    values : tuple of Value
        Parameters as in the file.
    label : str
        Instance name for messages, ``#203 CUTTING_FORCE``.
    line : int
        Line of the instance, counted from 1; 0 if unknown.

    Returns
    -------
    ConsistentRecord or None
        None for any other form, which is left to the generic binding.
    """
    record = _Record(values=values, label=label, line=line)
    match keyword:
        case "MACHINE_POWER":
            return _machine_power(record)
        case "MAIN_CUTTING_POWER":
            return _main_cutting_power(record)
        case "CUTTING_FORCE":
            return _cutting_force(record)
        case "FACE_MILLING_TYPE":
            return _face_milling_type(record)
        case _:
            return None


def _machine_power(record: _Record) -> ConsistentRecord | None:
    """Read a machine power, printed as ('MACHINE POWER', 0.29, 'kW')."""
    if len(record.values) != 3:
        return None
    parameter = _numeric_parameter(*record.values)
    if parameter is None:
        return None
    return ConsistentRecord(
        entity=MachinePower(its_power_property=INLINED),
        inlined=parameter,
        findings=(_inlining(record),),
    )


def _main_cutting_power(record: _Record) -> ConsistentRecord | None:
    """Read a cutting power, ('CUTTING POWER', $, 'kW', #203, 35); 35 is a speed in m/min."""
    if len(record.values) != 5:
        return None
    name, value, unit, force, speed = record.values
    number = _number(speed)
    if not isinstance(name, str) or not isinstance(force, Ref) or number is None:
        return None
    findings = [_inlining(record)]
    if value is None:
        findings.append(record.slip("the power value is missing", "its_power_property"))
    text = (
        f"{number:g} is kept as a spindle speed in rev/s; "
        "the paper's 35 is the cutting speed of its Table 2 in m/min"
    )
    findings.append(record.slip(text, "spindle_speed"))
    return ConsistentRecord(
        entity=MainCuttingPower(
            its_power_property=INLINED, its_cutting_force=Ref(force), spindle_speed=number
        ),
        inlined=_numeric_parameter(name, value, unit),
        findings=tuple(findings),
    )


def _cutting_force(record: _Record) -> ConsistentRecord | None:
    """Read a cutting force: resistance, type, speed, nothing, feed and depth."""
    if len(record.values) != 6:
        return None
    _, face, _, surplus, _, _ = record.values
    numbers = [_number(record.values[place]) for place in (0, 2, 4, 5)]
    resistance, speed, feed, depth = numbers
    if resistance is None or speed is None or feed is None or depth is None:
        return None
    if surplus is not None or not (face is None or isinstance(face, Ref)):
        return None
    order = (
        "specific cutting resistance comes first; the schema has the face milling type first, "
        "then spindle speed, feed per tooth, resistance and depth"
    )
    findings = [
        record.slip(order, "specific_cutting_resistance"),
        record.slip("$ after the spindle speed belongs to no attribute", ""),
    ]
    if abs(speed) > MAX_SPINDLE_SPEED:
        text = f"spindle speed {speed:g} rev/s is impossible: read as {speed:g} rpm"
        findings.append(record.slip(text, "spindle_speed"))
        speed = rev_s_from_rpm(speed)
    return ConsistentRecord(
        entity=CuttingForce(
            its_face_milling_type=None if face is None else Ref(face),
            spindle_speed=speed,
            feed_per_tooth=feed,
            specific_cutting_resistance=resistance,
            axial_cutting_depth=depth,
        ),
        inlined=None,
        findings=tuple(findings),
    )


def _face_milling_type(record: _Record) -> ConsistentRecord | None:
    """Read a face milling type, printed as (180.0, "FULL_IMMERSION")."""
    if len(record.values) != 2:
        return None
    angle, immersion = _number(record.values[0]), record.values[1]
    if angle is None or isinstance(immersion, Enumeration) or not isinstance(immersion, str):
        return None
    if immersion.upper() not in FaceMillingImmersion.__members__:
        return None
    name = immersion.upper()
    return ConsistentRecord(
        entity=FaceMillingType(zeta=angle, immersion_type=FaceMillingImmersion[name]),
        inlined=None,
        findings=(
            record.slip(
                f"{name} is a string; the schema has the enumeration value .{name}.",
                "immersion_type",
            ),
        ),
    )


def _inlining(record: _Record) -> Finding:
    """Finding that a power contains its parameter instead of referring to it."""
    return record.slip(
        "name, value and unit are inline; the schema refers to a NUMERIC_PARAMETER",
        "its_power_property",
    )


def _numeric_parameter(name: Value, value: Value, unit: Value) -> NumericParameter | None:
    """Numeric parameter from name, value and unit; None if they are not valid."""
    number = _number(value)
    if number is None or not isinstance(name, str) or not isinstance(unit, str):
        return None
    return NumericParameter(
        parameter_name=str(name), its_parameter_value=number, its_parameter_unit=str(unit)
    )


def _number(value: Value) -> float | None:
    """Finite number, or None for any other value."""
    if isinstance(value, Ref) or not isinstance(value, (int, float)) or not isfinite(value):
        return None
    return float(value)
