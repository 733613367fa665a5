"""A machine from its TOML file, good and bad."""

from math import inf, pi
from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.library import load_machine, machine_names
from simulator.physics.axis import axis_power, motor_speed
from simulator.physics.spindle import spindle_power
from simulator.spec import (
    AxisDrive,
    Machine,
    MachineKind,
    ModeDirection,
    VibratingPart,
    VibrationMode,
)
from stepnc_model.units import rpm_from_rev_s
from tests.every_case import every_case

GOOD = """
title = "My mill"
kind = "mill"
rapid_mm_min = 30_000
block_time_s = 0.004
source = "name plate"

[spindle]
efficiency = 0.8
min_speed_rpm = 60
max_speed_rpm = 6_000
source = "name plate"

[[spindle.curve]]
speed_rpm = 600
power_kw = 7.5
torque_nm = 95

[[spindle.curve]]
speed_rpm = 6_000
power_kw = 7.5

[[axis]]
name = "X"
rapid_mm_min = 30_000
acceleration_mm_s2 = 3_000
"""

DRIVE = """
[axis.drive]
lead_mm = 12
table_mass_kg = 300
workpiece_mass_kg = 80
screw_mass_kg = 8
screw_diameter_mm = 36
coupling_inertia_kg_m2 = 0.0003
motor_inertia_kg_m2 = 0.005
guide_friction = 0.01
bearing_friction = 0.004
preload_n = 3_000
viscous_nm_s_per_rad = 0.003
gear_ratio = 2
efficiency = 0.9
regeneration = 0.6
source = "drawing"
"""


def machine_of(text: str, folder: Path) -> Machine:
    path = folder / "my.toml"
    path.write_text(text, encoding="utf-8")
    return load_machine(str(path))


def test_a_users_own_file_is_read_in_canonical_units(tmp_path: Path) -> None:
    machine = machine_of(GOOD, tmp_path)
    assert (machine.name, machine.kind, machine.rapid) == ("my", MachineKind.MILL, 500.0)
    assert (machine.spindle.min_speed, machine.spindle.max_speed) == (1.0, 100.0)
    first = machine.spindle.curve[0]
    assert (first.speed, first.power, first.torque) == (10.0, 7500.0, 95_000.0)


def test_what_a_file_does_not_say_does_not_limit(tmp_path: Path) -> None:
    machine = machine_of(GOOD, tmp_path)
    assert machine.max_feed is None
    assert machine.max_cutting_force is None
    assert machine.spindle.acceleration is None
    assert machine.axes[0].travel == (-inf, inf)
    assert machine.axes[0].max_feed == machine.axes[0].rapid
    assert machine.base_power == machine.tool_change == 0.0


def test_a_feed_drive_is_read_in_canonical_units(tmp_path: Path) -> None:
    assert machine_of(GOOD + DRIVE, tmp_path).axes[0].drive == AxisDrive(
        lead=12.0,
        table_mass=300.0,
        workpiece_mass=80.0,
        screw_mass=8.0,
        screw_diameter=36.0,
        coupling_inertia=0.0003,
        motor_inertia=0.005,
        guide_friction=0.01,
        bearing_friction=0.004,
        preload=3000.0,
        viscous=3.0,
        gear_ratio=2.0,
        efficiency=0.9,
        regeneration=0.6,
    )


def test_an_axis_without_a_drive_has_none(tmp_path: Path) -> None:
    assert machine_of(GOOD, tmp_path).axes[0].drive is None


def test_losses_and_regeneration_of_the_spindle_are_read(tmp_path: Path) -> None:
    losses = "idle_power_w_per_rev2_s2 = 0.02\nregeneration = 0.7\nmin_speed_rpm"
    spindle = machine_of(GOOD.replace("min_speed_rpm", losses, 1), tmp_path).spindle
    assert (spindle.idle_power_per_speed_squared, spindle.regeneration) == (0.02, 0.7)


def test_a_spindle_without_a_curve_is_told(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="curve: missing; expected at least one"):
        machine_of(GOOD[: GOOD.index("[[spindle.curve]]")], tmp_path)


def test_a_step_in_the_curve_is_told_before_anything_is_cut(tmp_path: Path) -> None:
    step = "[[spindle.curve]]\nspeed_rpm = 6_000.001\npower_kw = 5\n\n[[axis]]"
    with pytest.raises(LibraryError, match=r"spindle.curve: .*move the two points apart"):
        machine_of(GOOD.replace("[[axis]]", step), tmp_path)


@every_case(
    ("good", "bad", "key", "word"),
    [
        ("efficiency = 0.8", "efficiency = 1.2", "spindle.efficiency", "exceeds 1"),
        ("efficiency = 0.8", "", "spindle.efficiency", "missing"),
        (
            "power_kw = 7.5\ntor",
            "power_kw = -1\ntor",
            "spindle.curve[1].power_kw",
            "below 0.001",
        ),
        (
            "power_kw = 7.5\ntor",
            "power_kw = nan\ntor",
            "spindle.curve[1].power_kw",
            "finite",
        ),
        (
            "power_kw = 7.5\ntor",
            "power_kw = '7'\ntor",
            "spindle.curve[1].power_kw",
            "not a number",
        ),
        (
            "power_kw = 7.5\ntor",
            "power_w = 7500\ntor",
            "spindle.curve[1].power_w",
            "unknown key",
        ),
        ("speed_rpm = 600\n", "speed_rpm = 6_000\n", "spindle.curve[2].speed_rpm", "not above"),
        ("speed_rpm = 600\n", "speed_rpm = 9_000\n", "spindle.curve[2].speed_rpm", "not above"),
        (
            "min_speed_rpm = 60",
            "min_speed_rpm = 7000",
            "spindle.min_speed_rpm",
            "exceeds max_speed_rpm",
        ),
        ('kind = "mill"', 'kind = "saw"', "kind", "not one of"),
        ("rapid_mm_min = 30_000\nb", "rapid_m_min = 30\nb", "rapid_m_min", "unknown key"),
        ("block_time_s = 0.004", "block_time_s = 4", "block_time_s", "exceeds 1"),
        (
            "acceleration_mm_s2 = 3_000",
            "acceleration_mm_s2 = 3",
            "axis[1].acceleration_mm_s2",
            "below 10",
        ),
        ("[[axis]]", "[[axes]]", "axes", "unknown key"),
        ("[spindle]", "[spindel]", "spindel", "unknown key"),
    ],
)
def test_a_bad_value_is_told_with_key_value_and_bound(
    good: str, bad: str, key: str, word: str, tmp_path: Path
) -> None:
    assert good in GOOD
    with pytest.raises(LibraryError) as caught:
        machine_of(GOOD.replace(good, bad, 1), tmp_path)
    assert caught.value.path == str(tmp_path / "my.toml")
    assert caught.value.key == key
    assert word in caught.value.message


def test_a_refusal_reads_file_key_value_bound_and_unit(tmp_path: Path) -> None:
    with pytest.raises(LibraryError) as caught:
        machine_of(GOOD.replace("power_kw = 7.5\ntor", "power_kw = -1\ntor", 1), tmp_path)
    assert str(caught.value) == (
        f"{tmp_path / 'my.toml'}: spindle.curve[1].power_kw: -1 kW is below 0.001 kW"
    )


@every_case(
    ("good", "bad", "key", "word"),
    [
        ("lead_mm = 12", "lead_mm = 0.012", "axis[1].drive.lead_mm", "below 0.1"),
        ("lead_mm = 12", "", "axis[1].drive.lead_mm", "missing"),
        ("preload_n = 3_000", "preload_kn = 3", "axis[1].drive.preload_kn", "unknown key"),
        ("efficiency = 0.9", "efficiency = 90", "axis[1].drive.efficiency", "exceeds 1"),
        (
            "viscous_nm_s_per_rad = 0.003",
            "viscous_nm_s_per_rad = -1",
            "axis[1].drive.viscous_nm_s_per_rad",
            "below 0",
        ),
        ("gear_ratio = 2", "gear_ratio = 0", "axis[1].drive.gear_ratio", "below 0.01"),
        ("regeneration = 0.6", "regeneration = 1.6", "axis[1].drive.regeneration", "exceeds 1"),
        ('source = "drawing"', "", "axis[1].drive.source", "missing"),
    ],
)
def test_a_bad_drive_is_told(good: str, bad: str, key: str, word: str, tmp_path: Path) -> None:
    assert good in DRIVE
    with pytest.raises(LibraryError) as caught:
        machine_of(GOOD + DRIVE.replace(good, bad, 1), tmp_path)
    assert caught.value.key == key
    assert word in caught.value.message


@pytest.mark.parametrize("name", ["vmc15", "lathe22"])
def test_typical_feed_drives_are_servomotors_that_one_can_buy(name: str) -> None:
    """Up to 3000 rpm; some hundred watts at steady rapid, some kilowatts at its end."""
    for axis in load_machine(name).axes:
        assert axis.drive is not None
        motor_rpm = rpm_from_rev_s(motor_speed(axis.drive, axis.rapid) / (2 * pi))
        assert 1500 <= motor_rpm <= 3000
        assert 150 < axis_power(axis.drive, axis.rapid) < 500
        assert 2000 < axis_power(axis.drive, axis.rapid, axis.acceleration) < 6000


@pytest.mark.parametrize("name", ["vmc15", "lathe22"])
def test_typical_spindles_reach_their_speed_within_twice_their_power(name: str) -> None:
    spindle = load_machine(name).spindle
    assert spindle.max_speed is not None
    assert spindle.acceleration is not None
    peak = spindle_power(spindle, spindle.max_speed, spindle.acceleration)
    greatest = max(point.power for point in spindle.curve)
    assert 0.5 * greatest < peak < 2.0 * greatest


@pytest.mark.parametrize("name", machine_names())
def test_no_spindle_gives_more_at_its_nose_than_its_motor_does(name: str) -> None:
    spindle = load_machine(name).spindle
    for point in spindle.curve:
        if point.torque is not None:
            watts = 2 * pi * point.speed * point.torque / 1000
            assert watts == pytest.approx(spindle.efficiency * point.power, rel=0.01)


MODE = """
[[mode]]
part = "tool"
tool = "END MILL 20MM"
tool_diameter_mm = 20
direction = "xy"
frequency_hz = 922
damping_ratio = 0.011
stiffness_n_um = 1.34
source = "tap test"
"""


def test_measured_modes_are_read_in_canonical_units(tmp_path: Path) -> None:
    (mode,) = machine_of(GOOD + MODE, tmp_path).modes
    assert mode == VibrationMode(
        part=VibratingPart.TOOL,
        tool="END MILL 20MM",
        tool_diameter=20.0,
        direction=ModeDirection.XY,
        natural_frequency=922.0,
        damping_ratio=0.011,
        stiffness=1_340.0,
        source="tap test",
    )
    assert machine_of(GOOD, tmp_path).modes == ()


@every_case(
    ("good", "bad", "key", "word"),
    [
        (
            "frequency_hz = 922",
            "frequency_hz = 0.5",
            "mode[1].frequency_hz",
            "below 1",
        ),
        (
            "damping_ratio = 0.011",
            "damping_ratio = 1.1",
            "mode[1].damping_ratio",
            "exceeds 0.5",
        ),
        (
            "stiffness_n_um = 1.34",
            "stiffness_n_um = 1.34e6",
            "mode[1].stiffness_n_um",
            "exceeds 10000",
        ),
        ("stiffness_n_um", "stiffness", "mode[1].stiffness", "unknown key"),
        ('direction = "xy"', 'direction = "up"', "mode[1].direction", "not one of"),
        ('part = "tool"', 'part = "bed"', "mode[1].part", "not one of"),
        ('part = "tool"', 'part = "workpiece"', "mode[1].tool", "no tool"),
        ('source = "tap test"', "", "mode[1].source", "missing"),
        (
            'tool = "END MILL 20MM"\ntool_diameter_mm = 20\n',
            "",
            "mode[1].tool",
            "missing",
        ),
    ],
)
def test_a_bad_mode_is_told(good: str, bad: str, key: str, word: str, tmp_path: Path) -> None:
    assert good in MODE
    with pytest.raises(LibraryError) as caught:
        machine_of(GOOD + MODE.replace(good, bad), tmp_path)
    assert caught.value.key == key
    assert word in caught.value.message
