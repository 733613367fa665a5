"""Numbers and raw parts as the user types them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.inputs.numbers import LEAST_SIZE, numbers_in, require_size, stock_in
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Stock
from stepnc_model.toolpath.path import FARTHEST
from tests.every_case import every_case


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=6))
def test_numbers_come_back_as_they_were_written(numbers: list[float]) -> None:
    text = ", ".join(map(repr, numbers))
    assert numbers_in(text, "zero", counts=(len(numbers),)) == tuple(numbers)


def test_a_refusal_names_the_thing_the_text_and_every_count() -> None:
    with pytest.raises(StepNcError) as refused:
        numbers_in("1,2", "stock", counts=(3, 6))
    assert str(refused.value) == "stock '1,2': expected 3 or 6 numbers separated by commas"


@every_case("text", ["1e400,0,0", "-inf,0,0", "nan,0,0", "0x1,0,0", "1;2;3"])
def test_what_is_not_finite_or_not_decimal_is_refused(text: str) -> None:
    with pytest.raises(StepNcError, match=f"zero '{text}': expected 3 numbers"):
        numbers_in(text, "zero", counts=(3,))


def test_six_numbers_are_the_corners_of_a_block_in_mm() -> None:
    block = Stock(low=(-3.0, -3.0, -40.0), high=(153.0, 93.0, 2.0))
    assert stock_in("-3,-3,-40,153,93,2") == block


@given(diameter=st.floats(0.1, 1e3), low=st.floats(-1e3, 0.0), length=st.floats(0.1, 1e3))
def test_three_numbers_are_a_bar_about_zero(diameter: float, low: float, length: float) -> None:
    bar = stock_in(f"{diameter!r},{low!r},{low + length!r}")
    assert bar.radius == 0.5 * diameter
    assert bar.high[:2] == (bar.radius, bar.radius)
    assert bar.low[:2] == (-bar.radius, -bar.radius)
    assert (bar.low[2], bar.high[2]) == (low, low + length)


def test_two_numbers_are_a_bar_that_ends_at_zero() -> None:
    assert stock_in("60,150") == stock_in("60,-150,0")


def test_five_numbers_are_an_upright_bar_elsewhere() -> None:
    bar = stock_in("10,-20,60,-40,2")
    assert bar == Stock(low=(-20.0, -50.0, -40.0), high=(40.0, 10.0, 2.0), radius=30.0)


@every_case("text", ["7", "1,2,3,4", "1,2,3,4,5,6,7"])
def test_other_counts_are_refused(text: str) -> None:
    with pytest.raises(StepNcError, match="expected 2, 3, 5 or 6 numbers"):
        stock_in(text)


@every_case(
    ("text", "axis", "low", "high"),
    [
        ("60,-1", "z", "1", "0"),
        ("0,0,0,10,0,5", "y", "0", "0"),
        ("10,0,0,0,10,5", "x", "10", "0"),
        ("60,2,-150", "z", "2", "-150"),
        ("-60,-150,2", "x", "30", "-30"),
        ("0,0,0,10,10,100001", "z", "0", "100001"),
        ("-200002,0,0,10,10,10", "x", "-200002", "10"),
    ],
)
def test_a_stock_of_nothing_or_beyond_any_machine_is_refused(
    text: str, axis: str, low: str, high: str
) -> None:
    with pytest.raises(StepNcError) as refused:
        stock_in(text)
    assert str(refused.value) == (
        f"stock: {axis} from {low} to {high} mm: must span at least 0.01 mm, "
        "within 100000 mm of zero"
    )


def test_the_bounds_themselves_are_allowed() -> None:
    require_size(Stock(low=(0.0, 0.0, -FARTHEST), high=(LEAST_SIZE, 1.0, FARTHEST)))


def test_a_size_that_is_no_number_is_refused() -> None:
    with pytest.raises(StepNcError, match="stock: y from 0 to nan mm"):
        require_size(Stock(low=(0.0, 0.0, 0.0), high=(1.0, float("nan"), 1.0)))
