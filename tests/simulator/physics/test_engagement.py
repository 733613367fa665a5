from math import acos, cos, pi

import pytest

from simulator.physics import engagement
from simulator.physics.engagement import Engagement
from tests.every_case import every_case


def test_climb_milling_leaves_at_pi() -> None:
    arc = engagement.unidirectional(5.0, 20.0)
    assert arc.exit_angle == pi
    assert arc.entry_angle == pytest.approx(pi - acos(1.0 - 2.0 * 5.0 / 20.0))


def test_conventional_milling_enters_at_zero() -> None:
    arc = engagement.conventional(5.0, 20.0)
    assert arc.entry_angle == 0.0
    assert arc.exit_angle == pytest.approx(acos(1.0 - 2.0 * 5.0 / 20.0))


@pytest.mark.parametrize("offset", [-4.0, 0.0, 2.5, 5.0])
def test_cosine_difference_is_twice_the_immersion_wherever_the_strip_lies(
    offset: float,
) -> None:
    arc = engagement.bilateral(10.0, 20.0, offset=offset)
    assert arc.cosine_difference == pytest.approx(2.0 * 10.0 / 20.0)


def test_strip_at_the_cutter_s_edge_is_one_sided() -> None:
    assert engagement.bilateral(8.0, 20.0, offset=6.0).entry_angle == pytest.approx(0.0)
    assert engagement.bilateral(8.0, 20.0, offset=-6.0).exit_angle == pytest.approx(pi)


def test_strip_beyond_the_cutter_is_refused() -> None:
    with pytest.raises(ValueError, match="must not exceed half the tool diameter, 10 mm"):
        engagement.bilateral(8.0, 20.0, offset=7.0)


@pytest.mark.parametrize(
    "arc",
    [
        engagement.full_immersion(),
        engagement.unidirectional(18.0, 18.0),
        engagement.conventional(18.0, 18.0),
        engagement.bilateral(18.0, 18.0),
    ],
)
def test_every_type_at_full_width_is_the_slot(arc: Engagement) -> None:
    assert arc.cosine_difference == pytest.approx(2.0)
    assert arc.contact_angle == pytest.approx(pi)


def test_cosine_difference_keeps_its_digits_in_a_narrow_cut() -> None:
    assert engagement.unidirectional(1e-9, 10.0).cosine_difference == pytest.approx(
        2e-10, rel=1e-6
    )
    assert engagement.conventional(1e-9, 10.0).cosine_difference == pytest.approx(
        2e-10, rel=1e-12
    )


def test_cosine_difference_is_what_its_name_says() -> None:
    arc = Engagement(entry_angle=0.7, exit_angle=2.1)
    assert arc.cosine_difference == pytest.approx(cos(0.7) - cos(2.1))


@every_case(("entry", "exit_"), [(1.0, 1.0), (2.0, 1.0), (-0.1, 1.0), (0.0, 3.2)])
def test_angles_that_do_not_ascend_within_the_half_circle_are_refused(
    entry: float, exit_: float
) -> None:
    with pytest.raises(ValueError, match="must ascend and lie between 0 and π rad"):
        Engagement(entry_angle=entry, exit_angle=exit_)


def test_slot_s_mean_chip_is_two_over_pi() -> None:
    assert engagement.mean_chip_thickness(0.1, engagement.full_immersion()) == pytest.approx(
        0.2 / pi
    )


def test_narrow_cut_s_thickest_chip_is_at_its_end() -> None:
    arc = engagement.conventional(2.0, 20.0)
    assert arc.greatest_sine == pytest.approx((1.0 - (1.0 - 0.2) ** 2) ** 0.5)
    assert engagement.full_immersion().greatest_sine == 1.0


def test_lower_edge_angle_thins_the_chip() -> None:
    arc = engagement.full_immersion()
    thin = engagement.mean_chip_thickness(0.1, arc, cutting_edge_angle=pi / 4.0)
    assert thin == pytest.approx(engagement.mean_chip_thickness(0.1, arc) / 2.0**0.5)


def test_width_beyond_the_diameter_is_refused() -> None:
    with pytest.raises(ValueError, match="radial width 21 mm must be at most 20 mm"):
        engagement.unidirectional(21.0, 20.0)
