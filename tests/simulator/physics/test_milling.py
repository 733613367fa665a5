from math import pi

import pytest

from simulator.physics import engagement, milling
from simulator.physics.cutting import chip_force
from simulator.physics.milling import MillingCut
from simulator.spec import Kienzle

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
CONSTANT = Kienzle(k_c11=1000.0, m_c=0.0)


def slot(teeth: int) -> MillingCut:
    return MillingCut(
        feed_per_tooth=0.1, teeth=teeth, axial_depth=2.0, engagement=engagement.full_immersion()
    )


def test_mean_force_is_mean_tooth_force_times_mean_teeth_in_cut() -> None:
    cut = slot(4)
    together = cut.teeth * cut.engagement.contact_angle / (2.0 * pi)
    tooth = chip_force(STEEL, chip_thickness=cut.mean_chip_thickness, chip_width=2.0)
    assert milling.mean_force(STEEL, cut) == pytest.approx(together * tooth)


def test_mean_force_does_not_depend_on_the_edge_angle_when_k_is_constant() -> None:
    steep = slot(4)
    flat = MillingCut(
        feed_per_tooth=0.1,
        teeth=4,
        axial_depth=2.0,
        engagement=engagement.full_immersion(),
        cutting_edge_angle=pi / 4.0,
    )
    assert milling.mean_force(CONSTANT, flat) == pytest.approx(
        milling.mean_force(CONSTANT, steep)
    )
    assert milling.mean_force(STEEL, flat) > milling.mean_force(STEEL, steep)


def test_factor_scales_every_force() -> None:
    cut = slot(3)
    for force in (milling.mean_force, milling.mean_specific_force):
        assert force(STEEL, cut, factor=1.3) == pytest.approx(1.3 * force(STEEL, cut))


def test_cut_without_feed_is_refused() -> None:
    with pytest.raises(ValueError, match="feed per tooth 0 mm must be greater than 0 mm"):
        MillingCut(
            feed_per_tooth=0.0,
            teeth=4,
            axial_depth=2.0,
            engagement=engagement.full_immersion(),
        )
