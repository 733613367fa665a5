"""A machine as the text of a library file, in which it reads back equal.

Each number stands in the unit of its key and as short as it can be without changing the
canonical value. Only the sources of the machine, its modes and its work-holding are known;
the machine's stands in all other tables.
"""

import json
from collections.abc import Callable, Sequence
from math import inf, isinf, nextafter

from simulator.holding_file import HoldingKind
from simulator.spec import (
    Axis,
    AxisDrive,
    Machine,
    Spindle,
    SpindlePoint,
    VibrationMode,
)
from simulator.work_holding import (
    Chuck,
    Clamp,
    Holding,
)
from stepnc_model.units import (
    kn_from_newtons,
    kw_from_watts,
    mm_min_from_speed,
    n_mm_from_n_um,
    n_um_from_n_mm,
    newtons_from_kn,
    nm_from_nmm,
    nmm_from_nm,
    rev_s_from_rpm,
    rpm_from_rev_s,
    speed_from_mm_min,
    watts_from_kw,
)

Conversion = Callable[[float], float]

MOST_DIGITS = 17
"""significant digits that tell any two floats apart"""


def machine_toml(machine: Machine, *, notes: Sequence[str] = ()) -> str:
    """TOML text of a machine.

    A value that no number in the unit of its key converts to (the last bit of a quotient by
    60) is written as the nearest one.

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
    lines = [f"# {_comment(line)}".rstrip() for note in notes for line in note.splitlines()]
    lines += _root(machine)
    lines += _spindle(machine.spindle, machine.source)
    for axis in machine.axes:
        lines += _axis(axis, machine.source)
    for holding in machine.holdings:
        lines += _chuck(holding) if isinstance(holding, Chuck) else _clamp(holding)
    return "\n".join(lines) + "\n" + modes_toml(machine.modes)


def modes_toml(modes: Sequence[VibrationMode]) -> str:
    """TOML text of measured modes, a ``[[mode]]`` table each; ends a machine file."""
    return "".join("\n".join(_mode(mode)) + "\n" for mode in modes)


def _comment(line: str) -> str:
    """A line that TOML takes as a comment."""
    return "".join(sign if sign.isprintable() else " " for sign in line)


def _root(machine: Machine) -> list[str]:
    """Keys above all tables."""
    lines = [
        f"title = {_text(machine.title)}",
        f"kind = {_text(machine.kind.value)}",
        *(["only_stated_limits = true"] if machine.only_stated_limits else []),
        *_feed("rapid_mm_min", machine.rapid),
        *_feed("max_feed_mm_min", machine.max_feed),
        *_number("max_cutting_force_n", machine.max_cutting_force),
        *_number("max_axial_depth_mm", machine.max_axial_depth),
        *_number("block_time_s", machine.block_time),
        *_number("base_power_w", machine.base_power),
        *_number("coolant_power_w", machine.coolant_power),
        *_number("tool_change_s", machine.tool_change),
        f"source = {_text(machine.source)}",
    ]
    if machine.remarks:
        lines += ["remarks = [", *(f"    {_text(each)}," for each in machine.remarks), "]"]
    return lines


def _spindle(spindle: Spindle, source: str) -> list[str]:
    """The ``[spindle]`` table and its curve."""
    lines = [
        "",
        "[spindle]",
        *_number("efficiency", spindle.efficiency),
        *_speed("min_speed_rpm", spindle.min_speed),
        *_speed("max_speed_rpm", spindle.max_speed),
        *_number("acceleration_rev_s2", spindle.acceleration),
        *_number("inertia_kg_m2", spindle.inertia),
        *_number("idle_power_w", spindle.idle_power),
        *_number("idle_power_w_per_rev_s", spindle.idle_power_per_speed),
        *_number("idle_power_w_per_rev2_s2", spindle.idle_power_per_speed_squared),
        *_number("regeneration", spindle.regeneration),
        *_number("delay_s", spindle.delay),
        f"source = {_text(source)}",
    ]
    for point in spindle.curve:
        lines += _point(point)
    return lines


def _point(point: SpindlePoint) -> list[str]:
    """One ``[[spindle.curve]]`` row."""
    return [
        "",
        "[[spindle.curve]]",
        *_speed("speed_rpm", point.speed),
        *_number("power_kw", point.power, shown=kw_from_watts, read=watts_from_kw),
        *_torque("torque_nm", point.torque),
    ]


def _axis(axis: Axis, source: str) -> list[str]:
    """One ``[[axis]]`` row and its drive; an end of travel without a bound has no key."""
    low, high = axis.travel
    lines = [
        "",
        "[[axis]]",
        f"name = {_text(axis.name)}",
        *_number("travel_min_mm", None if isinf(low) else low),
        *_number("travel_max_mm", None if isinf(high) else high),
        *_feed("rapid_mm_min", axis.rapid),
        *_feed("max_feed_mm_min", axis.max_feed),
        *_number("acceleration_mm_s2", axis.acceleration),
        *_number("jerk_mm_s3", axis.jerk),
    ]
    return lines if axis.drive is None else lines + _drive(axis.drive, source)


def _drive(drive: AxisDrive, source: str) -> list[str]:
    """The ``[axis.drive]`` table of the axis before it."""
    return [
        "",
        "[axis.drive]",
        *_number("lead_mm", drive.lead),
        *_number("table_mass_kg", drive.table_mass),
        *_number("workpiece_mass_kg", drive.workpiece_mass),
        *_number("screw_mass_kg", drive.screw_mass),
        *_number("screw_diameter_mm", drive.screw_diameter),
        *_number("coupling_inertia_kg_m2", drive.coupling_inertia),
        *_number("motor_inertia_kg_m2", drive.motor_inertia),
        *_number("guide_friction", drive.guide_friction),
        *_number("bearing_friction", drive.bearing_friction),
        *_number("preload_n", drive.preload),
        *_torque("viscous_nm_s_per_rad", drive.viscous),
        *_number("gear_ratio", drive.gear_ratio),
        *_number("efficiency", drive.efficiency),
        *_number("regeneration", drive.regeneration),
        f"source = {_text(source)}",
    ]


def _mode(mode: VibrationMode) -> list[str]:
    """One ``[[mode]]`` row."""
    return [
        "",
        "[[mode]]",
        f"part = {_text(mode.part.value)}",
        *([f"tool = {_text(mode.tool)}"] if mode.tool else []),
        *_number("tool_diameter_mm", mode.tool_diameter),
        f"direction = {_text(mode.direction.value)}",
        *_number("frequency_hz", mode.natural_frequency),
        *_number("damping_ratio", mode.damping_ratio),
        *_number("stiffness_n_um", mode.stiffness, shown=n_um_from_n_mm, read=n_mm_from_n_um),
        f"source = {_text(mode.source)}",
    ]


def _chuck(chuck: Chuck) -> list[str]:
    """The ``[[holding]]`` row of a chuck."""
    told = chuck.has_tailstock
    return [
        *_held(HoldingKind.CHUCK, chuck),
        *_force("clamping_force_kn", chuck.clamping_force),
        *_number("friction", chuck.friction),
        *_number("jaws", chuck.jaws),
        *_number("grip_diameter_mm", chuck.grip_diameter),
        *_number("grip_length_mm", chuck.grip_length),
        *_number("jaw_face_z_mm", chuck.jaw_face),
        *_number("jaw_mass_kg", chuck.jaw_mass or None),
        *_number("jaw_radius_mm", chuck.jaw_radius or None),
        *_force("lost_force_kn", chuck.lost_force or None),
        *_speed("lost_at_rpm", chuck.lost_at or None),
        *_number("safety_factor", chuck.safety_factor),
        *_number("clamping_safety_factor", chuck.clamping_safety_factor),
        *([] if told is None else [f"tailstock = {str(told).lower()}"]),
        f"source = {_text(chuck.source)}",
    ]


def _clamp(clamp: Clamp) -> list[str]:
    """The ``[[holding]]`` row of a vice; clamps hold as it does."""
    return [
        *_held(HoldingKind.VICE, clamp),
        *_force("holding_force_kn", clamp.holding_force),
        *_number("friction", clamp.friction),
        *_number("safety_factor", clamp.safety_factor),
        f"source = {_text(clamp.source)}",
    ]


def _held(kind: HoldingKind, holding: Holding) -> list[str]:
    """First lines of a ``[[holding]]`` table."""
    setup = [f"setup = {_text(holding.setup)}"] if holding.setup else []
    return ["", "[[holding]]", f"kind = {_text(kind.value)}", *setup]


def _text(value: str) -> str:
    """A basic string; JSON's escapes are TOML's, save that TOML escapes DEL as well."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")


def _feed(key: str, value: float | None) -> list[str]:
    """A key in mm/min."""
    return _number(key, value, shown=mm_min_from_speed, read=speed_from_mm_min)


def _speed(key: str, value: float | None) -> list[str]:
    """A key in rpm."""
    return _number(key, value, shown=rpm_from_rev_s, read=rev_s_from_rpm)


def _force(key: str, value: float | None) -> list[str]:
    """A key in kN."""
    return _number(key, value, shown=kn_from_newtons, read=newtons_from_kn)


def _torque(key: str, value: float | None) -> list[str]:
    """A key in N·m, or of a unit with N·m in it."""
    return _number(key, value, shown=nm_from_nmm, read=nmm_from_nm)


def _number(
    key: str, value: float | None, *, shown: Conversion = float, read: Conversion = float
) -> list[str]:
    """The line of a number; none of ``None``."""
    if value is None:
        return []
    number = _shortest(value, shown(value), read)
    return [f"{key} = {int(number) if number.is_integer() else number!r}"]


def _shortest(value: float, guess: float, read: Conversion) -> float:
    """The number of fewest digits that reads as ``value``, or the guess if none does."""
    for digits in range(1, MOST_DIGITS + 1):
        rounded = float(f"{guess:.{digits}g}")
        if read(rounded) == value:
            return rounded
    # Two roundings may land beside the number that was read.
    beside = (nextafter(guess, inf), nextafter(guess, -inf))
    return next((number for number in beside if read(number) == value), guess)
