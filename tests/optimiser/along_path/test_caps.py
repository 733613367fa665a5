"""Caps by station: at its cap a load equals its bound in the virtual machine's own words."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.along_path.caps import NAMES, CapName, CutBounds, feed_factors, station_caps
from optimiser.bounds.chip_load import feed_factor
from simulator.machine.cutting import CuttingEdge, CuttingLoads, cutting_loads
from simulator.machine.tooth_loads import bent, wall_forces
from simulator.physics.spindle import available_power
from simulator.physics.strength import end_mill
from simulator.removal.stations import StationKind, Stations
from simulator.tool_windows import FeedWindow
from tests.optimiser.sample_cuts import CARBIDE, CUT

SPINDLE = 60.0
"""rev/s"""


def milling(entry: float, depth: float, *, contact: float = 1.2) -> Stations:
    """Station of a mill of 12 mm with one contact arc."""
    exit_ = min(entry + contact, pi)
    section = 6.0 * depth * (np.cos(entry) - np.cos(exit_))
    one = {
        "station": 5.0,
        "section": section,
        "growth": 0.0,
        "axial_depth": depth,
        "radial_width": section / depth,
        "entry_angle": entry,
        "exit_angle": exit_,
        "contact_angle": exit_ - entry,
        "chip_ratio": (np.cos(entry) - np.cos(exit_)) / (exit_ - entry),
        "diameter": 12.0,
    }
    return Stations(
        segment=np.zeros(1, dtype=np.int64),
        kind=np.array([int(StationKind.MILLING)]),
        **{name: np.array([value]) for name, value in one.items()},
    )


def bounds(**limits: float | None) -> CutBounds:
    """Bounds of the sample's cut without a catalogue feed, on a machine with some limits."""
    machine = replace(CARBIDE.machine, **limits)  # type: ignore[arg-type]
    material = replace(CARBIDE.material, max_feed_per_tooth=None, max_feed_per_tooth_ratio=None)
    grade = CARBIDE.grade
    assert grade is not None
    weak = replace(grade, max_feed=None, max_feed_ratio=None, bending_strength=1e9)
    return CutBounds(
        cut=CUT, at=replace(CARBIDE, machine=machine, material=material, grade=weak)
    )


def edge(given: CutBounds) -> CuttingEdge:
    """The same tool in the virtual machine."""
    grade = given.at.grade
    assert grade is not None
    shank = end_mill(12.0, cutting_edge_length=26.0, youngs_modulus=grade.youngs_modulus)
    return CuttingEdge(
        teeth=4,
        kienzle=given.at.material.kienzle,
        factor=1.0,
        flutes=CUT.edges,
        compliance=shank.compliance,
    )


def at_cap(stations: Stations, given: CutBounds) -> tuple[CapName, CuttingLoads]:
    """Active limit of a station, and the loads of the virtual machine at its cap."""
    found = station_caps(stations, given, spindle=np.array([SPINDLE]), descent=np.zeros(1)).caps
    tool, rows, no_wear = edge(given), np.zeros(1, dtype=np.int64), np.zeros(1)
    loads = cutting_loads(
        stations, rows, speed=found.feed, spindle_speed=np.array([SPINDLE]), edge=tool
    )
    walls = wall_forces(stations, tool)
    loads = bent(loads, stations, rows, edge=tool, walls=walls, flank_wear=no_wear)
    return NAMES[found.name[0]], loads


ARC = st.floats(0.0, 2.4)
DEPTH = st.floats(0.5, 12.0)


@given(ARC, DEPTH)
def test_the_force_reaches_its_bound(entry: float, depth: float) -> None:
    given = bounds(max_cutting_force=150.0)
    name, loads = at_cap(milling(entry, depth), given)
    if name is CapName.CUTTING_FORCE:
        assert loads.force[0] == pytest.approx(150.0, rel=1e-9)
    else:
        assert loads.force[0] < 150.0


@given(ARC, DEPTH)
def test_the_power_reaches_what_the_drive_gives(entry: float, depth: float) -> None:
    given = bounds(max_cutting_force=None)
    given = replace(
        given, at=replace(given.at, deflection=replace(given.at.deflection, value=9.0))
    )
    name, loads = at_cap(milling(entry, depth), given)
    spindle = given.at.machine.spindle
    drive = loads.power[0] / spindle.efficiency
    assert drive <= available_power(spindle, SPINDLE) * (1.0 + 1e-9)
    assert name in {CapName.MOTOR_POWER, CapName.SPINDLE_TORQUE}


@given(st.floats(2.0, 2.4), DEPTH)
def test_the_deflection_reaches_its_bound(entry: float, depth: float) -> None:
    given = bounds(max_cutting_force=None)
    name, loads = at_cap(milling(entry, depth), given)
    if name is CapName.TOOL_DEFLECTION:
        assert loads.deflection[0] == pytest.approx(given.at.deflection.value, rel=0.01)
    else:
        assert loads.deflection[0] <= 1.01 * given.at.deflection.value


@given(ARC, DEPTH, st.floats(1.0, 2.0))
def test_a_safety_factor_lowers_the_feed_as_it_raises_the_force(
    entry: float, depth: float, factor: float
) -> None:
    given = bounds(max_cutting_force=150.0)
    safe = replace(given, at=replace(given.at, safety_factor=factor))
    name, loads = at_cap(milling(entry, depth), safe)
    if name is CapName.CUTTING_FORCE:
        assert factor * loads.force[0] == pytest.approx(150.0, rel=1e-9)


@given(st.floats(0.01, 1.0), st.floats(0.05, 1.0))
def test_factors_of_arrays_are_those_of_single_cuts(width: float, sine: float) -> None:
    window = FeedWindow(width_ratio=0.5, slot_factor=0.75)
    found = feed_factors(np.array([width]), np.array([sine]), window)[0]
    assert found == pytest.approx(feed_factor(width, sine, window), rel=1e-12)


def test_a_way_down_has_the_plunge_feed_along_the_axis() -> None:
    given = replace(bounds(max_cutting_force=None), plunge=0.02)
    found = station_caps(
        milling(0.5, 0.5), given, spindle=np.array([SPINDLE]), descent=np.array([0.1])
    ).caps
    assert NAMES[found.name[0]] is CapName.PLUNGE
    assert found.feed[0] == pytest.approx(0.02 / 0.1 * 4 * SPINDLE)


def test_nothing_is_limited_in_air_or_with_a_stopped_spindle() -> None:
    stations = milling(0.5, 3.0)
    still = station_caps(stations, bounds(), spindle=np.zeros(1), descent=np.zeros(1))
    assert still.caps.feed[0] == np.inf
