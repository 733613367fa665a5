"""Optimisation records as Fig. 11 of [1]_ prints them, read into the consistent form.

The figure and the schema of the same paper disagree: powers hold their numeric parameter
instead of referring to one, the cutting force stands in another order with one value too many,
the immersion is in double quotes, and numbers carry the units of Table 2. What a record means
is still plain, so it is read, and every slip is a finding. Records in the order of
``schemas/optimisation.exp`` are none of this module's business.

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
"""keywords whose instances may stand in the printed form"""

INLINED: Ref[NumericParameter] = Ref(0)
"""stands for a numeric parameter that has no instance of its own; ids of a file start at 1"""

MAX_SPINDLE_SPEED = 300.0
"""rev/s; a greater number is taken for rpm"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsistentRecord:
    """One record in the consistent form."""

    entity: Entity
    inlined: NumericParameter | None
    """what :data:`INLINED` stands for; ``None`` when there is none or its value is left out"""
    findings: tuple[Finding, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Record:
    """One instance as it stands in the file."""

    values: tuple[Value, ...]
    label: str
    line: int

    def slip(self, message: str, attribute: str) -> Finding:
        """A finding about this record."""
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
    """Read a record in the form of Fig. 11.

    Parameters
    ----------
    keyword : str
        EXPRESS name in capitals.
    values : tuple of Value
        Parameters as they stand in the file.
    label : str
        The instance for messages, ``#203 CUTTING_FORCE``.
    line : int
        Its line, counted from 1; 0 when unknown.

    Returns
    -------
    ConsistentRecord or None
        None for any other form, which is for the generic binding.
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
    """('MACHINE POWER', 0.29, 'kW')."""
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
    """('CUTTING POWER', $, 'kW', #203, 35): the last is Table 2's cutting speed in m/min."""
    if len(record.values) != 5:
        return None
    name, value, unit, force, speed = record.values
    number = _number(speed)
    if not isinstance(name, str) or not isinstance(force, Ref) or number is None:
        return None
    findings = [_inlining(record)]
    if value is None:
        findings.append(record.slip("the power is left out", "its_power_property"))
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
    """(1000, #204, 500, $, 0.5, 5): resistance, type, speed, nothing, feed, depth."""
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
        "specific cutting resistance stands first; the schema has the face milling type first, "
        "then spindle speed, feed per tooth, resistance and depth"
    )
    findings = [
        record.slip(order, "specific_cutting_resistance"),
        record.slip("$ after the spindle speed belongs to no attribute", ""),
    ]
    if abs(speed) > MAX_SPINDLE_SPEED:
        text = f"no spindle turns at {speed:g} rev/s: read as {speed:g} rpm"
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
    """(180.0, "FULL_IMMERSION")."""
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
        findings=(record.slip(f"{name} is a text; the schema has .{name}.", "immersion_type"),),
    )


def _inlining(record: _Record) -> Finding:
    """The slip that both powers share."""
    return record.slip(
        "name, value and unit stand inside; the schema refers to a NUMERIC_PARAMETER",
        "its_power_property",
    )


def _numeric_parameter(name: Value, value: Value, unit: Value) -> NumericParameter | None:
    """A numeric parameter, if these three make one."""
    number = _number(value)
    if number is None or not isinstance(name, str) or not isinstance(unit, str):
        return None
    return NumericParameter(
        parameter_name=str(name), its_parameter_value=number, its_parameter_unit=str(unit)
    )


def _number(value: Value) -> float | None:
    """A finite number, else None; a reference is none."""
    if isinstance(value, Ref) or not isinstance(value, (int, float)) or not isfinite(value):
        return None
    return float(value)
