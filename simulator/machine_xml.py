"""A milling machine from the XML form of paper 003.

The form is one ``Machine`` element whose attributes carry no units. This is the audited
reading: powers in W although their names say energy, the rapid in hundredths of a metre per
minute, the spindle's acceleration in rev/s², the pitch of the feed screw in metres per
revolution, its diameter in metres, times in ms. Each assumption is a remark of the machine. The
names are kept as printed, slips included; the corrected spelling is read too.

References
----------
Lechevalier, Shin, Rachuri, Foufou, Lee, Bouras (2018), "Simulating a virtual machining model
in an agent-based model for advanced analytics", Fig. 5 and Table 1.
"""

from math import inf
from pathlib import Path

from simulator.errors import LibraryError
from simulator.machine_file import (
    AUXILIARY_POWER,
    DRIVE_INERTIA,
    EFFICIENCY,
    FRICTION,
    GEAR_RATIO,
    INERTIA,
    MASS,
    MOVED_MASS,
    PRELOAD,
    SPINDLE_ACCELERATION,
    UNLIMITED_POWER,
    VISCOUS,
)
from simulator.spec import Axis, AxisDrive, Machine, MachineKind, Spindle, SpindlePoint
from simulator.toml_file import Range, Table, read_bounded
from stepnc_model.units import MM_PER_M, nmm_from_nm, speed_from_m_min, speed_from_m_s

RAPID = Range(low=10, high=30_000, unit="1/100 m/min")
STATE_TIME = Range(low=0, high=1e8, unit="ms")
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

UNUSED = {
    "partSetupTime": STATE_TIME,
    "partEjectionTime": STATE_TIME,
    "batchSetupTime": STATE_TIME,
    "batchEjectionTime": STATE_TIME,
    "partEstupEnergy": AUXILIARY_POWER,
    "partEjectionEnergy": AUXILIARY_POWER,
    "batchSetupEnergy": AUXILIARY_POWER,
    "batchEjectionEnergy": AUXILIARY_POWER,
    "gravity": Range(low=9.7, high=9.9, unit="m/s²"),
    "rotorDiameter": Range(low=0, high=1e4, unit="mm"),
    "rotorLength": Range(low=0, high=1e4, unit="mm"),
    "frictionCoefficient": Range(low=0, high=1e4, unit="N·s/mm²"),
}
"""numbers that are checked but used by no model yet"""

DRIVE = {
    "pitchFeedScrew": Range(low=1e-4, high=0.5, unit="m/rev"),
    "tableMass": MOVED_MASS,
    "workpieceMass": MASS,
    "leadScrewMass": MASS,
    "feedScrewDiameter": Range(low=1e-3, high=0.5, unit="m"),
    "couplingInertia": DRIVE_INERTIA,
    "frictionCoefficientGuide": FRICTION,
    "frictionCoefficientBearing": FRICTION,
    "preloadForce": PRELOAD,
    "viscousDampingCoefficient": VISCOUS,
    "gearReductionRatio": GEAR_RATIO,
    "axisServoMotorEfficent": EFFICIENCY,
}
"""what the feed drive needs: all of it, or there is none"""

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
    "gravity, setup and ejection are checked but not used.",
)


def read_machine_xml(path: Path) -> Machine:
    """Machine of an XML file, in canonical units.

    Raises
    ------
    LibraryError
        The file cannot be read, or an attribute is missing, unknown or out of its range.
    """
    table = _attributes(path)
    acceleration = speed_from_m_s(
        table.number("axisAccelation", Range(low=0.01, high=100, unit="m/s²"))
    )
    rapid = speed_from_m_min(table.number("basicRapidSpeed", RAPID) / RAPID_UNITS_PER_M_MIN)
    title = table.text("id")
    drive, lacking = _drive(table)
    for key, allowed in UNUSED.items():
        table.optional_number(key, allowed)
    for key in TEXTS[1:]:
        if key in table:
            table.text(key)
    machine = Machine(
        name=path.stem,
        title=title,
        kind=MachineKind.MILL,
        spindle=_spindle(table),
        axes=tuple(
            _axis(name, rapid=rapid, acceleration=acceleration, drive=drive) for name in "XYZ"
        ),
        rapid=rapid,
        max_feed=None,
        max_cutting_force=None,
        max_axial_depth=None,
        block_time=None,
        base_power=table.number("pDefaultLoad", AUXILIARY_POWER),
        coolant_power=table.number("pDefaultCool", AUXILIARY_POWER),
        tool_change=0.0,
        source=f"{path.name}, in the XML form of paper 003, Fig. 5",
        remarks=(*_kind_remark(title), *lacking, *REMARKS),
    )
    table.finish()
    return machine


def _spindle(table: Table) -> Spindle:
    """Main drive; the form names no motor power, so the power does not limit."""
    parts = (table.number("applicationInertia", INERTIA), table.number("rotorInertia", INERTIA))
    return Spindle(
        curve=(SpindlePoint(speed=1.0, power=UNLIMITED_POWER),),
        efficiency=table.number("spindleMotorEfficiency", EFFICIENCY),
        min_speed=None,
        max_speed=None,
        acceleration=table.number("angularAcceleration", SPINDLE_ACCELERATION),
        inertia=sum(parts),
    )


def _drive(table: Table) -> tuple[AxisDrive | None, tuple[str, ...]]:
    """Feed drive of every axis, or none and the remark that says why."""
    values = {key: table.optional_number(key, allowed) for key, allowed in DRIVE.items()}
    given = {key: value for key, value in values.items() if value is not None}
    if len(given) < len(DRIVE):
        absent = ", ".join(key for key in DRIVE if key not in given)
        return None, (f"Without {absent} the feed drives are unknown: axes draw no power.",)
    drive = AxisDrive(
        lead=MM_PER_M * given["pitchFeedScrew"],
        table_mass=given["tableMass"],
        workpiece_mass=given["workpieceMass"],
        screw_mass=given["leadScrewMass"],
        screw_diameter=MM_PER_M * given["feedScrewDiameter"],
        coupling_inertia=given["couplingInertia"],
        guide_friction=given["frictionCoefficientGuide"],
        bearing_friction=given["frictionCoefficientBearing"],
        preload=given["preloadForce"],
        viscous=nmm_from_nm(given["viscousDampingCoefficient"]),
        gear_ratio=given["gearReductionRatio"],
        efficiency=given["axisServoMotorEfficent"],
    )
    return drive, ()


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


def _attributes(path: Path) -> Table:
    """Attributes of the ``Machine`` element, numbers as numbers, names as printed."""
    from lxml import etree  # noqa: PLC0415 - slow to import, and few machines are XML

    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, huge_tree=False, load_dtd=False
    )
    try:
        root = etree.fromstring(read_bounded(path), parser)
    except etree.XMLSyntaxError as error:
        raise LibraryError(f"is no XML: {error.msg}", path=str(path)) from error
    machine = root if root.tag == "Machine" else root.find(".//Machine")
    if machine is None:
        raise LibraryError("has no Machine element", path=str(path), key="Machine")
    content = {
        CORRECTED_SPELLING.get(str(key), str(key)): (
            str(value) if key in TEXTS else _number_or_text(str(value))
        )
        for key, value in machine.attrib.items()
    }
    return Table(content, path=path, name="Machine")


def _number_or_text(value: str) -> float | str:
    """A number where the text is one."""
    try:
        return float(value)
    except ValueError:
        return value
