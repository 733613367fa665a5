"""Forces of every tooth: their mean over a revolution, and what runout does."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.tooth_forces import (
    arcs_of,
    chip_thickness,
    tooth_angles,
    tooth_forces,
)
from simulator.motion.segments import Floats
from simulator.physics import engagement, milling
from simulator.physics.engagement import Engagement
from simulator.physics.linear_edge import edge_mean_force
from simulator.physics.milling import MillingCut
from simulator.physics.milling_forces import (
    arc_integrals,
    edge_law,
    kienzle_law,
    mean_forces,
)
from simulator.spec import Kienzle, LinearEdge

AL7075 = LinearEdge(k_tc=767.01, k_te=27.7, k_rc=168.8, k_re=26.6)
STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
ARCS = [
    engagement.full_immersion(),
    engagement.unidirectional(2.0, 10.0),
    engagement.conventional(3.0, 10.0),
    engagement.bilateral(6.0, 10.0, offset=1.0),
]


def cut(arc: Engagement, *, teeth: int = 4, edge_angle: float = pi / 2) -> MillingCut:
    return MillingCut(
        feed_per_tooth=0.1,
        teeth=teeth,
        axial_depth=2.0,
        engagement=arc,
        cutting_edge_angle=edge_angle,
    )


def revolution(at: MillingCut) -> tuple[Floats, Floats]:
    """Nodes and weights that average exactly over one turn: Gauss between all jumps."""
    arc = at.engagement
    jumps = [
        np.mod(angle + tooth * at.tooth_pitch, 2 * pi)
        for angle in (arc.entry_angle, arc.exit_angle)
        for tooth in range(at.teeth)
    ]
    ends = np.unique(np.concatenate(([0.0, 2 * pi], jumps)))
    nodes, weights = np.polynomial.legendre.leggauss(16)
    half = np.diff(ends)[:, None] / 2.0
    return (ends[:-1, None] + half * (1 + nodes)).ravel(), (half * weights / (2 * pi)).ravel()


@pytest.mark.parametrize("arc", ARCS)
@pytest.mark.parametrize("teeth", [1, 3, 4])
@pytest.mark.parametrize("edge_angle", [pi / 2, pi / 4])
def test_the_mean_over_a_revolution_is_the_mean_force(
    arc: Engagement, teeth: int, edge_angle: float
) -> None:
    at = cut(arc, teeth=teeth, edge_angle=edge_angle)
    rotation, weights = revolution(at)
    found = tooth_forces(edge_law(AL7075), at, rotation=rotation)
    mean = mean_forces(
        edge_law(AL7075),
        arc_integrals(arc),
        feed_per_tooth=0.1,
        axial_depth=2.0,
        teeth=teeth,
        cutting_edge_angle=edge_angle,
    )
    assert weights @ found.tangential.sum(axis=1) == pytest.approx(edge_mean_force(AL7075, at))
    assert weights @ found.feed == pytest.approx(mean.feed)
    assert weights @ found.normal == pytest.approx(mean.normal)


@pytest.mark.parametrize("arc", ARCS)
def test_the_greatest_sum_is_the_peak_force(arc: Engagement) -> None:
    at = cut(arc)
    rotation = np.linspace(0.0, 2 * pi, 20_001)
    found = tooth_forces(kienzle_law(STEEL), at, rotation=rotation).tangential.sum(axis=1)
    assert found.max() == pytest.approx(milling.peak_force(STEEL, at), rel=2e-3)
    assert found.max() <= milling.peak_force(STEEL, at) * (1 + 1e-12)


def test_integrals_of_arrays_are_those_of_each_arc() -> None:
    table = arcs_of(
        np.array([arc.entry_angle for arc in ARCS]), np.array([arc.exit_angle for arc in ARCS])
    )
    for row, arc in enumerate(ARCS):
        each = arc_integrals(arc)
        for name in ("contact", "sine", "cosine", "sine_squared", "sine_cosine"):
            assert getattr(table, name)[row] == pytest.approx(getattr(each, name), abs=1e-12)


def test_means_of_arrays_are_those_of_each_cut() -> None:
    feeds, depths = np.array([0.05, 0.1, 0.15, 0.2]), np.array([1.0, 2.0, 3.0, 4.0])
    entry, exit_ = (
        np.array([getattr(arc, name) for arc in ARCS]) for name in ("entry_angle", "exit_angle")
    )
    law = kienzle_law(STEEL)
    table = mean_forces(
        law, arcs_of(entry, exit_), feed_per_tooth=feeds, axial_depth=depths, teeth=3
    )
    for row, arc in enumerate(ARCS):
        each = mean_forces(
            law,
            arc_integrals(arc),
            feed_per_tooth=feeds[row],
            axial_depth=depths[row],
            teeth=3,
        )
        assert table.feed[row] == pytest.approx(each.feed)
        assert table.normal[row] == pytest.approx(each.normal)


@settings(max_examples=30)
@given(
    runout=st.lists(st.floats(-0.2, 0.2), min_size=1, max_size=6),
    angle=st.floats(0.01, pi - 0.01),
)
def test_whatever_the_runout_a_revolution_removes_its_feed(
    runout: list[float], angle: float
) -> None:
    """Each tooth in turn passes the same angle; what one leaves another takes."""
    offsets = np.array(runout)
    passing = np.full((1, len(runout)), angle)
    chips = chip_thickness(passing, feed_per_tooth=0.1, runout=offsets)
    assert chips.sum() == pytest.approx(len(runout) * 0.1 * np.sin(angle))


def test_one_high_tooth_takes_the_feed_of_a_revolution() -> None:
    at = cut(engagement.full_immersion())
    high = np.array([0.5, 0.0, 0.0, 0.0])
    found = tooth_forces(kienzle_law(STEEL), at, rotation=np.array([pi / 2, pi]), runout=high)
    assert found.tangential[0, 0] == pytest.approx(1500 * 2.0 * 0.4**0.78)
    assert (found.tangential[:, 1:] == 0.0).all()


def test_a_tooth_follows_the_one_before_it() -> None:
    angles = tooth_angles(np.array([pi / 2]), 4)
    assert angles[0] == pytest.approx([pi / 2, 0.0, 3 * pi / 2, pi])


def test_a_runout_is_wanted_for_each_tooth() -> None:
    with pytest.raises(ValueError, match=r"runout has shape \(3,\) and must have \(4,\)"):
        tooth_forces(kienzle_law(STEEL), cut(ARCS[0]), rotation=np.zeros(1), runout=np.zeros(3))
