"""Curves of feed factors: never above the steps, and equal to them beside short ramps."""

from itertools import accumulate, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.toolpath.explicit.factor_curve import (
    RAMP,
    SHORTEST,
    FactorPart,
    factor_curve,
)

SIZES = st.one_of(st.floats(1e-4, 50.0), st.floats(1e-9, 1e-6))
FACTORS = st.one_of(st.floats(0.01, 20.0), st.sampled_from((0.5, 1.0, 1.5)))
STEPS = st.lists(st.tuples(SIZES, FACTORS), min_size=1, max_size=12).filter(
    lambda steps: sum(size for size, _ in steps) > SHORTEST
)
NOISE = 1.0 + 1e-9
"""Relative error of interpolation in floating point."""


def parts_of(steps: list[tuple[float, float]]) -> list[FactorPart]:
    ends = accumulate(size for size, _ in steps)
    return [
        FactorPart(end=end, factor=factor) for end, (_, factor) in zip(ends, steps, strict=True)
    ]


@given(steps=STEPS, shares=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
def test_the_curve_is_never_above_the_steps(
    steps: list[tuple[float, float]], shares: list[float]
) -> None:
    parts = parts_of(steps)
    curve = factor_curve(parts)
    begin = 0.0
    for part in parts:
        ends = begin + 1e-12, part.end - 1e-12
        for share in (*shares, 0.5):
            at = ends[0] + share * (ends[1] - ends[0])
            if begin < at < part.end:
                assert curve.at(at)[0] <= part.factor * NOISE
        begin = part.end


@given(steps=st.lists(st.tuples(st.floats(0.1, 50.0), FACTORS), min_size=1, max_size=12))
def test_the_curve_equals_the_steps_away_from_ramps(steps: list[tuple[float, float]]) -> None:
    parts = parts_of(steps)
    curve = factor_curve(parts)
    begin = 0.0
    for part in parts:
        for at in (begin + 1.01 * RAMP, 0.5 * (begin + part.end), part.end - 1.01 * RAMP):
            assert curve.at(at)[0] == pytest.approx(part.factor, rel=1e-9)
        begin = part.end


@given(steps=STEPS)
def test_knots_suit_iso_10303_42(steps: list[tuple[float, float]]) -> None:
    """Inner knots of degree 1 are single, so that the curve is continuous."""
    curve = factor_curve(parts_of(steps))
    assert len(curve.knots) == len(curve.poles) + 2
    assert curve.knots[0] == curve.knots[1]
    assert curve.knots[-1] == curve.knots[-2]
    assert all(a < b for a, b in pairwise(curve.knots[1:-1]))


def test_no_length_has_no_curve() -> None:
    with pytest.raises(ValueError, match="at least 1e-06 mm"):
        factor_curve([FactorPart(end=0.0, factor=1.0)])
