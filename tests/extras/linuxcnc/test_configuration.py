"""What of a machine stands in LinuxCNC's configuration."""

from dataclasses import replace
from pathlib import Path

from extras.linuxcnc.configuration import write_configuration
from simulator.library import load_machine
from simulator.planner_settings import PlannerSettings


def test_limits_of_a_lathe_are_those_of_its_file(tmp_path: Path) -> None:
    lathe = load_machine("lathe22")
    settings = PlannerSettings(max_feed_override=1.5, servo_period=0.0005)
    write_configuration(tmp_path, lathe, settings, tools=[3, 1, 3])
    ini = (tmp_path / "machine.ini").read_text()
    assert "COORDINATES = X Z\n" in ini
    assert "MAX_FEED_OVERRIDE = 1.5\n" in ini
    assert "SERVO_PERIOD = 500000\n" in ini
    for section, rapid in (("[AXIS_X]", 20_000 / 60), ("[JOINT_1]", 400.0)):
        limits = ini.partition(section)[2].partition("\n[")[0]
        assert f"MAX_VELOCITY = {rapid}" in limits.splitlines()
        assert "MAX_ACCELERATION = 3000.0" in limits.splitlines()
    hal = (tmp_path / "machine.hal").read_text()
    assert "joint.1.motor-pos-fb sampler.0.pin.2\n" in hal
    assert "setp run-up.maxv 16\n" in hal
    assert (tmp_path / "tool.tbl").read_text() == "T1 P1 Z0 D0\nT3 P3 Z0 D0\n"


def test_a_spindle_without_acceleration_is_at_speed_at_once(tmp_path: Path) -> None:
    mill = load_machine("vmc15")
    quick = replace(mill, spindle=replace(mill.spindle, acceleration=None))
    write_configuration(tmp_path, quick, PlannerSettings(), tools=[])
    assert "setp run-up.maxv 1e+06\n" in (tmp_path / "machine.hal").read_text()
