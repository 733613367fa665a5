"""A machine from its TOML file.

Ranges are those of any machine tool that cuts metal, from watchmaking to heavy lathes; a
number outside is a slip of the unit. A limit whose key is absent does not limit.
"""

from itertools import pairwise
from math import inf

from simulator.physics.spindle import curve_segments
from simulator.spec import Axis, Machine, MachineKind, Spindle, SpindlePoint
from simulator.toml_file import Range, Table
from stepnc_model.units import nmm_from_nm, rev_s_from_rpm, speed_from_mm_min, watts_from_kw

SPEED = Range(low=0.1, high=500_000, unit="rpm")
POWER = Range(low=0.001, high=1_000, unit="kW")
AUXILIARY_POWER = Range(low=0, high=100_000, unit="W")
IDLE_POWER_PER_SPEED = Range(low=0, high=10_000, unit="W/(rev/s)")
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
TOOL_CHANGE = Range(low=0, high=600, unit="s")


def read_machine(table: Table, *, name: str) -> Machine:
    """Machine of a file's root table, in canonical units.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range.
    """
    machine = Machine(
        name=name,
        title=table.text("title"),
        kind=table.choice("kind", MachineKind),
        spindle=_spindle(table.table("spindle")),
        axes=tuple(_axis(row) for row in table.tables("axis")),
        rapid=_feed(table, "rapid_mm_min"),
        max_feed=_feed(table, "max_feed_mm_min"),
        max_cutting_force=table.optional_number("max_cutting_force_n", FORCE),
        max_axial_depth=table.optional_number("max_axial_depth_mm", DEPTH),
        block_time=table.optional_number("block_time_s", BLOCK_TIME),
        base_power=table.optional_number("base_power_w", AUXILIARY_POWER) or 0.0,
        coolant_power=table.optional_number("coolant_power_w", AUXILIARY_POWER) or 0.0,
        tool_change=table.optional_number("tool_change_s", TOOL_CHANGE) or 0.0,
        source=table.text("source"),
        remarks=table.texts("remarks"),
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
        idle_power=table.optional_number("idle_power_w", AUXILIARY_POWER) or 0.0,
        idle_power_per_speed=table.optional_number(
            "idle_power_w_per_rev_s", IDLE_POWER_PER_SPEED
        )
        or 0.0,
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
    )


def _feed(table: Table, key: str) -> float | None:
    """Feed in mm/s of an optional key in mm/min."""
    value = table.optional_number(key, FEED)
    return None if value is None else speed_from_mm_min(value)
