"""Quantities as planned and as they were."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.outcome import EvaluatedQuantity


def test_a_deviation_is_measured_over_predicted_less_one() -> None:
    assert EvaluatedQuantity(predicted=200.0, measured=230.0).deviation == pytest.approx(0.15)


@pytest.mark.parametrize(
    ("predicted", "measured"), [(None, 1.0), (1.0, None), (None, None), (0.0, 1.0)]
)
def test_without_both_there_is_no_deviation(
    predicted: float | None, measured: float | None
) -> None:
    assert EvaluatedQuantity(predicted=predicted, measured=measured).deviation is None


@given(st.floats(1e-3, 1e3), st.floats(0.0, 1e3))
def test_a_deviation_gives_back_what_was_measured(predicted: float, measured: float) -> None:
    deviation = EvaluatedQuantity(predicted=predicted, measured=measured).deviation
    assert deviation is not None
    assert deviation >= -1.0
    assert predicted * (1.0 + deviation) == pytest.approx(measured, abs=1e-9)
