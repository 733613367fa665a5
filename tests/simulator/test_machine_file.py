"""A machine from its TOML file, good and bad."""

from math import inf, pi
from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.library import load_machine, machine_names
from simulator.spec import Machine, MachineKind

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


def test_a_spindle_without_a_curve_is_told(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="curve: missing; expected at least one"):
        machine_of(GOOD[: GOOD.index("[[spindle.curve]]")], tmp_path)


def test_a_step_in_the_curve_is_told_before_anything_is_cut(tmp_path: Path) -> None:
    step = "[[spindle.curve]]\nspeed_rpm = 6_000.001\npower_kw = 5\n\n[[axis]]"
    with pytest.raises(LibraryError, match=r"spindle.curve: .*move the two points apart"):
        machine_of(GOOD.replace("[[axis]]", step), tmp_path)


@pytest.mark.parametrize(
    ("good", "bad", "message"),
    [
        ("efficiency = 0.8", "efficiency = 1.2", "spindle.efficiency: 1.2 exceeds 1"),
        ("efficiency = 0.8", "", "spindle.efficiency: missing"),
        (
            "power_kw = 7.5\ntor",
            "power_kw = -1\ntor",
            "curve[1].power_kw: -1 kW is below 0.001 kW",
        ),
        ("power_kw = 7.5\ntor", "power_kw = nan\ntor", "curve[1].power_kw: nan is no finite"),
        ("power_kw = 7.5\ntor", "power_kw = '7'\ntor", "curve[1].power_kw: '7' is no number"),
        ("power_kw = 7.5\ntor", "power_w = 7500\ntor", "curve[1].power_kw: missing"),
        ("speed_rpm = 600\n", "speed_rpm = 6_000\n", "6000 rpm is not above the point before"),
        ("speed_rpm = 600\n", "speed_rpm = 9_000\n", "6000 rpm is not above the point before"),
        (
            "min_speed_rpm = 60",
            "min_speed_rpm = 7000",
            "7000 rpm exceeds max_speed_rpm 6000 rpm",
        ),
        ('kind = "mill"', 'kind = "saw"', "kind: 'saw' is none of mill, lathe"),
        ("rapid_mm_min = 30_000\nb", "rapid_m_min = 30\nb", "rapid_m_min: unknown key"),
        ("block_time_s = 0.004", "block_time_s = 4", "block_time_s: 4 s exceeds 1 s"),
        ("acceleration_mm_s2 = 3_000", "acceleration_mm_s2 = 3", "3 mm/s² is below 10 mm/s²"),
        ("[[axis]]", "[[axes]]", "axes: unknown key"),
        ("[spindle]", "[spindel]", "spindle.source: missing"),
    ],
)
def test_a_bad_value_is_told_with_key_value_and_bound(
    good: str, bad: str, message: str, tmp_path: Path
) -> None:
    assert good in GOOD
    with pytest.raises(LibraryError) as caught:
        machine_of(GOOD.replace(good, bad, 1), tmp_path)
    assert message in str(caught.value)
    assert str(tmp_path / "my.toml") in str(caught.value)


@pytest.mark.parametrize("name", machine_names())
def test_no_spindle_gives_more_at_its_nose_than_its_motor_does(name: str) -> None:
    spindle = load_machine(name).spindle
    for point in spindle.curve:
        if point.torque is not None:
            watts = 2 * pi * point.speed * point.torque / 1000
            assert watts == pytest.approx(spindle.efficiency * point.power, rel=0.01)
