"""A milling machine from the XML form of paper 003.

The form is one ``Machine`` element whose attributes carry no units. This is the audited
reading: powers in W although their names say energy, the rapid in hundredths of a metre per
minute, the spindle's acceleration in rev/s², the pitch of the feed screw in metres per
revolution, its diameter in metres, times in ms. Each assumption is a remark of the machine. The
names are kept as printed, slips included; the corrected spelling is read too.

``randomProperty`` holds two half-widths of the deviation of motor powers, in traverse and in
feed, as §4.1 orders them; ``randomType`` can only be ``Uniform``, the one distribution of §4.2.

References
----------
Lechevalier, Shin, Rachuri, Foufou, Lee, Bouras (2018), "Simulating a virtual machining model
in an agent-based model for advanced analytics", Fig. 5 and Table 1.
"""

from math import inf, nan
from pathlib import Path
from typing import Annotated

from simulator.errors import LibraryError
from simulator.files.machine_file import (
    UNLIMITED_POWER,
    AuxiliaryPower,
    DriveInertia,
    Efficiency,
    Friction,
    GearRatio,
    Inertia,
    Mass,
    MovedMass,
    Preload,
    SpindleAcceleration,
    Viscous,
)
from simulator.files.toml_file import FileTable, KeyFault, converted, quantity, read_bounded
from simulator.spec import (
    Axis,
    AxisDrive,
    Handling,
    HandlingState,
    Machine,
    MachineKind,
    PowerDeviation,
    Spindle,
    SpindlePoint,
)
from stepnc_model.units import (
    MM_PER_M,
    nmm_from_nm,
    seconds_from_ms,
    speed_from_m_min,
    speed_from_m_s,
)

StateTime = Annotated[float, quantity(0, 1e8, "ms")]
RotorSize = Annotated[float, quantity(0, 1e4, "mm")]

RAPID_UNITS_PER_M_MIN = 100.0
"""basicRapidSpeed 1600 is 16 m/min"""

CORRECTED_SPELLING = {
    "partSetupEnergy": "partEstupEnergy",
    "axisAcceleration": "axisAccelation",
    "axisServoMotorEfficiency": "axisServoMotorEfficent",
}
"""spelling that one would expect → spelling as printed"""

TEXTS = ("id", "randomProperty", "randomType")
"""attributes that are no numbers, even when they look like one"""

DRIVE = (
    "pitch_feed_screw",
    "table_mass",
    "workpiece_mass",
    "lead_screw_mass",
    "feed_screw_diameter",
    "coupling_inertia",
    "friction_coefficient_guide",
    "friction_coefficient_bearing",
    "preload_force",
    "viscous_damping_coefficient",
    "gear_reduction_ratio",
    "axis_servo_motor_efficent",
)
"""what the feed drive needs: all of it, or there is none"""

STATES = (
    "batch_setup_time",
    "batch_setup_energy",
    "part_setup_time",
    "part_estup_energy",
    "part_ejection_time",
    "part_ejection_energy",
    "batch_ejection_time",
    "batch_ejection_energy",
)
"""what the handling states need: all of it, or there are none"""

UNIFORM = "Uniform"

REMARKS = (
    "basicRapidSpeed is read in hundredths of a metre per minute; the form gives no unit.",
    "angularAcceleration is read in rev/s²; the form gives no unit, Table 1 says rad/s².",
    "pitchFeedScrew is read as a lead in m per revolution; Table 1 says m/rad, but the torques "
    "of the paper divide by 2π.",
    "feedScrewDiameter is read in m. The form gives no inertia of the servomotor; none is "
    "added.",
    "axisAccelation is read in m/s² and holds for X, Y and Z alike.",
    "pDefaultLoad, pDefaultCool and the attributes called Energy are read as powers in W: as "
    "energies in J the setup would draw less than the basic load.",
    "The form gives no motor power, spindle speed range, travel, greatest feed, block time or "
    "tool change time: these do not limit; 1000 kW stands for the motor power.",
    "rotorDiameter, rotorLength and frictionCoefficient are checked but not used: 0.2 N·s/mm² "
    "is no viscosity of air or oil and the gap is missing, so they give no running torque.",
    "gravity is checked but not used.",
)

RANDOM_REMARKS = (
    "randomProperty is read as half-widths of a uniform deviation of motor powers, in traverse "
    "and in feed movements: section 4.1 calls them standard deviations, section 4.2 says "
    "uniform.",
    "The form gives no scatter of setup and ejection times; the greater half-width of "
    "randomProperty is taken, as the times of Fig. 11 differ by up to 9 % from those of "
    "Fig. 5.",
)


class MachineElement(FileTable, rename="camel", frozen=True, kw_only=True):
    """The ``Machine`` element; no model uses gravity."""

    id: str
    random_property: str | None = None
    random_type: str | None = None
    axis_accelation: Annotated[float, quantity(0.01, 100, "m/s²")]
    basic_rapid_speed: Annotated[float, quantity(10, 30_000, "1/100 m/min")]
    angular_acceleration: SpindleAcceleration
    application_inertia: Inertia
    rotor_inertia: Inertia
    spindle_motor_efficiency: Efficiency
    p_default_load: AuxiliaryPower
    p_default_cool: AuxiliaryPower
    part_setup_time: StateTime | None = None
    part_ejection_time: StateTime | None = None
    batch_setup_time: StateTime | None = None
    batch_ejection_time: StateTime | None = None
    part_estup_energy: AuxiliaryPower | None = None
    part_ejection_energy: AuxiliaryPower | None = None
    batch_setup_energy: AuxiliaryPower | None = None
    batch_ejection_energy: AuxiliaryPower | None = None
    gravity: Annotated[float, quantity(9.7, 9.9, "m/s²")] | None = None
    rotor_diameter: RotorSize | None = None
    rotor_length: RotorSize | None = None
    friction_coefficient: Annotated[float, quantity(0, 1e4, "N·s/mm²")] | None = None
    pitch_feed_screw: Annotated[float, quantity(1e-4, 0.5, "m/rev")] | None = None
    table_mass: MovedMass | None = None
    workpiece_mass: Mass | None = None
    lead_screw_mass: Mass | None = None
    feed_screw_diameter: Annotated[float, quantity(1e-3, 0.5, "m")] | None = None
    coupling_inertia: DriveInertia | None = None
    friction_coefficient_guide: Friction | None = None
    friction_coefficient_bearing: Friction | None = None
    preload_force: Preload | None = None
    viscous_damping_coefficient: Viscous | None = None
    gear_reduction_ratio: GearRatio | None = None
    axis_servo_motor_efficent: Efficiency | None = None

    def __post_init__(self) -> None:
        if self.random_type not in {None, UNIFORM}:
            raise KeyFault("randomType", f"'{self.random_type}' is not one of {UNIFORM}")
        if (self.random_type is None) is not (self.random_property is None):
            absent = "randomType" if self.random_type is None else "randomProperty"
            present = "randomProperty" if self.random_type is None else "randomType"
            raise KeyFault(absent, f"missing; expected together with {present}")
        if self.random_property is not None:
            half_widths(self.random_property)


def half_widths(text: str) -> tuple[float, float]:
    """Half-widths of the deviation in traverse and in feed of ``randomProperty``.

    Raises
    ------
    KeyFault
        The text is not two numbers between 0 and 1.
    """
    try:
        traverse, feed = (float(part) for part in text.split(";"))
    except ValueError:
        traverse = feed = nan
    if not (0.0 <= traverse <= 1.0 and 0.0 <= feed <= 1.0):
        expected = "two half-widths, in traverse;feed, each 0 to 1"
        raise KeyFault("randomProperty", f"'{text}' is not {expected}") from None
    return traverse, feed


def read_machine_xml(path: Path) -> Machine:
    """Machine of an XML file, in canonical units.

    Raises
    ------
    LibraryError
        The file cannot be read, or an attribute is missing, unknown or out of its range.
    """
    element = converted(_attributes(path), MachineElement, path, name="Machine")
    acceleration = speed_from_m_s(element.axis_accelation)
    rapid = speed_from_m_min(element.basic_rapid_speed / RAPID_UNITS_PER_M_MIN)
    drive, lacking = _drive(element)
    handling, stateless = _handling(element, path.name)
    deviation = _deviation(element, path.name)
    return Machine(
        name=path.stem,
        title=element.id,
        kind=MachineKind.MILL,
        spindle=_spindle(element),
        axes=tuple(
            _axis(name, rapid=rapid, acceleration=acceleration, drive=drive) for name in "XYZ"
        ),
        rapid=rapid,
        max_feed=None,
        max_cutting_force=None,
        max_axial_depth=None,
        block_time=None,
        base_power=element.p_default_load,
        coolant_power=element.p_default_cool,
        tool_change=0.0,
        source=f"{path.name}, in the XML form of paper 003, Fig. 5",
        remarks=(
            *_kind_remark(element.id),
            *lacking,
            *stateless,
            *REMARKS,
            *(RANDOM_REMARKS if deviation is not None else ()),
        ),
        handling=handling,
        deviation=deviation,
    )


def _spindle(element: MachineElement) -> Spindle:
    """Main drive; the form names no motor power, so the power does not limit."""
    return Spindle(
        curve=(SpindlePoint(speed=1.0, power=UNLIMITED_POWER),),
        efficiency=element.spindle_motor_efficiency,
        min_speed=None,
        max_speed=None,
        acceleration=element.angular_acceleration,
        inertia=element.application_inertia + element.rotor_inertia,
    )


def _drive(element: MachineElement) -> tuple[AxisDrive | None, tuple[str, ...]]:
    """Feed drive of every axis, or none and the remark that says why."""
    given, absent = _present_values(element, DRIVE)
    if absent:
        return None, (f"Without {absent} the feed drives are unknown: axes draw no power.",)
    drive = AxisDrive(
        lead=MM_PER_M * given["pitch_feed_screw"],
        table_mass=given["table_mass"],
        workpiece_mass=given["workpiece_mass"],
        screw_mass=given["lead_screw_mass"],
        screw_diameter=MM_PER_M * given["feed_screw_diameter"],
        coupling_inertia=given["coupling_inertia"],
        guide_friction=given["friction_coefficient_guide"],
        bearing_friction=given["friction_coefficient_bearing"],
        preload=given["preload_force"],
        viscous=nmm_from_nm(given["viscous_damping_coefficient"]),
        gear_ratio=given["gear_reduction_ratio"],
        efficiency=given["axis_servo_motor_efficent"],
    )
    return drive, ()


def _present_values(
    element: MachineElement, keys: tuple[str, ...]
) -> tuple[dict[str, float], str]:
    """Values of the keys that are given, and the printed names of those that are absent."""
    printed = dict(
        zip(element.__struct_fields__, element.__struct_encode_fields__, strict=True)
    )
    given = {key: value for key in keys if (value := getattr(element, key)) is not None}
    return given, ", ".join(printed[key] for key in keys if key not in given)


def _handling(element: MachineElement, name: str) -> tuple[Handling | None, tuple[str, ...]]:
    """Handling states, or none and the remark that says why."""
    given, absent = _present_values(element, STATES)
    if absent:
        return None, (f"Without {absent} the times between parts are unknown.",)
    states = [
        HandlingState(time=seconds_from_ms(given[time]), power=given[power])
        for time, power in zip(STATES[::2], STATES[1::2], strict=True)
    ]
    random = element.random_property
    return Handling(
        batch_setup=states[0],
        part_setup=states[1],
        part_ejection=states[2],
        batch_ejection=states[3],
        time_scatter=0.0 if random is None else max(half_widths(random)),
        source=f"{name}, read as powers in W and times in ms",
    ), ()


def _deviation(element: MachineElement, name: str) -> PowerDeviation | None:
    if element.random_property is None:
        return None
    traverse, feed = half_widths(element.random_property)
    return PowerDeviation(feed=feed, traverse=traverse, source=f"{name}, randomProperty")


def _axis(name: str, *, rapid: float, acceleration: float, drive: AxisDrive | None) -> Axis:
    """One of three equal axes of unlimited travel."""
    return Axis(
        name=name,
        travel=(-inf, inf),
        rapid=rapid,
        max_feed=rapid,
        acceleration=acceleration,
        drive=drive,
    )


def _kind_remark(title: str) -> tuple[str, ...]:
    """Note on a name that contradicts the form."""
    if "turning" not in title.lower():
        return ()
    return (f"The machine is called '{title}', but the form describes a mill; read as a mill.",)


def _attributes(path: Path) -> dict[str, float | str]:
    """Attributes of the ``Machine`` element, numbers as numbers, names as printed."""
    from lxml import etree  # noqa: PLC0415 - slow to import, and few machines are XML

    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, huge_tree=False, load_dtd=False
    )
    try:
        root = etree.fromstring(read_bounded(path), parser)
    except etree.XMLSyntaxError as error:
        raise LibraryError(f"is not XML: {error.msg}", path=str(path)) from error
    machine = root if root.tag == "Machine" else root.find(".//Machine")
    if machine is None:
        raise LibraryError("has no Machine element", path=str(path), key="Machine")
    return {
        CORRECTED_SPELLING.get(str(key), str(key)): (
            str(value) if key in TEXTS else _number_or_text(str(value))
        )
        for key, value in machine.attrib.items()
    }


def _number_or_text(value: str) -> float | str:
    """A number where the text is one."""
    try:
        return float(value)
    except ValueError:
        return value
