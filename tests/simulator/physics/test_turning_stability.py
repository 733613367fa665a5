"""The turning limit against its textbook's closed form."""

from dataclasses import replace
from math import pi, sqrt

import pytest

from simulator.physics.stability import MOST_DEPTH
from simulator.physics.turning_stability import orthogonal_limit
from simulator.spec import ModeDirection, VibratingPart, VibrationMode

MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="mill",
    direction=ModeDirection.X,
    natural_frequency=600.0,
    damping_ratio=0.03,
    stiffness=10_000.0,
    source="test",
)


def test_turning_has_the_textbook_limit_of_one_mode() -> None:
    """``b_lim = 2kζ(1 + ζ)/K_f``, Altintas, Manufacturing Automation, ch. 4."""
    found = orthogonal_limit((), (replace(MODE, direction=ModeDirection.Z),), stiffness=700.0)
    assert found == pytest.approx(2.0 * 10_000.0 * 0.03 * 1.03 / 700.0, rel=1e-4)


def test_an_inclined_edge_feels_the_radial_mode_by_its_cosine() -> None:
    """``a_p = b·sin κ`` and ``G = cos²κ·G_x``: at 45° ½·√2 of the double."""
    straight = orthogonal_limit((), (MODE,), stiffness=700.0)
    found = orthogonal_limit((MODE,), (), stiffness=700.0, cutting_edge_angle=0.25 * pi)
    assert found == pytest.approx(straight * 2.0 * 0.5 * sqrt(2.0), rel=1e-6)


def test_turning_is_not_limited_where_nothing_gives() -> None:
    assert orthogonal_limit((), (), stiffness=700.0) == MOST_DEPTH
    assert orthogonal_limit((MODE,), (), stiffness=700.0) == MOST_DEPTH


def test_a_cut_without_stiffness_and_an_edge_without_an_angle_are_refused() -> None:
    with pytest.raises(ValueError, match="cutting stiffness 0"):
        orthogonal_limit((MODE,), (), stiffness=0.0)
    with pytest.raises(ValueError, match="cutting edge angle 0 rad"):
        orthogonal_limit((MODE,), (), stiffness=700.0, cutting_edge_angle=0.0)
