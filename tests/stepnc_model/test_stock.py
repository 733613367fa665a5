"""The raw part as a value: a box, or a bar in one."""

from dataclasses import FrozenInstanceError, replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program, Stock
from stepnc_model.toolpath.task import stock_of

PARTS = Path(__file__).parents[2] / "examples" / "parts"
BOX = Stock(low=(-3.0, -3.0, -40.0), high=(153.0, 93.0, 2.0))
COORDINATES = st.tuples(*[st.floats(-1e5, 1e5)] * 3)


def test_a_stock_without_radius_is_a_box() -> None:
    assert BOX.radius is None


def test_a_stock_does_not_change() -> None:
    with pytest.raises(FrozenInstanceError):
        BOX.radius = 30.0  # type: ignore[misc]


@given(low=COORDINATES, high=COORDINATES, radius=st.none() | st.floats(0.01, 1e5))
def test_equal_stocks_are_one_key(
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    radius: float | None,
) -> None:
    one = Stock(low=low, high=high, radius=radius)
    assert len({one, replace(one), Stock(low=low, high=high, radius=radius)}) == 1


def test_a_bar_is_not_the_box_around_it() -> None:
    box = Stock(low=(-30.0, -30.0, 0.0), high=(30.0, 30.0, 150.0))
    assert replace(box, radius=30.0) != box


def test_the_axis_of_a_bar_is_in_the_middle_of_its_box_wherever_it_stands() -> None:
    """The shaft of 60 mm, 152 mm long, moved by 7 and −5 mm in the file."""
    text = (PARTS / "shaft.stpnc").read_text(encoding="utf-8")
    at = "#35=CARTESIAN_POINT('',({}-150.));"
    assert at.format("0.,0.,") in text
    text = text.replace(at.format("0.,0.,"), at.format("7.,-5.,"))
    found = stock_of(Program(Part21File.from_bytes(text.encode(), name="shaft")), None)
    assert found is not None
    assert found.radius == 30.0
    middle = [0.5 * (low + high) for low, high in zip(found.low, found.high, strict=True)]
    assert middle == [7.0, -5.0, -74.0]
