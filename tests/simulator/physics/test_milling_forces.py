"""Mean forces along and across the feed against quadrature and the scalar models."""

from collections.abc import Callable
from math import cos, pi, sin

import numpy as np
import pytest

from simulator.physics import engagement, milling, milling_forces
from simulator.physics.engagement import Engagement
from simulator.physics.milling import MillingCut
from simulator.physics.milling_forces import MeanForces, ToothLaw
from simulator.spec import Kienzle, LinearEdge
from tests.oracles import cutting as oracle

AL7075 = LinearEdge(k_tc=767.01, k_te=27.7, k_rc=168.8, k_re=26.6)
ARCS = [
    engagement.full_immersion(),
    engagement.unidirectional(2.0, 10.0),
    engagement.conventional(3.0, 10.0),
    engagement.bilateral(6.0, 10.0, offset=1.0),
]


def cut(arc: Engagement, *, edge_angle: float = pi / 2) -> MillingCut:
    return MillingCut(
        feed_per_tooth=0.1,
        teeth=4,
        axial_depth=2.0,
        engagement=arc,
        cutting_edge_angle=edge_angle,
    )


def means(law: ToothLaw, at: MillingCut) -> MeanForces[float]:
    return milling_forces.mean_forces(
        law,
        milling_forces.arc_integrals(at.engagement),
        feed_per_tooth=at.feed_per_tooth,
        axial_depth=at.axial_depth,
        teeth=at.teeth,
        cutting_edge_angle=at.cutting_edge_angle,
    )


def integral(force: Callable[[float], float], arc: Engagement) -> float:
    """Gauss-Legendre over the arc: exact to rounding for so smooth a function."""
    nodes, weights = np.polynomial.legendre.leggauss(30)
    half = arc.contact_angle / 2.0
    return half * sum(
        weight * force(arc.entry_angle + half * (1.0 + node))
        for node, weight in zip(nodes.tolist(), weights.tolist(), strict=True)
    )


@pytest.mark.parametrize("arc", ARCS)
@pytest.mark.parametrize("edge_angle", [pi / 2, pi / 4])
def test_mean_forces_are_the_integrals_of_one_tooth(arc: Engagement, edge_angle: float) -> None:
    at = cut(arc, edge_angle=edge_angle)
    sine = sin(edge_angle)

    def tangential(angle: float) -> float:
        return at.chip_width * (AL7075.k_tc * 0.1 * sine * sin(angle) + AL7075.k_te)

    def radial(angle: float) -> float:
        return sine * at.chip_width * (AL7075.k_rc * 0.1 * sine * sin(angle) + AL7075.k_re)

    share = at.teeth / (2 * pi)
    found = means(milling_forces.edge_law(AL7075), at)
    assert found.tangential == pytest.approx(share * integral(tangential, arc))
    assert found.feed == pytest.approx(
        share * integral(lambda a: tangential(a) * cos(a) + radial(a) * sin(a), arc)
    )
    assert found.normal == pytest.approx(
        share * integral(lambda a: tangential(a) * sin(a) - radial(a) * cos(a), arc)
    )


@pytest.mark.parametrize("arc", ARCS)
def test_the_tangential_mean_is_that_of_the_scalar_models(arc: Engagement) -> None:
    at, steel = cut(arc), Kienzle(k_c11=1500.0, m_c=0.22)
    assert means(milling_forces.edge_law(AL7075), at).tangential == pytest.approx(
        oracle.edge_mean_force(AL7075, at)
    )
    assert means(milling_forces.kienzle_law(steel), at).tangential == pytest.approx(
        milling.mean_force(steel, at)
    )


def test_a_slot_in_aluminium_takes_the_power_of_the_worked_case() -> None:
    """P10_slot_edge: Ø10, 3000 rpm: T = 1.530587 N·m, P = 480.848 W."""
    force = means(milling_forces.edge_law(AL7075), cut(engagement.full_immersion()))
    torque = force.tangential * 5.0
    assert torque == pytest.approx(1530.587, rel=1e-6)
    assert oracle.torque_power(torque, 50.0) == pytest.approx(480.848, rel=1e-6)


def test_means_of_a_slot_in_print() -> None:
    """Altintas, slotting: F_x = −(N·a/4)·K_rc·c − (N·a/π)·K_re, F_y likewise with K_t."""
    force = means(milling_forces.edge_law(AL7075), cut(engagement.full_immersion()))
    assert force.feed == pytest.approx(4 * 2 * (168.8 * 0.1 / 4 + 26.6 / pi))
    assert force.normal == pytest.approx(4 * 2 * (767.01 * 0.1 / 4 + 27.7 / pi))


def test_climb_milling_pulls_where_conventional_milling_resists() -> None:
    law = milling_forces.kienzle_law(Kienzle(k_c11=1500.0, m_c=0.22))
    against = means(law, cut(engagement.conventional(1.0, 10.0))).feed
    pulls = means(law, cut(engagement.unidirectional(1.0, 10.0))).feed
    assert pulls < 0.0 < against


def test_only_the_normal_force_differs_by_the_side_when_there_is_no_radial_force() -> None:
    law = ToothLaw(k_tc=900.0)
    climb = means(law, cut(engagement.unidirectional(3.0, 10.0)))
    conventional = means(law, cut(engagement.conventional(3.0, 10.0)))
    assert climb.tangential == pytest.approx(conventional.tangential)
    assert climb.feed == pytest.approx(-conventional.feed)
    assert climb.normal == pytest.approx(conventional.normal)
