"""Shin et al., Int. J. Prod. Res. 54 (2016): the turning case of §4.1, run as a whole.

AL6061, 0.25 mm/rev, 166.5 rad/s, passes of 2.5 mm, overcut 2 mm; the five events of Fig. 8.
Kienzle's values are ISCAR's of VDI 3323 group 22 (800 N/mm², 0.25); the bar of 50 mm and its
four passes are those of ``examples/parts/paper000.stpnc``, for the paper prints none.
"""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pyarrow import parquet

from service.simulation.run import Simulation, simulate
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from tests.asking import asked_simulation

ROOT = Path(__file__).parents[2]
PART = ROOT / "examples" / "parts" / "paper000.stpnc"

OMEGA = 166.5
"""rad/s"""
DEPTH = 2.5
FEED = 0.25
OVERCUT = 2.0
LENGTH = 45.0
DIAMETERS = (47.5, 42.5, 37.5, 32.5)
"""mm in the middle of the cut of each pass"""
FORCE = 800.0 * FEED**-0.25 * DEPTH * FEED
"""N, Kienzle with b·h = a_p·f"""
SPEED = FEED * OMEGA / (2.0 * pi)
"""mm/s along the bar"""

MACHINE = load_machine("paper000")
IDLE = MACHINE.spindle.idle_power_per_speed * OMEGA / (2.0 * pi)
"""W of the drive, turning without cutting"""
RATE = 1000.0

Columns = dict[str, NDArray[Any]]


def run(output: Path, machine: str = "paper000") -> tuple[Simulation, Columns]:
    request = asked_simulation(
        file=PART, machine=machine, rate=RATE, control="exact-stop", output=output
    )
    simulation = simulate(*request)
    table = parquet.read_table(output)
    return simulation, {name: table[name].to_numpy() for name in table.column_names}


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Simulation, Columns]:
    return run(tmp_path_factory.mktemp("shin") / "run.parquet")


@pytest.fixture(scope="module")
def columns(both: tuple[Simulation, Columns]) -> Columns:
    return both[1]


def passes(columns: Columns) -> list[NDArray[Any]]:
    """Rows of each pass with chips."""
    rows = np.flatnonzero(columns["cutting_wattage"] > 0.0)
    return np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)


def test_1_the_start_of_the_spindle_is_the_peak_of_the_run(columns: Columns) -> None:
    spindle, total = columns["c_axis_wattage"], columns["electric_wattage"]
    ramp = OMEGA / (2.0 * pi) / (MACHINE.spindle.acceleration or 0.0)
    peak = int(total.argmax())
    assert columns["time_s"][peak] == pytest.approx(ramp, abs=2.0 / RATE)
    idle = spindle[peak + 100]
    assert idle == pytest.approx(535.0, rel=2e-3)
    assert spindle[peak] > 10.0 * idle


@pytest.mark.parametrize(
    ("seconds", "watts"),
    [
        (0.2, 904.82),
        (0.4, 1836.57),
        (0.6, 2708.56),
        (0.8, 3598.43),
        (1.0, 4579.11),
        (1.2, 5333.83),
        (1.8, 535.14),
    ],
)
def test_the_samples_are_those_of_fig_7c(
    columns: Columns, seconds: float, watts: float
) -> None:
    """Within the noise that the figure has."""
    row = int(np.searchsorted(columns["time_s"], seconds - 1e-9))
    assert columns["c_axis_wattage"][row] == pytest.approx(watts, rel=0.03)


def test_2_the_coolant_adds_a_step_before_the_tool_enters(columns: Columns) -> None:
    coolant = columns["coolant_wattage"]
    steps = np.diff(coolant, prepend=0.0)
    on, off = np.flatnonzero(steps)
    assert (steps[on], steps[off]) == (MACHINE.coolant_power, -MACHINE.coolant_power)
    first, last = passes(columns)[0][0], passes(columns)[-1][-1]
    assert on < first < last < off
    others = sum(
        columns[name]
        for name in (
            "x_axis_wattage",
            "y_axis_wattage",
            "z_axis_wattage",
            "c_axis_wattage",
            "load_wattage",
        )
    )
    assert columns["electric_wattage"] - others == pytest.approx(coolant, abs=1e-2)


def test_3_the_tool_enters_after_its_overcut(columns: Columns) -> None:
    """Fed from z = 2 mm, it meets the face at z = 0."""
    time, along = columns["time_s"], columns["z_axis_position_actual"]
    starts = columns["path_feedrate_programmed"] > 0.0
    entry = passes(columns)[0][0]
    start = int(starts.argmax())
    assert along[start] == pytest.approx(OVERCUT, abs=SPEED / RATE)
    assert along[entry - 1] >= 0.0 >= along[entry]
    way = OVERCUT / SPEED + 0.5 * SPEED / 6000.0
    assert time[entry] - time[start] == pytest.approx(way, abs=2.0 / RATE)
    idle, loaded = columns["electric_wattage"][[entry - 1, entry]]
    assert loaded > 3.0 * idle


def test_4_power_falls_with_the_diameter(columns: Columns) -> None:
    """F_c = k_c·b·h alike in all passes, P_c = F_c·ω·d/2."""
    found = passes(columns)
    assert len(found) == len(DIAMETERS)
    for rows, diameter in zip(found, DIAMETERS, strict=True):
        steady = rows[100:-100]
        power = FORCE * OMEGA * 0.5 * diameter / 1000.0
        assert columns["chip_thickness"][steady] == pytest.approx(FEED, rel=1e-3)
        assert columns["axial_depth"][steady] == pytest.approx(DEPTH, rel=1e-3)
        assert columns["cutting_force"][steady] == pytest.approx(FORCE, rel=1e-3)
        assert columns["cutting_wattage"][steady] == pytest.approx(power, rel=1e-3)
        spindle = columns["c_axis_wattage"][steady]
        assert spindle - IDLE == pytest.approx(power / 0.95, rel=1e-3)


def test_the_force_is_that_of_print(columns: Columns) -> None:
    """707 N, and 3098 W of the drive if the bar measured 50 mm in the middle of the cut."""
    row = passes(columns)[0][1000]
    drawn = columns["c_axis_wattage"][row] - IDLE
    assert columns["cutting_force"][row] == pytest.approx(707.1, rel=1e-3)
    assert drawn * 50.0 / DIAMETERS[0] == pytest.approx(3098.0, rel=1e-3)


def test_5_the_spindle_stops_and_nothing_is_returned(columns: Columns) -> None:
    spindle = columns["c_axis_wattage"]
    end = int(np.flatnonzero(spindle)[-1])
    assert spindle.min() == 0.0
    assert columns["electric_wattage"].min() == MACHINE.base_power
    assert columns["rotary_velocity_actual"][end + 1] > 0.99 * OMEGA * 30.0 / pi
    assert columns["rotary_velocity_actual"][-1] == 0.0


def test_5_with_regeneration_the_power_turns_negative(tmp_path: Path) -> None:
    """The paper's own assumption; the share of the shaft's power is ours."""
    share, spindle = 0.7, MACHINE.spindle
    regenerative = replace(MACHINE, spindle=replace(spindle, regeneration=share))
    file = tmp_path / "regenerative.toml"
    file.write_text(machine_toml(regenerative), encoding="utf-8")
    _, columns = run(tmp_path / "run.parquet", machine=str(file))
    braking = (spindle.inertia or 0.0) * 2.0 * pi * (spindle.acceleration or 0.0) * OMEGA
    returned = share * (braking - 0.95 * IDLE)
    assert columns["c_axis_wattage"].min() == pytest.approx(-returned, rel=1e-3)
    assert columns["electric_wattage"].min() == pytest.approx(
        MACHINE.base_power - returned, rel=1e-3
    )


def test_volume_time_and_energy_of_the_cut(both: tuple[Simulation, Columns]) -> None:
    """A ring from 50 to 30 mm, 45 mm long; time with chips and work at the edge."""
    whole = both[0].whole
    seconds = LENGTH / SPEED
    assert whole.volume == pytest.approx(pi * (25.0**2 - 15.0**2) * LENGTH, rel=1e-3)
    assert whole.cutting_time == pytest.approx(len(DIAMETERS) * seconds, rel=1e-3)
    work = FORCE * OMEGA * 0.5 * sum(DIAMETERS) / 1000.0 * seconds
    assert whole.cutting_energy == pytest.approx(work, rel=1e-3)
