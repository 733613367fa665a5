"""Vectors of three numbers, held against numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.toolpath.path import Point, cross, dot, minus, plus, times

NUMBERS = st.floats(-1e3, 1e3)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)


@given(one=VECTORS, other=VECTORS, factor=NUMBERS)
def test_vectors_are_those_of_numpy(one: Point, other: Point, factor: float) -> None:
    a, b = np.array(one), np.array(other)
    assert plus(one, other) == tuple(a + b)
    assert minus(one, other) == tuple(a - b)
    assert times(one, factor) == tuple(factor * a)
    assert dot(one, other) == pytest.approx(a @ b, abs=1e-9)
    assert cross(one, other) == pytest.approx(np.cross(a, b), abs=1e-9)
