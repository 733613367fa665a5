"""A machine from its TOML file.

Ranges are those of any machine tool that cuts metal, from watchmaking to heavy lathes; a
number outside is a slip of the unit. A limit whose key is absent does not limit.
"""

from itertools import pairwise
from math import inf

from simulator.holding_file import read_holdings
from simulator.physics.spindle import curve_segments
from simulator.spec import (
    Axis,
    AxisDrive,
    Machine,
    MachineKind,
    ModeDirection,
    Spindle,
    SpindlePoint,
    VibratingPart,
    VibrationMode,
)
from simulator.toml_file import Range, Table
from stepnc_model.units import (
    n_mm_from_n_um,
    nmm_from_nm,
    rev_s_from_rpm,
    speed_from_mm_min,
    watts_from_kw,
)

SPEED = Range(low=0.1, high=500_000, unit="rpm")
POWER = Range(low=0.001, high=1_000, unit="kW")
AUXILIARY_POWER = Range(low=0, high=100_000, unit="W")
IDLE_POWER_PER_SPEED = Range(low=0, high=10_000, unit="W/(rev/s)")
IDLE_POWER_PER_SPEED_SQUARED = Range(low=0, high=1_000, unit="W/(rev/s)²")
REGENERATION = Range(low=0, high=1)
UNLIMITED_POWER = watts_from_kw(POWER.high)
"""W, stands for the motor power that a source does not give: no cut reaches it"""
TORQUE = Range(low=0.001, high=1_000_000, unit="N·m")
EFFICIENCY = Range(low=0.05, high=1)
SPINDLE_ACCELERATION = Range(low=0.1, high=10_000, unit="rev/s²")
INERTIA = Range(low=1e-7, high=10_000, unit="kg·m²")
FEED = Range(low=1, high=300_000, unit="mm/min")
TRAVEL = Range(low=-100_000, high=100_000, unit="mm")
ACCELERATION = Range(low=10, high=100_000, unit="mm/s²")
JERK = Range(low=100, high=10_000_000, unit="mm/s³")
FORCE = Range(low=1, high=10_000_000, unit="N")
DEPTH = Range(low=0.01, high=1_000, unit="mm")
BLOCK_TIME = Range(low=1e-5, high=1, unit="s")
DELAY = Range(low=0, high=10, unit="s")
TOOL_CHANGE = Range(low=0, high=600, unit="s")
LEAD = Range(low=0.1, high=500, unit="mm")
MOVED_MASS = Range(low=0.1, high=200_000, unit="kg")
MASS = Range(low=0, high=200_000, unit="kg")
SCREW_DIAMETER = Range(low=1, high=500, unit="mm")
DRIVE_INERTIA = Range(low=0, high=100, unit="kg·m²")
FRICTION = Range(low=0, high=1)
PRELOAD = Range(low=0, high=1_000_000, unit="N")
VISCOUS = Range(low=0, high=100, unit="N·m·s/rad")
GEAR_RATIO = Range(low=0.01, high=1_000)
FREQUENCY = Range(low=1, high=50_000, unit="Hz")
DAMPING = Range(low=1e-4, high=0.5)
STIFFNESS = Range(low=0.001, high=10_000, unit="N/µm")
MODE_DIAMETER = Range(low=0.01, high=2_000, unit="mm")


def read_machine(table: Table, *, name: str) -> Machine:
    """Machine of a file's root table, in canonical units.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range.
    """
    kind = table.choice("kind", MachineKind)
    machine = Machine(
        name=name,
        title=table.text("title"),
        kind=kind,
        spindle=_spindle(table.table("spindle")),
        axes=tuple(_axis(row) for row in table.tables("axis")),
        rapid=_feed(table, "rapid_mm_min"),
        max_feed=_feed(table, "max_feed_mm_min"),
        max_cutting_force=table.optional_number("max_cutting_force_n", FORCE),
        max_axial_depth=table.optional_number("max_axial_depth_mm", DEPTH),
        block_time=table.optional_number("block_time_s", BLOCK_TIME),
        base_power=_amount(table, "base_power_w", AUXILIARY_POWER),
        coolant_power=_amount(table, "coolant_power_w", AUXILIARY_POWER),
        tool_change=_amount(table, "tool_change_s", TOOL_CHANGE),
        source=table.text("source"),
        remarks=table.texts("remarks"),
        modes=tuple(_mode(row) for row in table.tables("mode")),
        holdings=read_holdings(table, kind),
        only_stated_limits=table.flag("only_stated_limits"),
    )
    table.finish()
    return machine


def _spindle(table: Table) -> Spindle:
    """Main drive of a ``[spindle]`` table."""
    low, high = table.window("min_speed_rpm", "max_speed_rpm", allowed=SPEED)
    table.text("source")
    spindle = Spindle(
        curve=_curve(table),
        efficiency=table.number("efficiency", EFFICIENCY),
        min_speed=None if low is None else rev_s_from_rpm(low),
        max_speed=None if high is None else rev_s_from_rpm(high),
        acceleration=table.optional_number("acceleration_rev_s2", SPINDLE_ACCELERATION),
        inertia=table.optional_number("inertia_kg_m2", INERTIA),
        idle_power=_amount(table, "idle_power_w", AUXILIARY_POWER),
        idle_power_per_speed=_amount(table, "idle_power_w_per_rev_s", IDLE_POWER_PER_SPEED),
        idle_power_per_speed_squared=_amount(
            table, "idle_power_w_per_rev2_s2", IDLE_POWER_PER_SPEED_SQUARED
        ),
        regeneration=_amount(table, "regeneration", REGENERATION),
        delay=table.optional_number("delay_s", DELAY),
    )
    try:
        curve_segments(spindle)
    except ValueError as error:
        raise table.error("curve", str(error)) from error
    return spindle


def _curve(table: Table) -> tuple[SpindlePoint, ...]:
    """Power curve, ascending in speed."""
    rows = table.tables("curve")
    if not rows:
        raise table.error("curve", "missing; expected at least one [[spindle.curve]] point")
    points = tuple(_point(row) for row in rows)
    for row, (slower, faster) in zip(rows[1:], pairwise(points), strict=True):
        if faster.speed <= slower.speed:
            speed = row.number("speed_rpm", SPEED)
            raise row.error("speed_rpm", f"{speed:g} rpm is not above the point before it")
    return points


def _point(table: Table) -> SpindlePoint:
    """One ``[[spindle.curve]]`` row."""
    torque = table.optional_number("torque_nm", TORQUE)
    return SpindlePoint(
        speed=rev_s_from_rpm(table.number("speed_rpm", SPEED)),
        power=watts_from_kw(table.number("power_kw", POWER)),
        torque=None if torque is None else nmm_from_nm(torque),
    )


def _axis(table: Table) -> Axis:
    """One ``[[axis]]`` row; without ``max_feed_mm_min`` the rapid is the greatest feed."""
    low, high = table.window("travel_min_mm", "travel_max_mm", allowed=TRAVEL)
    rapid = speed_from_mm_min(table.number("rapid_mm_min", FEED))
    max_feed = _feed(table, "max_feed_mm_min")
    return Axis(
        name=table.text("name"),
        travel=(-inf if low is None else low, inf if high is None else high),
        rapid=rapid,
        max_feed=rapid if max_feed is None else max_feed,
        acceleration=table.number("acceleration_mm_s2", ACCELERATION),
        jerk=table.optional_number("jerk_mm_s3", JERK),
        drive=_drive(table.table("drive")) if "drive" in table else None,
    )


def _drive(table: Table) -> AxisDrive:
    """Drive of an ``[axis.drive]`` table; what is absent is 0, the gear 1."""
    table.text("source")
    return AxisDrive(
        lead=table.number("lead_mm", LEAD),
        table_mass=table.number("table_mass_kg", MOVED_MASS),
        workpiece_mass=_amount(table, "workpiece_mass_kg", MASS),
        screw_mass=_amount(table, "screw_mass_kg", MASS),
        screw_diameter=table.number("screw_diameter_mm", SCREW_DIAMETER),
        coupling_inertia=_amount(table, "coupling_inertia_kg_m2", DRIVE_INERTIA),
        motor_inertia=_amount(table, "motor_inertia_kg_m2", DRIVE_INERTIA),
        guide_friction=table.number("guide_friction", FRICTION),
        bearing_friction=_amount(table, "bearing_friction", FRICTION),
        preload=_amount(table, "preload_n", PRELOAD),
        viscous=nmm_from_nm(_amount(table, "viscous_nm_s_per_rad", VISCOUS)),
        gear_ratio=table.optional_number("gear_ratio", GEAR_RATIO) or 1.0,
        efficiency=table.number("efficiency", EFFICIENCY),
        regeneration=_amount(table, "regeneration", REGENERATION),
    )


def _mode(table: Table) -> VibrationMode:
    """One ``[[mode]]`` row; a mode of a tool says of which."""
    part = table.choice("part", VibratingPart)
    tool = table.text("tool").strip() if "tool" in table else ""
    diameter = table.optional_number("tool_diameter_mm", MODE_DIAMETER)
    is_named = bool(tool) or diameter is not None
    if part is VibratingPart.TOOL and not is_named:
        raise table.error("tool", "missing; expected the tool's id, or tool_diameter_mm")
    if part is VibratingPart.WORKPIECE and is_named:
        raise table.error("tool", "a mode of the workpiece belongs to no tool")
    return VibrationMode(
        part=part,
        tool=tool,
        tool_diameter=diameter,
        direction=table.choice("direction", ModeDirection),
        natural_frequency=table.number("frequency_hz", FREQUENCY),
        damping_ratio=table.number("damping_ratio", DAMPING),
        stiffness=n_mm_from_n_um(table.number("stiffness_n_um", STIFFNESS)),
        source=table.text("source"),
    )


def _amount(table: Table, key: str, allowed: Range) -> float:
    """Number of an optional key; 0 when it is absent."""
    return table.optional_number(key, allowed) or 0.0


def _feed(table: Table, key: str) -> float | None:
    """Feed in mm/s of an optional key in mm/min."""
    value = table.optional_number(key, FEED)
    return None if value is None else speed_from_mm_min(value)
