"""Load and exponent, learned by recursive least squares."""

from math import log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.laws.load import (
    EXPONENT_VARIANCE,
    LOAD_FORGETTING,
    LOAD_VARIANCE,
    LoadEstimate,
    first_load,
    learned,
    learned_load,
)

NOISE = 0.03


def first(force: float, way: float = 0.0) -> LoadEstimate:
    return first_load(force, way=way, exponent=0.8, noise=NOISE)


@given(forces=st.lists(st.floats(6.97, 7.03), min_size=2, max_size=20))
def test_load_is_the_mean_with_forgetting(forces: list[float]) -> None:
    """At override 1 the exponent does not matter: the exponentially weighted mean is exact."""
    load = first(forces[0])
    for force in forces[1:]:
        load = learned_load(load, force=force, way=0.0, noise=NOISE)
    weights = LOAD_FORGETTING ** np.arange(len(forces))[::-1]
    assert load.log == pytest.approx(float(weights @ forces / weights.sum()), rel=1e-9)


@pytest.mark.parametrize("exponent", [0.65, 0.75, 0.9])
def test_exponent_is_learned_from_axes_that_move(exponent: float) -> None:
    ways = 0.5 * np.sin(np.arange(200.0))
    noise = np.random.default_rng(1).normal(0.0, 0.01, 200)
    load = first(float(7.0 + exponent * ways[0]), float(ways[0]))
    for way, error in zip(ways, noise, strict=True):
        force = float(7.0 + exponent * way + error)
        load = learned(load, force=force, way=float(way), noise=0.01)
    assert load.exponent == pytest.approx(exponent, abs=0.02)
    assert load.log == pytest.approx(7.0, abs=0.02)


def test_another_depth_is_learned_in_one_revolution() -> None:
    load = first(7.0)
    for _ in range(20):
        load = learned_load(load, force=7.0, way=0.0, noise=NOISE)
    doubled = learned_load(load, force=7.0 + log(2.0), way=0.0, noise=NOISE)
    assert doubled.log == pytest.approx(7.0 + log(2.0), abs=0.01)
    noisy = learned_load(load, force=7.0 + NOISE, way=0.0, noise=NOISE)
    assert noisy.log - 7.0 < 0.5 * NOISE


@given(
    rows=st.lists(
        st.tuples(st.floats(-20.0, 20.0), st.floats(-8.0, 3.0), st.booleans()), max_size=60
    )
)
def test_covariance_stays_positive_and_bounded(rows: list[tuple[float, float, bool]]) -> None:
    load = first(7.0, -0.5)
    for force, way, is_excited in rows:
        load = (learned if is_excited else learned_load)(
            load, force=force, way=way, noise=NOISE
        )
        assert 0.0 < load.variance <= 20.0 * LOAD_VARIANCE
        assert 0.0 <= load.exponent_variance <= EXPONENT_VARIANCE * (1.0 + 1e-9)
        product = load.variance * load.exponent_variance
        assert load.covariance**2 <= product * (1.0 + 1e-6) + 1e-15


def test_exponent_rests_while_the_axes_do() -> None:
    load = first(7.0, -0.5)
    for step in range(100):
        load = learned_load(load, force=7.0 + 0.02 * (-1.0) ** step, way=-0.5, noise=NOISE)
    assert load.exponent == 0.8
    assert load.exponent_variance <= EXPONENT_VARIANCE
