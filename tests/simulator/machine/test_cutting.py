"""Force and power where the tool is, against the scalar physics of each process."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from simulator.machine.cutting import (
    CuttingEdge,
    CuttingLoads,
    cutting_loads,
    engaged_width,
    milling_shares,
    no_loads,
    worn_loads,
)
from simulator.physics.drilling import DrillingCut, drilling_torque
from simulator.physics.engagement import Engagement, mean_chip_ratio
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.turning import (
    BACK_SHARE,
    FEED_SHARE,
    TurningCut,
    cutting_force,
    turning_forces,
)
from simulator.removal.stations import StationKind, Stations, air
from simulator.spec import Kienzle
from simulator.tool_windows import DrillPoint
from tests.oracles.cutting import drilling_thrust

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)

TINY = 1e-6
"""N: the difference of two forces of a hundred newtons has no more digits"""
C45_FEED, C45_BACK = Kienzle(k_c11=521.0, m_c=0.49), Kienzle(k_c11=309.0, m_c=0.4)
ANGLES = (
    st
    .tuples(st.floats(0.0, pi), st.floats(0.0, pi))
    .map(sorted)
    .filter(lambda pair: pair[1] - pair[0] > 0.05)
)


def station(kind: StationKind, **columns: float) -> Stations:
    names = [
        "section",
        "growth",
        "axial_depth",
        "radial_width",
        "entry_angle",
        "exit_angle",
        "contact_angle",
        "chip_ratio",
        "diameter",
    ]
    values = {name: np.array([columns.get(name, 0.0)]) for name in names}
    return Stations(
        segment=np.array([0]), station=np.array([1.0]), kind=np.array([int(kind)]), **values
    )


def milled(
    entry: float, exit_: float, *, diameter: float = 10.0, depth: float = 2.0
) -> Stations:
    width = 0.5 * diameter * (cos(entry) - cos(exit_))
    arc = Engagement(entry_angle=entry, exit_angle=exit_)
    return station(
        StationKind.MILLING,
        section=depth * width,
        axial_depth=depth,
        radial_width=width,
        entry_angle=entry,
        exit_angle=exit_,
        contact_angle=exit_ - entry,
        chip_ratio=mean_chip_ratio(arc),
        diameter=diameter,
    )


def turned(*, depth: float, kappa: float, radius: float = 20.0) -> Stations:
    around = 2.0 * radius - depth
    return station(
        StationKind.TURNING,
        section=pi * around * depth,
        axial_depth=depth,
        chip_ratio=sin(kappa),
        diameter=around,
    )


def loads(
    stations: Stations,
    edge: CuttingEdge,
    *,
    speed: float,
    spindle: float,
    flank_wear: float = 0.0,
) -> CuttingLoads:
    rows, turning = np.array([0]), np.array([spindle])
    sharp = cutting_loads(
        stations, rows, speed=np.array([speed]), spindle_speed=turning, edge=edge
    )
    return worn_loads(
        sharp,
        stations,
        rows,
        spindle_speed=turning,
        edge=edge,
        flank_wear=np.array([flank_wear]),
    )


@settings(max_examples=40)
@given(
    angles=ANGLES,
    speed=st.floats(0.1, 100.0),
    spindle=st.floats(1.0, 200.0),
    teeth=st.integers(1, 8),
    factor=st.floats(0.5, 2.0),
)
def test_power_of_milling_is_specific_force_times_removal_rate(
    angles: list[float], speed: float, spindle: float, teeth: int, factor: float
) -> None:
    entry, exit_ = angles
    edge = CuttingEdge(teeth=teeth, kienzle=STEEL, factor=factor)
    found = loads(milled(entry, exit_), edge, speed=speed, spindle=spindle)
    rate = 2.0 * 5.0 * (cos(entry) - cos(exit_)) * speed
    per_tooth = speed / (teeth * spindle)
    chip = per_tooth * quad(sin, entry, exit_)[0] / (exit_ - entry)
    assert found.removal_rate[0] == pytest.approx(rate)
    assert found.chip_thickness[0] == pytest.approx(chip)
    power = factor * 1500.0 * chip**-0.22 * rate / 1000.0
    assert found.power[0] == pytest.approx(power)
    assert found.force[0] * pi * 10.0 * spindle / 1000.0 == pytest.approx(power)


@settings(max_examples=40)
@given(angles=ANGLES, spindle=st.floats(1.0, 200.0))
def test_milling_shares_are_means_of_a_tooth_over_its_arc(
    angles: list[float], spindle: float
) -> None:
    """One tooth pushes by ``F_t = sin φ`` and ``F_r = 0.3·sin φ``."""
    entry, exit_ = angles
    feed, back = milling_shares(milled(entry, exit_))
    whole = quad(sin, entry, exit_)[0]
    along = quad(lambda a: sin(a) * (cos(a) + RADIAL_SHARE * sin(a)), entry, exit_)[0]
    across = quad(lambda a: sin(a) * (sin(a) - RADIAL_SHARE * cos(a)), entry, exit_)[0]
    assert feed[0] == pytest.approx(along / whole, abs=1e-9)
    assert back[0] == pytest.approx(across / whole, abs=1e-9)


def test_full_slot_of_aisi_1018_needs_the_power_of_the_reference() -> None:
    """Ø8, z 4, f_z 0.01778 mm, n 1750 rpm: k_c 4020 N/mm² and 100.1 W at 1.5 mm depth."""
    edge = CuttingEdge(teeth=4, kienzle=STEEL)
    slot = milled(0.0, pi, diameter=8.0, depth=1.5)
    found = loads(slot, edge, speed=0.017780 * 4 * 1750 / 60, spindle=1750 / 60)
    assert found.chip_thickness[0] == pytest.approx(0.011319, rel=1e-4)
    assert found.power[0] / found.removal_rate[0] * 1000.0 == pytest.approx(4020, rel=1e-3)
    assert found.power[0] == pytest.approx(100.1, rel=1e-3)


@settings(max_examples=30)
@given(
    feed=st.floats(0.05, 0.5),
    diameter=st.floats(2.0, 30.0),
    share=st.sampled_from([0.0, 0.3, 0.8]),
    half=st.floats(0.5, 0.5 * pi),
    spindle=st.floats(1.0, 100.0),
    chisel=st.sampled_from([0.0, 0.1, 0.2, 0.35]),
)
def test_drilling_has_the_torque_and_thrust_of_the_scalar_physics(
    feed: float,
    diameter: float,
    share: float,
    half: float,
    spindle: float,
    chisel: float,
) -> None:
    """In the solid, in a hole that the chisel edge does not meet, and in one that it does."""
    hole, factor = share * diameter, 1.3
    point = DrillPoint(thrust_share=0.583, chisel_ratio=chisel)
    cut = DrillingCut(
        feed_per_revolution=feed,
        tool_diameter=diameter,
        previous_diameter=hole,
        cutting_edge_angle=half,
        point=point,
    )
    stations = station(
        StationKind.DRILLING,
        section=0.25 * pi * (diameter**2 - hole**2),
        axial_depth=0.5 * (diameter - hole),
        chip_ratio=sin(half),
        diameter=0.5 * (diameter + hole),
    )
    edge = CuttingEdge(teeth=2, kienzle=STEEL, factor=factor, point=point)
    found = loads(stations, edge, speed=feed * spindle, spindle=spindle)
    torque = found.power[0] * 1000.0 / (2.0 * pi * spindle)
    assert torque == pytest.approx(drilling_torque(STEEL, cut, factor=factor))
    assert found.feed_force[0] == pytest.approx(drilling_thrust(STEEL, cut, factor=factor))
    assert found.back_force[0] == 0.0


@settings(max_examples=30)
@given(
    feed=st.floats(0.05, 0.5),
    depth=st.floats(0.2, 5.0),
    kappa=st.floats(0.8, 1.6),
    radius=st.floats(8.0, 50.0),
)
def test_turning_has_the_force_of_kienzle(
    feed: float, depth: float, kappa: float, radius: float
) -> None:
    stations = turned(depth=depth, kappa=kappa, radius=radius)
    edge = CuttingEdge(teeth=1, kienzle=STEEL, feed_force=C45_FEED, back_force=C45_BACK)
    found = loads(stations, edge, speed=feed * 15.0, spindle=15.0)
    cut = TurningCut(feed_per_revolution=feed, depth=depth, cutting_edge_angle=kappa)
    force = cutting_force(STEEL, cut)
    sides = turning_forces(
        force, cut.chip_thickness, cutting=STEEL, feed=C45_FEED, back=C45_BACK
    )
    assert found.force[0] == pytest.approx(force)
    assert found.feed_force[0] == pytest.approx(sides.feed)
    assert found.back_force[0] == pytest.approx(sides.back)


def test_turning_without_pairs_has_the_usual_shares() -> None:
    stations = turned(depth=2.0, kappa=1.5)
    found = loads(stations, CuttingEdge(teeth=1, kienzle=STEEL), speed=3.0, spindle=15.0)
    assert found.feed_force[0] == pytest.approx(FEED_SHARE * found.force[0])
    assert found.back_force[0] == pytest.approx(BACK_SHARE * found.force[0])


@settings(max_examples=30)
@given(feed=st.floats(0.05, 0.5), flank_wear=st.floats(0.0, 0.3))
def test_wear_adds_to_the_force_whatever_the_feed(feed: float, flank_wear: float) -> None:
    """Measured: 42 N at VB 0.3 mm and a depth of 0.25 mm; 490 ± 80 N/mm² make 37 ± 6 N."""
    stations, edge = turned(depth=0.25, kappa=1.5), CuttingEdge(teeth=1, kienzle=STEEL)
    sharp = loads(stations, edge, speed=feed * 15.0, spindle=15.0)
    worn = loads(stations, edge, speed=feed * 15.0, spindle=15.0, flank_wear=flank_wear)
    added = worn.force[0] - sharp.force[0]
    assert added == pytest.approx(490.0 * flank_wear * 0.25, abs=TINY)
    assert worn.feed_force[0] - sharp.feed_force[0] == pytest.approx(
        950.0 / 490.0 * added, abs=TINY
    )
    assert worn.back_force[0] - sharp.back_force[0] == pytest.approx(
        1580.0 / 490.0 * added, abs=TINY
    )
    rise = (worn.power[0] - sharp.power[0]) * 1000.0
    assert rise == pytest.approx(added * pi * stations.diameter[0] * 15.0, abs=TINY)


@settings(max_examples=30)
@given(angles=ANGLES, teeth=st.integers(1, 8))
def test_wear_of_a_mill_acts_on_the_teeth_in_the_cut(angles: list[float], teeth: int) -> None:
    """Mean of z teeth on an arc of φ: ``z·φ/2π`` of them, each as wide as the depth."""
    entry, exit_ = angles
    stations, edge = milled(entry, exit_), CuttingEdge(teeth=teeth, kienzle=STEEL)
    width = 2.0 * teeth * (exit_ - entry) / (2.0 * pi)
    assert engaged_width(stations, teeth)[0] == pytest.approx(width)
    sharp = loads(stations, edge, speed=5.0, spindle=20.0)
    worn = loads(stations, edge, speed=5.0, spindle=20.0, flank_wear=0.2)
    assert worn.force[0] - sharp.force[0] == pytest.approx(490.0 * 0.2 * width)
    each = 0.2 * 2.0 * teeth / (2.0 * pi)
    normal = np.hypot(950.0, 1580.0)
    along = quad(lambda a: 490.0 * cos(a) + normal * sin(a), entry, exit_)[0]
    across = quad(lambda a: 490.0 * sin(a) - normal * cos(a), entry, exit_)[0]
    assert worn.feed_force[0] - sharp.feed_force[0] == pytest.approx(each * along, abs=1e-6)
    assert worn.back_force[0] - sharp.back_force[0] == pytest.approx(each * across, abs=1e-6)


def test_wear_of_a_drill_acts_on_both_lips() -> None:
    stations = station(
        StationKind.DRILLING,
        section=0.25 * pi * 100.0,
        axial_depth=5.0,
        chip_ratio=sin(1.03),
        diameter=5.0,
    )
    edge = CuttingEdge(teeth=2, kienzle=STEEL)
    sharp = loads(stations, edge, speed=2.0, spindle=10.0)
    worn = loads(stations, edge, speed=2.0, spindle=10.0, flank_wear=0.2)
    assert worn.force[0] - sharp.force[0] == pytest.approx(490.0 * 0.2 * 10.0)
    assert worn.feed_force[0] - sharp.feed_force[0] == pytest.approx(950.0 * 0.2 * 10.0)
    assert worn.back_force[0] == 0.0


@pytest.mark.parametrize(("speed", "spindle"), [(0.0, 10.0), (5.0, 0.0), (0.0, 0.0)])
def test_standing_axes_or_spindle_need_no_force(speed: float, spindle: float) -> None:
    found = loads(
        milled(0.0, pi), CuttingEdge(teeth=4, kienzle=STEEL), speed=speed, spindle=spindle
    )
    for name in (
        "removal_rate",
        "chip_thickness",
        "power",
        "force",
        "feed_force",
        "back_force",
    ):
        assert getattr(found, name).tolist() == [0.0]


@pytest.mark.parametrize("missing", ["section", "chip_ratio", "diameter"])
def test_contact_without_a_chip_needs_no_force(missing: str) -> None:
    columns = {"section": 20.0, "chip_ratio": 0.6, "diameter": 10.0, "exit_angle": pi}
    touched = station(StationKind.MILLING, **(columns | {missing: 0.0}))
    found = loads(touched, CuttingEdge(teeth=4, kienzle=STEEL), speed=5.0, spindle=10.0)
    assert found.power.tolist() == found.force.tolist() == [0.0]


def test_air_needs_no_force() -> None:
    nothing = air(np.array([0]), np.array([10.0]))
    found = loads(nothing, CuttingEdge(teeth=4, kienzle=STEEL), speed=5.0, spindle=10.0)
    assert found.force.tolist() == no_loads(1).force.tolist() == [0.0]
