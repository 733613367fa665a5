"""Machine files in TOML: read and written.

Ranges are those of any machine tool that cuts metal, from watchmaking to heavy lathes; a
number outside is a slip of the unit. A limit whose key is absent does not limit. The machine's
source stands in each table that needs one, as only the sources of the machine, its handling
states, power deviation, modes and work-holding are kept.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import inf, isinf
from pathlib import Path
from typing import Annotated

from simulator.files.cost_file import CostTable, cost_table
from simulator.files.handling_file import (
    DeviationTable,
    HandlingTable,
    deviation_table,
    handling_table,
)
from simulator.files.holding_file import HoldingRow, holding_row, require_distinct, require_kind
from simulator.files.mode_file import ModeRow, modes_toml
from simulator.files.toml_file import (
    FileTable,
    KeyFault,
    quantity,
    read_toml,
    require_window,
    shortest,
    written,
)
from simulator.physics.spindle import curve_segments
from simulator.planner_settings import PlannerSettings
from simulator.spec import (
    Axis,
    AxisDrive,
    Machine,
    MachineKind,
    Spindle,
    SpindlePoint,
)
from stepnc_model.units import (
    kw_from_watts,
    mm_min_from_speed,
    nm_from_nmm,
    nmm_from_nm,
    rev_s_from_rpm,
    rpm_from_rev_s,
    speed_from_mm_min,
    watts_from_kw,
)

MOST_KW = 1_000.0

Rpm = Annotated[float, quantity(0.1, 500_000, "rpm")]
Kilowatts = Annotated[float, quantity(0.001, MOST_KW, "kW")]
AuxiliaryPower = Annotated[float, quantity(0, 100_000, "W")]
IdlePowerPerSpeed = Annotated[float, quantity(0, 10_000, "W/(rev/s)")]
IdlePowerPerSpeedSquared = Annotated[float, quantity(0, 1_000, "W/(rev/s)²")]
Regeneration = Annotated[float, quantity(0, 1)]
Torque = Annotated[float, quantity(0.001, 1_000_000, "N·m")]
Efficiency = Annotated[float, quantity(0.05, 1)]
SpindleAcceleration = Annotated[float, quantity(0.1, 10_000, "rev/s²")]
Inertia = Annotated[float, quantity(1e-7, 10_000, "kg·m²")]
Feed = Annotated[float, quantity(1, 300_000, "mm/min")]
Travel = Annotated[float, quantity(-100_000, 100_000, "mm")]
Acceleration = Annotated[float, quantity(10, 100_000, "mm/s²")]
Jerk = Annotated[float, quantity(100, 10_000_000, "mm/s³")]
CuttingForce = Annotated[float, quantity(1, 10_000_000, "N")]
AxialDepth = Annotated[float, quantity(0.01, 1_000, "mm")]
BlockTime = Annotated[float, quantity(1e-5, 1, "s")]
FeedOverride = Annotated[float, quantity(0.1, 10)]
ServoPeriod = Annotated[float, quantity(1e-5, 0.1, "s")]
BlockLength = Annotated[float, quantity(1e-3, 100, "mm")]
FeedChange = Annotated[float, quantity(0, 1)]
Delay = Annotated[float, quantity(0, 10, "s")]
ToolChange = Annotated[float, quantity(0, 600, "s")]
Lead = Annotated[float, quantity(0.1, 500, "mm")]
MovedMass = Annotated[float, quantity(0.1, 200_000, "kg")]
Mass = Annotated[float, quantity(0, 200_000, "kg")]
ScrewDiameter = Annotated[float, quantity(1, 500, "mm")]
DriveInertia = Annotated[float, quantity(0, 100, "kg·m²")]
Friction = Annotated[float, quantity(0, 1)]
Preload = Annotated[float, quantity(0, 1_000_000, "N")]
Viscous = Annotated[float, quantity(0, 100, "N·m·s/rad")]
GearRatio = Annotated[float, quantity(0.01, 1_000)]

UNLIMITED_POWER = watts_from_kw(MOST_KW)
"""W, stands for the motor power that a source does not give: no cut reaches it"""


class PointRow(FileTable, frozen=True, kw_only=True):
    """One ``[[spindle.curve]]`` row."""

    speed_rpm: Rpm
    power_kw: Kilowatts
    torque_nm: Torque | None = None

    @property
    def point(self) -> SpindlePoint:
        """Point of the curve in canonical units."""
        torque = self.torque_nm
        return SpindlePoint(
            speed=rev_s_from_rpm(self.speed_rpm),
            power=watts_from_kw(self.power_kw),
            torque=None if torque is None else nmm_from_nm(torque),
        )


class SpindleTable(FileTable, frozen=True, kw_only=True):
    """The ``[spindle]`` table and its curve, ascending in speed."""

    efficiency: Efficiency
    min_speed_rpm: Rpm | None = None
    max_speed_rpm: Rpm | None = None
    acceleration_rev_s2: SpindleAcceleration | None = None
    inertia_kg_m2: Inertia | None = None
    idle_power_w: AuxiliaryPower = 0.0
    idle_power_w_per_rev_s: IdlePowerPerSpeed = 0.0
    idle_power_w_per_rev2_s2: IdlePowerPerSpeedSquared = 0.0
    regeneration: Regeneration = 0.0
    delay_s: Delay | None = None
    source: str
    curve: tuple[PointRow, ...] = ()

    def __post_init__(self) -> None:
        require_window(self, "min_speed_rpm", "max_speed_rpm")
        if not self.curve:
            raise KeyFault("curve", "missing; expected at least one [[spindle.curve]] point")
        for row, (slower, faster) in enumerate(pairwise(self.curve), start=2):
            if rev_s_from_rpm(faster.speed_rpm) <= rev_s_from_rpm(slower.speed_rpm):
                raise KeyFault(
                    f"curve[{row}].speed_rpm",
                    f"{faster.speed_rpm:g} rpm is not above the point before it",
                )
        try:
            curve_segments(self.spindle)
        except ValueError as error:
            raise KeyFault("curve", str(error)) from error

    @property
    def spindle(self) -> Spindle:
        """Main drive in canonical units."""
        low, high = self.min_speed_rpm, self.max_speed_rpm
        return Spindle(
            curve=tuple(row.point for row in self.curve),
            efficiency=self.efficiency,
            min_speed=None if low is None else rev_s_from_rpm(low),
            max_speed=None if high is None else rev_s_from_rpm(high),
            acceleration=self.acceleration_rev_s2,
            inertia=self.inertia_kg_m2,
            idle_power=self.idle_power_w,
            idle_power_per_speed=self.idle_power_w_per_rev_s,
            idle_power_per_speed_squared=self.idle_power_w_per_rev2_s2,
            regeneration=self.regeneration,
            delay=self.delay_s,
        )


class DriveTable(FileTable, frozen=True, kw_only=True):
    """The ``[axis.drive]`` table of the axis before it; what is absent is 0, the gear 1."""

    lead_mm: Lead
    table_mass_kg: MovedMass
    workpiece_mass_kg: Mass = 0.0
    screw_mass_kg: Mass = 0.0
    screw_diameter_mm: ScrewDiameter
    coupling_inertia_kg_m2: DriveInertia = 0.0
    motor_inertia_kg_m2: DriveInertia = 0.0
    guide_friction: Friction
    bearing_friction: Friction = 0.0
    preload_n: Preload = 0.0
    viscous_nm_s_per_rad: Viscous = 0.0
    gear_ratio: GearRatio = 1.0
    efficiency: Efficiency
    regeneration: Regeneration = 0.0
    source: str

    @property
    def drive(self) -> AxisDrive:
        """Feed drive in canonical units."""
        return AxisDrive(
            lead=self.lead_mm,
            table_mass=self.table_mass_kg,
            workpiece_mass=self.workpiece_mass_kg,
            screw_mass=self.screw_mass_kg,
            screw_diameter=self.screw_diameter_mm,
            coupling_inertia=self.coupling_inertia_kg_m2,
            motor_inertia=self.motor_inertia_kg_m2,
            guide_friction=self.guide_friction,
            bearing_friction=self.bearing_friction,
            preload=self.preload_n,
            viscous=nmm_from_nm(self.viscous_nm_s_per_rad),
            gear_ratio=self.gear_ratio,
            efficiency=self.efficiency,
            regeneration=self.regeneration,
        )


class AxisRow(FileTable, frozen=True, kw_only=True):
    """One ``[[axis]]`` row; without ``max_feed_mm_min`` the rapid is the greatest feed."""

    name: str
    travel_min_mm: Travel | None = None
    travel_max_mm: Travel | None = None
    rapid_mm_min: Feed
    max_feed_mm_min: Feed | None = None
    acceleration_mm_s2: Acceleration
    jerk_mm_s3: Jerk | None = None
    drive: DriveTable | None = None

    def __post_init__(self) -> None:
        require_window(self, "travel_min_mm", "travel_max_mm")

    @property
    def axis(self) -> Axis:
        """Axis in canonical units; an end of travel without a key is infinite."""
        low, high, max_feed = self.travel_min_mm, self.travel_max_mm, self.max_feed_mm_min
        return Axis(
            name=self.name,
            travel=(-inf if low is None else low, inf if high is None else high),
            rapid=speed_from_mm_min(self.rapid_mm_min),
            max_feed=speed_from_mm_min(self.rapid_mm_min if max_feed is None else max_feed),
            acceleration=self.acceleration_mm_s2,
            jerk=self.jerk_mm_s3,
            drive=None if self.drive is None else self.drive.drive,
        )


class PlannerTable(FileTable, frozen=True, kw_only=True):
    """The ``[linuxcnc]`` table: what the INI file of its control says."""

    max_feed_override: FeedOverride = 1.0
    servo_period_s: ServoPeriod = 0.001

    @property
    def planner(self) -> PlannerSettings:
        """Settings in canonical units."""
        return PlannerSettings(
            max_feed_override=self.max_feed_override, servo_period=self.servo_period_s
        )


class MachineFile(FileTable, frozen=True, kw_only=True):
    """A whole machine file."""

    title: str
    kind: MachineKind
    only_stated_limits: bool = False
    rapid_mm_min: Feed | None = None
    max_feed_mm_min: Feed | None = None
    max_cutting_force_n: CuttingForce | None = None
    max_axial_depth_mm: AxialDepth | None = None
    block_time_s: BlockTime | None = None
    block_time_source: str = ""
    least_block_mm: BlockLength | None = None
    least_feed_change: FeedChange | None = None
    base_power_w: AuxiliaryPower = 0.0
    coolant_power_w: AuxiliaryPower = 0.0
    tool_change_s: ToolChange = 0.0
    source: str
    remarks: tuple[str, ...] = ()
    spindle: SpindleTable
    axis: tuple[AxisRow, ...] = ()
    handling: HandlingTable | None = None
    cost: CostTable | None = None
    deviation: DeviationTable | None = None
    linuxcnc: PlannerTable = PlannerTable()
    holding: tuple[HoldingRow, ...] = ()
    mode: tuple[ModeRow, ...] = ()

    def __post_init__(self) -> None:
        require_distinct(self.holding)
        require_kind(self.holding, self.kind)

    def machine(self, name: str) -> Machine:
        """Machine in canonical units."""
        rapid, max_feed = self.rapid_mm_min, self.max_feed_mm_min
        return Machine(
            name=name,
            title=self.title,
            kind=self.kind,
            spindle=self.spindle.spindle,
            axes=tuple(row.axis for row in self.axis),
            rapid=None if rapid is None else speed_from_mm_min(rapid),
            max_feed=None if max_feed is None else speed_from_mm_min(max_feed),
            max_cutting_force=self.max_cutting_force_n,
            max_axial_depth=self.max_axial_depth_mm,
            block_time=self.block_time_s,
            block_time_source=self.block_time_source,
            least_block=self.least_block_mm,
            least_feed_change=self.least_feed_change,
            base_power=self.base_power_w,
            coolant_power=self.coolant_power_w,
            tool_change=self.tool_change_s,
            source=self.source,
            remarks=self.remarks,
            modes=tuple(row.mode for row in self.mode),
            holdings=tuple(row.holding for row in self.holding),
            handling=None if self.handling is None else self.handling.handling,
            deviation=None if self.deviation is None else self.deviation.deviation,
            only_stated_limits=self.only_stated_limits,
            planner=self.linuxcnc.planner,
            costs=None if self.cost is None else self.cost.rates,
        )


def read_machine(path: Path) -> Machine:
    """Machine of a TOML file, in canonical units, named as the file.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range.
    """
    return read_toml(path, MachineFile).machine(path.stem)


def machine_toml(machine: Machine, *, notes: Sequence[str] = ()) -> str:
    """TOML text of a machine, in which it reads back equal.

    Each number stands in the unit of its key and as short as it can be without changing the
    canonical value.

    Parameters
    ----------
    machine : Machine
        Its name is that of the file and not written.
    notes : sequence of str
        Comment lines at the top: where values come from, how sure they are.

    Returns
    -------
    str
    """
    content = MachineFile(
        title=machine.title,
        kind=machine.kind,
        only_stated_limits=machine.only_stated_limits,
        rapid_mm_min=_mm_min(machine.rapid),
        max_feed_mm_min=_mm_min(machine.max_feed),
        max_cutting_force_n=machine.max_cutting_force,
        max_axial_depth_mm=machine.max_axial_depth,
        block_time_s=machine.block_time,
        block_time_source=machine.block_time_source,
        least_block_mm=machine.least_block,
        least_feed_change=machine.least_feed_change,
        base_power_w=machine.base_power,
        coolant_power_w=machine.coolant_power,
        tool_change_s=machine.tool_change,
        source=machine.source,
        remarks=machine.remarks,
        spindle=_spindle_table(machine.spindle, machine.source),
        axis=tuple(_axis_row(axis, machine.source) for axis in machine.axes),
        handling=None if machine.handling is None else handling_table(machine.handling),
        cost=cost_table(machine.costs),
        deviation=None if machine.deviation is None else deviation_table(machine.deviation),
        linuxcnc=PlannerTable(
            max_feed_override=machine.planner.max_feed_override,
            servo_period_s=machine.planner.servo_period,
        ),
        holding=tuple(map(holding_row, machine.holdings)),
    )
    lines = [f"# {_comment(line)}".rstrip() for note in notes for line in note.splitlines()]
    return "\n".join((*lines, *written(content))) + "\n" + modes_toml(machine.modes)


def _comment(line: str) -> str:
    """A line that TOML takes as a comment."""
    return "".join(sign if sign.isprintable() else " " for sign in line)


def _spindle_table(spindle: Spindle, source: str) -> SpindleTable:
    return SpindleTable(
        efficiency=spindle.efficiency,
        min_speed_rpm=_rpm(spindle.min_speed),
        max_speed_rpm=_rpm(spindle.max_speed),
        acceleration_rev_s2=spindle.acceleration,
        inertia_kg_m2=spindle.inertia,
        idle_power_w=spindle.idle_power,
        idle_power_w_per_rev_s=spindle.idle_power_per_speed,
        idle_power_w_per_rev2_s2=spindle.idle_power_per_speed_squared,
        regeneration=spindle.regeneration,
        delay_s=spindle.delay,
        source=source,
        curve=tuple(
            PointRow(
                speed_rpm=shortest(point.speed, rpm_from_rev_s, rev_s_from_rpm),
                power_kw=shortest(point.power, kw_from_watts, watts_from_kw),
                torque_nm=None if point.torque is None else _nm(point.torque),
            )
            for point in spindle.curve
        ),
    )


def _axis_row(axis: Axis, source: str) -> AxisRow:
    low, high = axis.travel
    return AxisRow(
        name=axis.name,
        travel_min_mm=None if isinf(low) else low,
        travel_max_mm=None if isinf(high) else high,
        rapid_mm_min=shortest(axis.rapid, mm_min_from_speed, speed_from_mm_min),
        max_feed_mm_min=_mm_min(axis.max_feed),
        acceleration_mm_s2=axis.acceleration,
        jerk_mm_s3=axis.jerk,
        drive=None if axis.drive is None else _drive_table(axis.drive, source),
    )


def _drive_table(drive: AxisDrive, source: str) -> DriveTable:
    return DriveTable(
        lead_mm=drive.lead,
        table_mass_kg=drive.table_mass,
        workpiece_mass_kg=drive.workpiece_mass,
        screw_mass_kg=drive.screw_mass,
        screw_diameter_mm=drive.screw_diameter,
        coupling_inertia_kg_m2=drive.coupling_inertia,
        motor_inertia_kg_m2=drive.motor_inertia,
        guide_friction=drive.guide_friction,
        bearing_friction=drive.bearing_friction,
        preload_n=drive.preload,
        viscous_nm_s_per_rad=_nm(drive.viscous),
        gear_ratio=drive.gear_ratio,
        efficiency=drive.efficiency,
        regeneration=drive.regeneration,
        source=source,
    )


def _mm_min(speed: float | None) -> float | None:
    return None if speed is None else shortest(speed, mm_min_from_speed, speed_from_mm_min)


def _rpm(speed: float | None) -> float | None:
    return None if speed is None else shortest(speed, rpm_from_rev_s, rev_s_from_rpm)


def _nm(torque: float) -> float:
    """N·m, or a unit with N·m in it, of the same with N·mm."""
    return shortest(torque, nm_from_nmm, nmm_from_nm)
