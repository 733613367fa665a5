"""Body of revolution of cutters."""

from math import cos, pi, sin, tan

import pytest

from simulator.removal.cutter import (
    Cutter,
    cylinder,
    is_plain,
    is_upright,
    profile_of,
    radius_at,
    rise,
)
from tests.every_case import every_case

CUTTERS = [
    Cutter(diameter=10.0),
    Cutter(diameter=10.0, corner_radius=5.0),
    Cutter(diameter=10.0, corner_radius=2.0),
    Cutter(diameter=4.0, corner_radius=2.0, taper_angle=0.1),
    Cutter(diameter=10.0, point_angle=2.0),
]


def test_heights_of_each_form() -> None:
    flat, ball, bull, taper, drill = (profile_of(each, reach=30.0) for each in CUTTERS)
    assert rise(flat, 4.9) == 0.0
    assert rise(ball, 3.0) == pytest.approx(1.0)
    assert rise(bull, 3.0 + 2.0 * sin(0.5)) == pytest.approx(2.0 * (1.0 - cos(0.5)))
    assert taper.tangent == pytest.approx(2.0 * cos(0.1))
    assert taper.shoulder == pytest.approx(2.0 * (1.0 - sin(0.1)))
    assert taper.radius == pytest.approx(taper.tangent + (30.0 - taper.shoulder) * tan(0.1))
    assert rise(drill, 2.0) == pytest.approx(2.0 / tan(1.0))
    assert cylinder(5.0) == flat


@pytest.mark.parametrize("cutter", CUTTERS[1:])
def test_radius_and_height_are_inverse(cutter: Cutter) -> None:
    profile = profile_of(cutter, reach=30.0)
    for height in (0.1, 0.7, 1.9):
        radius = radius_at(profile, height)
        again = rise(profile, radius)
        assert again == pytest.approx(height)


@every_case(
    ("cutter", "word"),
    [
        (Cutter(diameter=0.0), "diameter"),
        (Cutter(diameter=10.0, corner_radius=6.0), "corner"),
        (Cutter(diameter=10.0, taper_angle=-0.1), "taper"),
        (Cutter(diameter=10.0, point_angle=4.0), "point"),
        (Cutter(diameter=10.0, point_angle=pi + 0.1), "point"),
    ],
)
def test_impossible_cutters_are_refused(cutter: Cutter, word: str) -> None:
    with pytest.raises(ValueError, match=word):
        profile_of(cutter, reach=30.0)


@every_case(
    ("cutter", "plain", "upright"),
    [
        (Cutter(diameter=10.0), True, True),
        (Cutter(diameter=10.0, corner_radius=1.25), False, True),
        (Cutter(diameter=10.0, corner_radius=1.3), False, False),
        (Cutter(diameter=10.0, corner_radius=5.0), False, False),
        (Cutter(diameter=10.0, corner_radius=1.0, taper_angle=0.1), False, False),
        (Cutter(diameter=10.0, point_angle=2.0), False, False),
    ],
)
def test_a_cylinder_with_a_small_corner_is_upright(
    cutter: Cutter, plain: bool, upright: bool
) -> None:
    profile = profile_of(cutter, reach=30.0)
    assert bool(is_plain(profile)) is plain
    assert bool(is_upright(profile)) is upright
