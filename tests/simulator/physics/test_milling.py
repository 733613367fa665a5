from math import pi, sin

import pytest

from simulator.physics import engagement, milling
from simulator.physics.engagement import Engagement
from simulator.physics.milling import MillingCut
from simulator.spec import Kienzle

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
CONSTANT = Kienzle(k_c11=1000.0, m_c=0.0)


def slot(teeth: int) -> MillingCut:
    return MillingCut(
        feed_per_tooth=0.1, teeth=teeth, axial_depth=2.0, engagement=engagement.full_immersion()
    )


def brute_peak(kienzle: Kienzle, cut: MillingCut) -> float:
    """Greatest sum over a pitch in small steps, each tooth by itself."""
    steps = 20_000
    best = 0.0
    for step in range(steps + 1):
        turn = step / steps * cut.tooth_pitch
        angles = (turn + tooth * cut.tooth_pitch for tooth in range(cut.teeth))
        arc = cut.engagement
        sines = [sin(a) for a in angles if arc.entry_angle <= a <= arc.exit_angle]
        thickness = [cut.feed_per_tooth * sin(cut.cutting_edge_angle) * s for s in sines]
        forces = [
            kienzle.k_c11 * cut.chip_width * max(h, 0.0) ** (1.0 - kienzle.m_c)
            for h in thickness
        ]
        best = max(best, sum(forces))
    return best


@pytest.mark.parametrize("teeth", [1, 2, 3, 4, 5, 8])
@pytest.mark.parametrize("kienzle", [STEEL, CONSTANT])
@pytest.mark.parametrize(
    "arc",
    [
        engagement.full_immersion(),
        engagement.unidirectional(3.0, 20.0),
        engagement.conventional(13.0, 20.0),
        engagement.bilateral(12.0, 20.0, offset=1.0),
    ],
)
def test_peak_force_is_the_greatest_sum_over_a_turn(
    teeth: int, kienzle: Kienzle, arc: Engagement
) -> None:
    cut = MillingCut(feed_per_tooth=0.1, teeth=teeth, axial_depth=2.0, engagement=arc)
    assert milling.peak_force(kienzle, cut) == pytest.approx(brute_peak(kienzle, cut), rel=1e-3)


def test_single_tooth_s_peak_is_the_tooth_s() -> None:
    assert milling.peak_force(STEEL, slot(1)) == pytest.approx(
        milling.peak_tooth_force(STEEL, slot(1))
    )


def test_peak_is_at_least_the_mean() -> None:
    for teeth in range(1, 9):
        assert milling.peak_force(STEEL, slot(teeth)) >= milling.mean_force(STEEL, slot(teeth))


def test_mean_force_is_mean_tooth_force_times_mean_teeth_in_cut() -> None:
    cut = slot(4)
    together = engagement.mean_teeth_in_cut(cut.engagement, cut.teeth)
    assert milling.mean_force(STEEL, cut) == pytest.approx(
        together * milling.mean_tooth_force(STEEL, cut)
    )


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
    for force in (
        milling.mean_force,
        milling.mean_tooth_force,
        milling.peak_tooth_force,
        milling.peak_force,
        milling.mean_specific_force,
    ):
        assert force(STEEL, cut, factor=1.3) == pytest.approx(1.3 * force(STEEL, cut))


def test_cut_without_feed_is_refused() -> None:
    with pytest.raises(ValueError, match="feed per tooth 0 mm must be greater than 0 mm"):
        MillingCut(
            feed_per_tooth=0.0,
            teeth=4,
            axial_depth=2.0,
            engagement=engagement.full_immersion(),
        )
