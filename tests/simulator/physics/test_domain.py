from math import inf, nan

import pytest

from simulator.physics.domain import (
    require_at_most,
    require_edge_angle,
    require_hole,
    require_not_negative,
    require_positive,
    require_teeth,
)
from tests.every_case import every_case


@every_case("value", [0.0, -1.0, nan, inf])
def test_positive_refuses_zero_negative_nan_and_infinity(value: float) -> None:
    with pytest.raises(
        ValueError, match=r"^depth \S+ mm must be greater than 0 mm and finite$"
    ):
        require_positive(value, "depth", "mm")


@every_case("value", [-1e-9, nan, inf])
def test_not_negative_refuses_negative_nan_and_infinity(value: float) -> None:
    with pytest.raises(ValueError, match="at least 0 mm and finite"):
        require_not_negative(value, "depth", "mm")


def test_not_negative_takes_zero() -> None:
    require_not_negative(0.0, "depth", "mm")


def test_at_most_names_the_bound_and_its_unit() -> None:
    require_at_most(18.0, 18.0, thing="radial width", unit="mm")
    with pytest.raises(ValueError, match=r"^radial width 19 mm must be at most 18 mm$"):
        require_at_most(19.0, 18.0, thing="radial width", unit="mm")


def test_a_number_without_unit_leaves_no_gap_in_the_sentence() -> None:
    with pytest.raises(ValueError, match=r"^efficiency 1\.2 must be at most 1$"):
        require_at_most(1.2, 1.0, thing="efficiency", unit="")


def test_a_cutter_needs_a_tooth() -> None:
    with pytest.raises(ValueError, match="teeth 0 must be at least 1"):
        require_teeth(0)


@pytest.mark.parametrize("angle", [0.0, 3.15, nan])
def test_edge_angle_lies_between_0_and_pi(angle: float) -> None:
    with pytest.raises(ValueError, match="between 0 and π rad"):
        require_edge_angle(angle)


def test_a_hole_must_be_smaller_than_its_tool() -> None:
    with pytest.raises(ValueError, match="10 mm must be less than the tool diameter 10 mm"):
        require_hole(10.0, 10.0)
