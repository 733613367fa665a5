"""Searches of convex functions, against their known least."""

from math import log

import pytest

from optimiser.solver.convex import least_within


@pytest.mark.parametrize("best", [2.0, 31.7, 400.0])
def test_least_speed_of_a_parabola_in_its_logarithm_is_found(best: float) -> None:
    speed = least_within(lambda n: (log(n) - log(best)) ** 2, 1.0, 500.0)
    assert speed == pytest.approx(best, rel=1e-6)


def test_least_at_an_end_is_that_end() -> None:
    assert least_within(lambda n: n, 3.0, 50.0) == pytest.approx(3.0, rel=1e-6)
