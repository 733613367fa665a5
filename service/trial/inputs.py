"""Inputs of a trial cut, in the user's units: the three panes of [1]_, Fig. 9.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Computer model", Figs. 6, 7 and 9, Table 2.
"""

from dataclasses import dataclass, fields, replace
from enum import StrEnum
from math import isfinite
from typing import Any

from controller.orders import Criterion
from service.reading import one_of
from simulator.library import material_names
from simulator.physics.kinematics import spindle_speed
from stepnc_model.errors import StepNcError
from stepnc_model.units import rpm_from_rev_s, speed_from_m_min

MOST_RPM = 12_000.0
"""Largest spindle speed, in rpm: that of the library's machining centre ``vmc15``."""


class MillingType(StrEnum):
    """Milling types by immersion after [1]_, Fig. 6; unidirectional ones by feed direction."""

    FULL = "full"
    """Slot: the width of cut is the cutter diameter."""
    UP = "up"
    """One side of the cutter, conventional milling."""
    DOWN = "down"
    """One side of the cutter, climb milling."""
    SYMMETRIC = "symmetric"
    """Middle of the cutter, bidirectional immersion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputField:
    """Numeric input that a user sets, with its unit and bounds."""

    name: str
    """Name of the attribute of :class:`Inputs`."""
    words: str
    unit: str
    """Unit; empty if the number has none."""
    low: float
    high: float
    """Upper bound; both bounds are inclusive."""
    is_whole: bool = False


FIELDS = (
    InputField(name="tool_diameter_mm", words="tool diameter", unit="mm", low=4.0, high=160.0),
    InputField(name="teeth", words="teeth", unit="", low=1, high=16, is_whole=True),
    InputField(
        name="cutting_edge_angle_deg",
        words="cutting edge angle",
        unit="°",
        low=10.0,
        high=90.0,
    ),
    InputField(name="radial_width_mm", words="radial width", unit="mm", low=0.5, high=160.0),
    InputField(
        name="cutting_speed_m_min", words="cutting speed", unit="m/min", low=20.0, high=1000.0
    ),
    InputField(name="efficiency", words="mechanical efficiency", unit="", low=0.3, high=1.0),
    InputField(name="feed_per_tooth_mm", words="chip load", unit="mm", low=0.01, high=1.0),
    InputField(name="axial_depth_mm", words="depth", unit="mm", low=0.1, high=20.0),
    InputField(name="motor_power_kw", words="motor power", unit="kW", low=0.1, high=100.0),
    InputField(name="axial_depth_max_mm", words="allowed depth", unit="mm", low=0.1, high=20.0),
)
"""Numeric inputs with their bounds; values outside are taken for typing errors."""

NUMBERS = {field.name: field for field in FIELDS}


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """Inputs of a trial cut; the default is a slot in C45 on a machine of 7.5 kW.

    Efficiency and allowed depth are those of [1]_, Table 2. The rest of that example is a
    cutter with one tooth on a motor of 0.29 kW, in a material with a third of the specific
    force of steel (``paper002`` in the library). Here, chip load limits the feed at 2 mm depth,
    with 65 % of the motor power in use; the motor limits it at 4 mm.

    Raises
    ------
    StepNcError
        When a value is out of bounds, with name, bound and unit.
    """

    milling_type: MillingType = MillingType.FULL
    material: str = "c45"
    """Name of the workpiece material in the library."""
    tool_diameter_mm: float = 50.0
    teeth: int = 4
    """Number of teeth, the flutes of [1]_."""
    cutting_edge_angle_deg: float = 90.0
    """Cutting edge angle, the setting angle χ of [1]_, in °."""
    radial_width_mm: float = 40.0
    """Radial width of cut, in mm; ignored in full milling, where it equals the diameter."""
    cutting_speed_m_min: float = 220.0
    """Cutting speed, in m/min; within the library's window of carbide inserts in C45."""
    efficiency: float = 0.9
    """Efficiency of the main drive."""
    feed_per_tooth_mm: float = 0.2
    """Chip load, in mm: the largest allowed in mode TC, the one kept in mode QC; within the
    library's window of carbide face mills in steel."""
    axial_depth_mm: float = 2.0
    motor_power_kw: float = 7.5
    axial_depth_max_mm: float = 3.0
    """Depth that the machine's capability allows, in mm."""
    mode: Criterion = Criterion.TC
    is_on: bool = True
    """Whether force control is on; if off, the chip load is run whatever the force."""

    def __post_init__(self) -> None:
        for field in FIELDS:
            _require_within(field, getattr(self, field.name))
        if self.material not in material_names():
            known = ", ".join(material_names())
            raise StepNcError(f"unknown material '{self.material}'; known: {known}")
        is_partial = self.milling_type is not MillingType.FULL
        if is_partial and self.radial_width_mm > self.tool_diameter_mm:
            bound = f"at most the tool diameter, {self.tool_diameter_mm:g} mm"
            raise StepNcError(f"radial width {self.radial_width_mm:g} mm: it must be {bound}")
        speed = speed_from_m_min(self.cutting_speed_m_min)
        rpm = rpm_from_rev_s(spindle_speed(self.tool_diameter_mm, speed))
        if rpm > MOST_RPM:
            raise StepNcError(
                f"spindle speed {rpm:.5g} rpm, from cutting speed {self.cutting_speed_m_min:g} "
                f"m/min and tool diameter {self.tool_diameter_mm:g} mm: it must be at most "
                f"{MOST_RPM:g} rpm"
            )


def changed(inputs: Inputs, **changes: Any) -> Inputs:
    """Return the inputs with some of them changed; enumerations may be given as text.

    Raises
    ------
    StepNcError
        When an input is unknown, or a value is out of bounds.
    """
    known = [field.name for field in fields(Inputs)]
    for name in changes:
        if name not in known:
            raise StepNcError(f"unknown input '{name}'; known: {', '.join(known)}")
    if "milling_type" in changes:
        word = str(changes["milling_type"])
        changes["milling_type"] = one_of(MillingType, word, "milling type")
    if "mode" in changes:
        changes["mode"] = one_of(Criterion, str(changes["mode"]).upper(), "mode")
    if not isinstance(changes.get("is_on", True), bool):
        raise StepNcError(f"control '{changes['is_on']}': it must be on or off")
    return replace(inputs, **changes)


def differing(before: Inputs, after: Inputs) -> tuple[str, ...]:
    """Return the names of the inputs that differ."""
    names = (field.name for field in fields(Inputs))
    return tuple(name for name in names if getattr(before, name) != getattr(after, name))


def change_words(before: Inputs, after: Inputs, name: str) -> str:
    """Describe a change of one input for an event, as in ``depth 2 -> 4 mm``."""
    old, new = getattr(before, name), getattr(after, name)
    if name == "is_on":
        return "control off -> on" if new else "control on -> off"
    field = NUMBERS.get(name)
    if field is None:
        return f"{name.replace('_', ' ')} {old} -> {new}"
    return f"{field.words} {old:g} -> {new:g} {field.unit}".rstrip()


def _require_within(field: InputField, value: object) -> None:
    """Refuse a value that is not a number or is out of bounds."""
    bound = f"{field.low:g} to {field.high:g} {field.unit}".rstrip()
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise StepNcError(f"{field.words} '{value}': it must be a number, {bound}")
    if field.is_whole and not (isfinite(value) and float(value).is_integer()):
        raise StepNcError(f"{field.words} {value:g}: it must be a whole number, {bound}")
    if not field.low <= value <= field.high:
        shown = f"{value:g} {field.unit}".rstrip()
        raise StepNcError(f"{field.words} {shown}: it must be {bound}")
