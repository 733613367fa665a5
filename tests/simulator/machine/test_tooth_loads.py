"""Forces tooth by tooth against their means, and against the forces of one cut."""

from math import pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.cutting import CuttingLoads, Edge, cutting_loads
from simulator.machine.tooth_forces import tooth_forces
from simulator.machine.tooth_loads import Teeth, entered_loads, tooth_loads
from simulator.machine.transients import eccentric_runout
from simulator.motion.segments import Floats
from simulator.physics.engagement import Engagement, mean_chip_ratio
from simulator.physics.milling import MillingCut
from simulator.physics.milling_forces import kienzle_law
from simulator.removal.stations import CutKind, Stations
from simulator.spec import Kienzle

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


def stations_of(cut: MillingCut, *, kind: CutKind = CutKind.MILLING) -> Stations:
    arc = cut.engagement
    width = 5.0 * arc.cosine_difference
    return Stations(
        segment=np.array([0]),
        station=np.array([1.0]),
        kind=np.array([int(kind)]),
        section=np.array([cut.axial_depth * width]),
        axial_depth=np.array([cut.axial_depth]),
        radial_width=np.array([width]),
        entry_angle=np.array([arc.entry_angle]),
        exit_angle=np.array([arc.exit_angle]),
        contact_angle=np.array([arc.contact_angle]),
        chip_ratio=np.array([mean_chip_ratio(arc, cutting_edge_angle=cut.cutting_edge_angle)]),
        diameter=np.array([10.0]),
    )


def both(
    stations: Stations, edge: Edge, *, eccentricity: float = 0.0, turned: Floats = TURNED
) -> tuple[CuttingLoads, CuttingLoads]:
    rows = np.zeros(len(turned), dtype=np.int64)
    mean = cutting_loads(
        stations,
        rows,
        speed=np.full(len(turned), SPEED),
        spindle_speed=np.full(len(turned), SPINDLE),
        edge=edge,
        wear=1.1,
    )
    teeth = Teeth(eccentricity=eccentricity)
    return mean, tooth_loads(mean, stations, rows, turned=turned, edge=edge, teeth=teeth)


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
)
def test_mean_over_a_revolution_is_the_mean_force_of_a_linear_law(
    entry: float, contact: float, teeth: int, kappa: float, eccentricity: float
) -> None:
    """Whatever the runout: what one tooth leaves the next one takes."""
    cut = cut_of(entry=entry, exit_=entry + contact, teeth=teeth, kappa=kappa)
    edge = Edge(teeth=teeth, kienzle=Kienzle(k_c11=2000.0, m_c=0.0), factor=1.3)
    turned, weights = revolution(cut)
    mean, found = both(stations_of(cut), edge, eccentricity=eccentricity, turned=turned)
    for name in ("force", "feed_force", "back_force"):
        whole = getattr(mean, name)[0]
        tolerance = 1e-9 * mean.force[0]
        assert weights @ getattr(found, name) == pytest.approx(whole, abs=tolerance)
    np.testing.assert_array_equal(found.power, mean.power)


@pytest.mark.parametrize("kappa", [pi / 2, pi / 4])
def test_every_tooth_has_its_force_by_kienzle(kappa: float) -> None:
    cut = cut_of(entry=0.5, exit_=2.5, kappa=kappa)
    kienzle = Kienzle(k_c11=1500.0, m_c=0.25)
    mean, found = both(stations_of(cut), Edge(teeth=4, kienzle=kienzle, factor=1.3))
    wanted = tooth_forces(kienzle_law(kienzle), cut, rotation=2.0 * pi * TURNED)
    np.testing.assert_allclose(found.force, 1.43 * wanted.tangential.sum(axis=1), rtol=1e-9)
    # k_c at the mean chip or chip by chip: a few per cent apart.
    assert found.force.mean() == pytest.approx(mean.force[0], rel=0.03)


def test_single_tooth_in_a_slot_peaks_at_the_full_feed() -> None:
    """``F = k·a_p·f_z``, k = 2000 N/mm²."""
    edge = Edge(teeth=1, kienzle=Kienzle(k_c11=2000.0, m_c=0.0))
    _, found = both(stations_of(cut_of(teeth=1)), edge)
    assert found.force.max() == pytest.approx(1.1 * 2000.0 * 2.0 * 0.4, rel=1e-6)
    quarter = found.force[1800 - 600]
    assert quarter == pytest.approx(1.1 * 1600.0 * sin(2 * pi * TURNED[1200]), rel=1e-9)


def test_runout_raises_the_peak() -> None:
    edge = Edge(teeth=2, kienzle=Kienzle(k_c11=2000.0, m_c=0.0))
    cut = cut_of(teeth=2)
    _, even = both(stations_of(cut), edge)
    _, uneven = both(stations_of(cut), edge, eccentricity=0.02)
    # Two teeth, 0.02 mm up and down: the higher one cuts 0.04 mm more.
    lift = (cut.feed_per_tooth + 0.04) / cut.feed_per_tooth
    assert uneven.force.max() == pytest.approx(lift * even.force.max(), rel=1e-6)
    assert eccentric_runout(0.02, 2).tolist() == pytest.approx([0.02, -0.02])


@pytest.mark.parametrize("kind", [CutKind.DRILLING, CutKind.TURNING])
def test_what_is_not_milling_keeps_its_mean(kind: CutKind) -> None:
    edge = Edge(teeth=4, kienzle=Kienzle(k_c11=2000.0, m_c=0.2))
    mean, found = both(stations_of(cut_of(), kind=kind), edge, eccentricity=0.01)
    np.testing.assert_array_equal(found.force, mean.force)


def test_a_spindle_that_turns_backwards_has_the_same_peak() -> None:
    edge = Edge(teeth=3, kienzle=Kienzle(k_c11=2000.0, m_c=0.2))
    _, onward = both(stations_of(cut_of(teeth=3)), edge)
    _, backward = both(stations_of(cut_of(teeth=3)), edge, turned=-TURNED)
    np.testing.assert_allclose(backward.force, onward.force)


def test_the_chip_of_turning_grows_in_the_first_revolution() -> None:
    """F ∝ h^(1−m): half the chip after half a revolution."""
    edge = Edge(teeth=1, kienzle=Kienzle(k_c11=1500.0, m_c=0.25))
    stations = stations_of(cut_of(teeth=1), kind=CutKind.TURNING)
    rows = np.zeros(3, dtype=np.int64)
    mean = cutting_loads(
        stations, rows, speed=np.full(3, SPEED), spindle_speed=np.full(3, SPINDLE), edge=edge
    )
    since = np.array([0.0, 0.5, 7.0])
    found = entered_loads(mean, stations, rows, since_entry=since, edge=edge)
    assert found.force / mean.force == pytest.approx([0.0, 0.5**0.75, 1.0])
    assert found.power is mean.power


def test_milling_has_no_first_revolution() -> None:
    edge = Edge(teeth=4, kienzle=Kienzle(k_c11=1500.0, m_c=0.25))
    stations, rows = stations_of(cut_of()), np.zeros(1, dtype=np.int64)
    at = np.full(1, SPINDLE)
    mean = cutting_loads(stations, rows, speed=np.full(1, SPEED), spindle_speed=at, edge=edge)
    found = entered_loads(mean, stations, rows, since_entry=np.zeros(1), edge=edge)
    assert found.force == pytest.approx(mean.force)
