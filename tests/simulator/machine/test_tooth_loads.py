"""Forces tooth by tooth against their means, and against the forces of one cut."""

from dataclasses import replace
from math import pi, radians, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.cutting import CuttingEdge, CuttingLoads, cutting_loads, worn_loads
from simulator.machine.tooth_loads import (
    ToothOptions,
    bent,
    entered_loads,
    tooth_loads,
    wall_forces,
)
from simulator.motion.segments import Floats
from simulator.physics.engagement import Engagement, mean_chip_ratio
from simulator.physics.flutes import CuttingEdges
from simulator.physics.milling import MillingCut
from simulator.physics.strength import end_mill
from simulator.physics.uneven_teeth import eccentric_runout
from simulator.removal.stations import StationKind, Stations
from simulator.spec import Kienzle
from tests.simulator.physics.discs import Mill

SPINDLE, SPEED = 50.0, 20.0
TURNED = (np.arange(7200) + 0.5) / 7200


def cut_of(
    *, entry: float = 0.0, exit_: float = pi, teeth: int = 4, kappa: float = pi / 2
) -> MillingCut:
    return MillingCut(
        feed_per_tooth=SPEED / (teeth * SPINDLE),
        teeth=teeth,
        axial_depth=2.0,
        engagement=Engagement(entry_angle=entry, exit_angle=exit_),
        cutting_edge_angle=kappa,
    )


def stations_of(cut: MillingCut, *, kind: StationKind = StationKind.MILLING) -> Stations:
    arc = cut.engagement
    width = 5.0 * arc.cosine_difference
    return Stations(
        segment=np.array([0]),
        station=np.array([1.0]),
        kind=np.array([int(kind)]),
        section=np.array([cut.axial_depth * width]),
        growth=np.zeros(1),
        axial_depth=np.array([cut.axial_depth]),
        radial_width=np.array([width]),
        entry_angle=np.array([arc.entry_angle]),
        exit_angle=np.array([arc.exit_angle]),
        contact_angle=np.array([arc.contact_angle]),
        chip_ratio=np.array([mean_chip_ratio(arc, cutting_edge_angle=cut.cutting_edge_angle)]),
        diameter=np.array([10.0]),
    )


def both(
    stations: Stations,
    edge: CuttingEdge,
    *,
    eccentricity: float = 0.0,
    turned: Floats = TURNED,
    worn: float = 0.0,
) -> tuple[CuttingLoads, CuttingLoads]:
    rows = np.zeros(len(turned), dtype=np.int64)
    at, flank_wear = np.full(len(turned), SPINDLE), np.full(len(turned), worn)
    speed = np.full(len(turned), SPEED)
    sharp = cutting_loads(stations, rows, speed=speed, spindle_speed=at, edge=edge)
    mean = worn_loads(sharp, stations, rows, spindle_speed=at, edge=edge, flank_wear=flank_wear)
    teeth = ToothOptions(eccentricity=eccentricity)
    return mean, tooth_loads(
        mean, stations, rows, turned=turned, edge=edge, teeth=teeth, flank_wear=flank_wear
    )


def flutes_of(cut: MillingCut, *, helix: float = 0.0) -> CuttingEdges:
    return CuttingEdges(
        teeth=cut.teeth,
        diameter=10.0,
        helix_angle=helix,
        cutting_edge_angle=cut.cutting_edge_angle,
    )


def revolution(cut: MillingCut) -> tuple[Floats, Floats]:
    """Rotations in a revolution, and weights that make the mean of the force of a linear law.

    Gauss's rule between each entry or exit of a tooth and the next one: an even grid misses an
    end of the arc by up to half a step. Every tooth is seen at the same angles, so that what
    runout takes from one of them another one has there, and what is left to integrate are
    sines and cosines.
    """
    ends = np.array([cut.engagement.entry_angle, cut.engagement.exit_angle])
    pitches = 2.0 * pi * np.arange(cut.teeth) / cut.teeth
    cuts = np.sort(np.add.outer(ends, pitches).ravel() % (2.0 * pi))
    lengths = np.diff(np.append(cuts, cuts[0] + 2.0 * pi))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    turned = (cuts[:, None] + np.outer(lengths, 0.5 * (nodes + 1.0))) / (2.0 * pi)
    return turned.ravel(), np.outer(lengths, 0.5 * weights).ravel() / (2.0 * pi)


@settings(max_examples=100)
@given(
    entry=st.floats(0.0, 2.0),
    contact=st.floats(0.3, 1.1),
    teeth=st.integers(1, 6),
    kappa=st.floats(0.7, pi / 2),
    eccentricity=st.sampled_from([0.0, 0.01]),
    worn=st.sampled_from([0.0, 0.2]),
)
def test_mean_over_a_revolution_is_the_mean_force_of_a_linear_law(
    entry: float, contact: float, teeth: int, kappa: float, eccentricity: float, worn: float
) -> None:
    """Sharp edge and wear land: what runout takes from one tooth another one has."""
    cut = cut_of(entry=entry, exit_=entry + contact, teeth=teeth, kappa=kappa)
    kienzle = Kienzle(k_c11=2000.0, m_c=0.0)
    edge = CuttingEdge(teeth=teeth, kienzle=kienzle, factor=1.3, flutes=flutes_of(cut))
    turned, weights = revolution(cut)
    mean, found = both(
        stations_of(cut), edge, eccentricity=eccentricity, turned=turned, worn=worn
    )
    whole = max(mean.force[0], abs(mean.feed_force[0]), abs(mean.back_force[0]))
    for name in ("force", "feed_force", "back_force"):
        over = float(weights @ getattr(found, name))
        assert over == pytest.approx(getattr(mean, name)[0], abs=1e-6 * whole)
    np.testing.assert_array_equal(found.power, mean.power)


@settings(max_examples=40)
@given(
    entry=st.floats(0.0, 2.0),
    contact=st.floats(0.3, 1.1),
    teeth=st.integers(1, 6),
    helix=st.sampled_from([0.1, 0.5, 1.0]),
    eccentricity=st.sampled_from([0.0, 0.01]),
    worn=st.sampled_from([0.0, 0.2]),
)
def test_a_helix_leaves_the_mean_of_a_linear_law_as_it_is(
    entry: float,
    contact: float,
    teeth: int,
    helix: float,
    eccentricity: float,
    worn: float,
) -> None:
    """Each disc is a straight edge, later.

    Over N even rotations the mean of a force without jumps is off by less than a thousandth;
    along the edge six points are exact but for the corners that runout makes in the chip.
    """
    cut = cut_of(entry=entry, exit_=entry + contact, teeth=teeth)
    kienzle, flutes = Kienzle(k_c11=2000.0, m_c=0.0), flutes_of(cut, helix=helix)
    edge = CuttingEdge(teeth=teeth, kienzle=kienzle, factor=1.3, flutes=flutes)
    mean, found = both(stations_of(cut), edge, eccentricity=eccentricity, worn=worn)
    whole = max(mean.force[0], abs(mean.feed_force[0]), abs(mean.back_force[0]))
    for name in ("force", "feed_force", "back_force"):
        over = float(getattr(found, name).mean())
        assert over == pytest.approx(getattr(mean, name)[0], abs=2e-3 * whole)


@pytest.mark.parametrize("kappa", [pi / 2, pi / 4])
def test_every_tooth_has_its_force_by_kienzle(kappa: float) -> None:
    """``K·k·b·h^(1−m)`` with b = a_p/sin κ and h = f_z·sin κ·sin φ."""
    cut = cut_of(entry=0.5, exit_=2.5, kappa=kappa)
    kienzle = Kienzle(k_c11=1500.0, m_c=0.25)
    edge = CuttingEdge(teeth=4, kienzle=kienzle, factor=1.3, flutes=flutes_of(cut))
    mean, found = both(stations_of(cut), edge)
    angle = np.mod(2.0 * pi * TURNED[:, None] - 0.5 * pi * np.arange(4), 2.0 * pi)
    chip = cut.feed_per_tooth * sin(kappa) * np.sin(angle)
    in_cut = (angle > 0.5) & (angle < 2.5)
    width = 2.0 / sin(kappa)
    wanted = 1.3 * 1500.0 * width * (np.where(in_cut, chip, 0.0) ** 0.75).sum(axis=1)
    np.testing.assert_allclose(found.force, wanted, rtol=1e-6)
    # k_c at the mean chip or chip by chip: a few per cent apart.
    assert found.force.mean() == pytest.approx(mean.force[0], rel=0.03)


def test_a_helix_is_that_of_thin_discs() -> None:
    cut = cut_of(entry=1.8, exit_=pi, teeth=3)
    kienzle = Kienzle(k_c11=1500.0, m_c=0.25)
    edge = CuttingEdge(teeth=3, kienzle=kienzle, factor=1.3, flutes=flutes_of(cut, helix=1.0))
    turned = TURNED[::40]
    _, found = both(stations_of(cut), edge, turned=turned)
    mill = Mill(teeth=3, diameter=10.0, helix=1.0, entry=1.8, exit=pi, depth=2.0, exponent=0.75)
    scale = 1.3 * 1500.0 * cut.feed_per_tooth**0.75
    for ours, discs in zip(
        (found.force, found.feed_force, found.back_force),
        mill.forces(2.0 * pi * turned),
        strict=True,
    ):
        np.testing.assert_allclose(ours, scale * discs, atol=0.01 * scale * mill.peak())


BENT = end_mill(10.0, cutting_edge_length=None, youngs_modulus=600_000.0).compliance


def test_the_tool_bends_by_the_force_at_the_wall() -> None:
    """F·L³/3EI at the moment when an edge makes the wall, with F summed over thin discs."""
    cut = cut_of(entry=2.6, exit_=pi)
    flutes = flutes_of(cut, helix=radians(30.0))
    edge = CuttingEdge(
        teeth=4, kienzle=Kienzle(k_c11=1500.0, m_c=0.25), flutes=flutes, compliance=BENT
    )
    stations = stations_of(cut)
    mean, _ = both(stations, edge)
    rows = np.zeros(len(TURNED), dtype=np.int64)
    walls, sharp = wall_forces(stations, edge), np.zeros(len(TURNED))
    found = bent(mean, stations, rows, edge=edge, walls=walls, flank_wear=sharp)
    mill = Mill(
        teeth=4,
        diameter=10.0,
        helix=radians(30.0),
        entry=2.6,
        exit=pi,
        depth=2.0,
        exponent=0.75,
    )
    force = 1500.0 * cut.feed_per_tooth**0.75 * mill.wall(pi)
    expected = force * 30.0**3 / (3.0 * 600_000.0 * pi * 8.0**4 / 64.0)
    np.testing.assert_allclose(found.deflection, expected, rtol=0.01)
    np.testing.assert_array_equal(found.force, mean.force)


def test_nothing_bends_without_a_wall_or_a_compliance() -> None:
    within, wall = cut_of(entry=0.5, exit_=2.5), cut_of(entry=2.6, exit_=pi)
    soft = CuttingEdge(teeth=4, kienzle=Kienzle(k_c11=1500.0, m_c=0.25), compliance=BENT)
    stiff = replace(soft, compliance=0.0)
    assert not wall_forces(stations_of(within), soft).any()
    assert not wall_forces(stations_of(wall), stiff).any()
    assert not wall_forces(stations_of(wall, kind=StationKind.DRILLING), soft).any()
    mean, _ = both(stations_of(wall), stiff)
    rows, walls = np.zeros(len(TURNED), dtype=np.int64), np.zeros((2, 1))
    worn = np.full(len(TURNED), 0.2)
    found = bent(mean, stations_of(wall), rows, edge=stiff, walls=walls, flank_wear=worn)
    assert not found.deflection.any()


def test_single_tooth_in_a_slot_peaks_at_the_full_feed() -> None:
    """``F = k·a_p·f_z``, k = 2000 N/mm²."""
    edge = CuttingEdge(teeth=1, kienzle=Kienzle(k_c11=2000.0, m_c=0.0))
    _, found = both(stations_of(cut_of(teeth=1)), edge)
    assert found.force.max() == pytest.approx(2000.0 * 2.0 * 0.4, rel=1e-6)
    quarter = found.force[1800 - 600]
    assert quarter == pytest.approx(1600.0 * sin(2 * pi * TURNED[1200]), rel=1e-6)


def test_runout_raises_the_peak() -> None:
    edge = CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=2000.0, m_c=0.0))
    cut = cut_of(teeth=2)
    _, even = both(stations_of(cut), edge)
    _, uneven = both(stations_of(cut), edge, eccentricity=0.02)
    # Two teeth, 0.02 mm up and down: the higher one cuts 0.04 mm more.
    lift = (cut.feed_per_tooth + 0.04) / cut.feed_per_tooth
    assert uneven.force.max() == pytest.approx(lift * even.force.max(), rel=1e-6)
    assert eccentric_runout(0.02, 2).tolist() == pytest.approx([0.02, -0.02])


@pytest.mark.parametrize("kind", [StationKind.DRILLING, StationKind.TURNING])
def test_what_is_not_milling_keeps_its_mean(kind: StationKind) -> None:
    edge = CuttingEdge(teeth=4, kienzle=Kienzle(k_c11=2000.0, m_c=0.2))
    mean, found = both(stations_of(cut_of(), kind=kind), edge, eccentricity=0.01)
    np.testing.assert_array_equal(found.force, mean.force)


def test_a_spindle_that_turns_backwards_has_the_same_peak() -> None:
    edge = CuttingEdge(teeth=3, kienzle=Kienzle(k_c11=2000.0, m_c=0.2))
    _, onward = both(stations_of(cut_of(teeth=3)), edge)
    _, backward = both(stations_of(cut_of(teeth=3)), edge, turned=-TURNED)
    np.testing.assert_allclose(backward.force, onward.force)


def test_the_chip_of_turning_grows_in_the_first_revolution() -> None:
    """F ∝ h^(1−m): half the chip after half a revolution."""
    edge = CuttingEdge(teeth=1, kienzle=Kienzle(k_c11=1500.0, m_c=0.25))
    stations = stations_of(cut_of(teeth=1), kind=StationKind.TURNING)
    rows = np.zeros(3, dtype=np.int64)
    mean = cutting_loads(
        stations, rows, speed=np.full(3, SPEED), spindle_speed=np.full(3, SPINDLE), edge=edge
    )
    since = np.array([0.0, 0.5, 7.0])
    found = entered_loads(mean, stations, rows, since_entry=since, edge=edge)
    assert found.force / mean.force == pytest.approx([0.0, 0.5**0.75, 1.0])
    assert found.power is mean.power


def test_milling_has_no_first_revolution() -> None:
    edge = CuttingEdge(teeth=4, kienzle=Kienzle(k_c11=1500.0, m_c=0.25))
    stations, rows = stations_of(cut_of()), np.zeros(1, dtype=np.int64)
    at = np.full(1, SPINDLE)
    mean = cutting_loads(stations, rows, speed=np.full(1, SPEED), spindle_speed=at, edge=edge)
    found = entered_loads(mean, stations, rows, since_entry=np.zeros(1), edge=edge)
    assert found.force == pytest.approx(mean.force)
