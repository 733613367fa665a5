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
"""rpm, greatest speed of the spindle: that of the library's machining centre ``vmc15``"""


class MillingType(StrEnum):
    """Immersions of [1]_ Fig. 6, unidirectional ones by the sense of the feed."""

    FULL = "full"
    """a slot: the width of cut is the cutter's diameter"""
    UP = "up"
    """one side of the cutter, conventional"""
    DOWN = "down"
    """one side of the cutter, climb"""
    SYMMETRIC = "symmetric"
    """the middle of the cutter: bidirectional immersion"""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputField:
    """A number that a user sets."""

    name: str
    """of the attribute of :class:`Inputs`"""
    words: str
    unit: str
    """empty: none"""
    low: float
    high: float
    """both bounds can be had"""
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
"""Numbers with their bounds: what a shop meets; beyond them it is a slip."""

NUMBERS = {field.name: field for field in FIELDS}


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """All that a user sets; by default a slot in C45 on a machine of 7.5 kW.

    Efficiency and allowed depth are those of [1]_, Table 2. The rest of its case is a cutter of
    one tooth on a motor of 0.29 kW in a material with a third of a steel's specific force
    (``paper002`` in the library). Here 2 mm are bounded by the chip load at 65 % of the motor,
    4 mm by the motor.

    Raises
    ------
    StepNcError
        When a value is beyond its bounds, with its name, the bound and the unit.
    """

    milling_type: MillingType = MillingType.FULL
    material: str = "c45"
    """name in the library"""
    tool_diameter_mm: float = 50.0
    teeth: int = 4
    """the flutes of [1]_"""
    cutting_edge_angle_deg: float = 90.0
    """the setting angle χ of [1]_"""
    radial_width_mm: float = 40.0
    """in full milling it is not looked at: there it is the diameter"""
    cutting_speed_m_min: float = 220.0
    """within the library's window of carbide inserts in C45"""
    efficiency: float = 0.9
    """of the main drive"""
    feed_per_tooth_mm: float = 0.2
    """chip load: TC the greatest that is allowed, QC the one that is kept; within the
    library's window of carbide face mills in steel"""
    axial_depth_mm: float = 2.0
    motor_power_kw: float = 7.5
    axial_depth_max_mm: float = 3.0
    """depth that the machine's capability allows"""
    mode: Criterion = Criterion.TC
    is_on: bool = True
    """whether the loop acts; off, the chip load is run whatever the force"""

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
    """The inputs with some of them changed; enumerations may come as their words.

    Raises
    ------
    StepNcError
        When there is no such input, or a value is beyond its bounds.
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
    """Names of the inputs that differ."""
    names = (field.name for field in fields(Inputs))
    return tuple(name for name in names if getattr(before, name) != getattr(after, name))


def change_words(before: Inputs, after: Inputs, name: str) -> str:
    """A change of one input as a sentence tells it: ``depth 2 -> 4 mm``."""
    old, new = getattr(before, name), getattr(after, name)
    if name == "is_on":
        return "control off -> on" if new else "control on -> off"
    field = NUMBERS.get(name)
    if field is None:
        return f"{name.replace('_', ' ')} {old} -> {new}"
    return f"{field.words} {old:g} -> {new:g} {field.unit}".rstrip()


def _require_within(field: InputField, value: object) -> None:
    """Refuse what is no number or beyond the bounds."""
    bound = f"{field.low:g} to {field.high:g} {field.unit}".rstrip()
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise StepNcError(f"{field.words} '{value}': it must be a number, {bound}")
    if field.is_whole and not (isfinite(value) and float(value).is_integer()):
        raise StepNcError(f"{field.words} {value:g}: it must be a whole number, {bound}")
    if not field.low <= value <= field.high:
        shown = f"{value:g} {field.unit}".rstrip()
        raise StepNcError(f"{field.words} {shown}: it must be {bound}")
