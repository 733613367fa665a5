"""The programmed point and the two ways to look at the half plane."""

import pytest

from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.toolpath.path import ArcPlane
from stepnc_model.toolpath.turning.profile import (
    HalfPlane,
    RadiusProfile,
    half_circle,
    level_line,
    tip_of,
)


@pytest.mark.parametrize(
    ("hand", "tip"),
    [
        (HandOfToolType.RIGHT, (-0.8, -0.8)),
        (None, (-0.8, -0.8)),
        (HandOfToolType.LEFT, (-0.8, 0.8)),
        (HandOfToolType.NEUTRAL, (-0.8, 0.0)),
    ],
)
def test_the_tip_is_the_corner_around_the_nose(
    hand: HandOfToolType | None, tip: tuple[float, float]
) -> None:
    assert tip_of(hand, 0.8) == tip


@pytest.mark.parametrize("is_across", [False, True])
def test_a_programmed_point_has_one_centre(is_across: bool) -> None:
    plane = HalfPlane(is_across=is_across, tip_x=-0.8, tip_z=-0.8)
    assert plane.point((3.0, 7.0)) == pytest.approx(
        (2.2, 0.0, 6.2) if is_across else (6.2, 0.0, 2.2)
    )
    assert plane.spot(plane.point((3.0, 7.0))) == pytest.approx((3.0, 7.0))


def test_arcs_turn_the_other_way_across() -> None:
    arch = half_circle((0.0, 0.0), 5.0, 1)
    along, across = HalfPlane().arc(arch), HalfPlane(is_across=True).arc(arch)
    assert along is not None
    assert across is not None
    assert (along.plane, along.turn) == (ArcPlane.ZX, -across.turn)


def test_a_bar_seen_across_is_its_front() -> None:
    bar = RadiusProfile(pieces=(level_line(30.0, -150.0, 2.0),))
    front = HalfPlane(is_across=True).material(bar)
    assert (front.low, front.high, front.at(10.0)) == (0.0, 30.0, 2.0)
