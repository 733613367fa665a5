from math import pi, sin

import pytest

from simulator.physics import engagement, linear_edge, milling
from simulator.physics.milling import MillingCut
from simulator.spec import Kienzle, LinearEdge

ALUMINIUM = LinearEdge(k_tc=767.0, k_te=27.7)


def cut(radial_width: float) -> MillingCut:
    return MillingCut(
        feed_per_tooth=0.1,
        teeth=4,
        axial_depth=2.0,
        engagement=engagement.unidirectional(radial_width, 10.0),
    )


@pytest.mark.parametrize("radial_width", [0.5, 3.0, 10.0])
def test_mean_force_is_the_integral_over_the_arc(radial_width: float) -> None:
    at = cut(radial_width)
    arc = at.engagement
    steps = 2000
    width = arc.contact_angle / steps
    angles = (arc.entry_angle + (i + 0.5) * width for i in range(steps))
    integral = sum(
        linear_edge.edge_chip_force(
            ALUMINIUM, chip_thickness=at.feed_per_tooth * sin(a), chip_width=at.chip_width
        )
        * width
        for a in angles
    )
    assert linear_edge.edge_mean_force(ALUMINIUM, at) == pytest.approx(
        at.teeth * integral / (2.0 * pi), rel=1e-5
    )


def test_without_rubbing_it_is_a_constant_specific_force() -> None:
    edge = LinearEdge(k_tc=900.0, k_te=0.0)
    kienzle = Kienzle(k_c11=900.0, m_c=0.0)
    assert linear_edge.edge_mean_force(edge, cut(4.0)) == pytest.approx(
        milling.mean_force(kienzle, cut(4.0))
    )
    assert linear_edge.edge_peak_tooth_force(edge, cut(4.0)) == pytest.approx(
        milling.peak_tooth_force(kienzle, cut(4.0))
    )


def test_rubbing_remains_as_the_chip_vanishes() -> None:
    force = linear_edge.edge_chip_force(ALUMINIUM, chip_thickness=0.0, chip_width=3.0)
    assert force == pytest.approx(3.0 * 27.7)


def test_factor_scales_the_force() -> None:
    sharp = linear_edge.edge_mean_force(ALUMINIUM, cut(4.0))
    assert linear_edge.edge_mean_force(ALUMINIUM, cut(4.0), factor=1.5) == pytest.approx(
        1.5 * sharp
    )


def test_factor_of_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="force factor 0"):
        linear_edge.edge_peak_tooth_force(ALUMINIUM, cut(4.0), factor=0.0)
