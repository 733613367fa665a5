from math import pi

import pytest

from simulator.physics import turning
from simulator.physics.turning import TurningCut
from simulator.spec import Kienzle

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)


@pytest.mark.parametrize("kappa", [0.5, 1.0, pi / 2.0, 1.66])
def test_chip_area_is_feed_times_depth_at_every_edge_angle(kappa: float) -> None:
    cut = TurningCut(feed_per_revolution=0.25, depth=2.5, cutting_edge_angle=kappa)
    assert cut.chip_thickness * cut.chip_width == pytest.approx(0.625)


def test_angles_beside_the_perpendicular_are_alike() -> None:
    left = TurningCut(feed_per_revolution=0.25, depth=2.5, cutting_edge_angle=pi / 2 - 0.1)
    right = TurningCut(feed_per_revolution=0.25, depth=2.5, cutting_edge_angle=pi / 2 + 0.1)
    assert turning.cutting_force(STEEL, left) == pytest.approx(
        turning.cutting_force(STEEL, right)
    )


def test_each_component_follows_its_own_pair() -> None:
    cut = TurningCut(feed_per_revolution=0.25, depth=2.5)
    feed = Kienzle(k_c11=351.0, m_c=0.7)
    back = Kienzle(k_c11=274.0, m_c=0.5)
    force = turning.cutting_force(STEEL, cut)
    forces = turning.turning_forces(
        force, cut.chip_thickness, cutting=STEEL, feed=feed, back=back
    )
    assert forces.cutting == force
    assert forces.feed == pytest.approx(351.0 * 2.5 * 0.25**0.3)
    assert forces.back == pytest.approx(274.0 * 2.5 * 0.25**0.5)


def test_without_a_pair_a_force_is_the_usual_share() -> None:
    forces = turning.turning_forces(1000.0, 0.3, cutting=STEEL, feed=None, back=None)
    assert forces.feed == pytest.approx(1000.0 * turning.FEED_SHARE)
    assert forces.back == pytest.approx(1000.0 * turning.BACK_SHARE)


def test_what_is_thinner_than_was_measured_keeps_its_share() -> None:
    """1 − m_f of St 70 is −0.07: its feed force would grow without end."""
    pair = Kienzle(k_c11=228.0, m_c=1.07)
    least = turning.force_share(pair, STEEL, turning.THINNEST)
    assert turning.force_share(pair, STEEL, 1e-6) == pytest.approx(least)
    assert turning.force_share(pair, STEEL, 0.1) < least


def test_depth_of_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="depth of cut 0 mm"):
        TurningCut(feed_per_revolution=0.25, depth=0.0)
