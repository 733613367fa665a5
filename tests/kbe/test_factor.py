"""The factor at a degree of caution."""

from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from kbe.factor import SAFE, distribution, factor_at, interval
from tests.kbe.cuts import correction

LEARNED = correction(log(1.3), log_scale=0.06, degrees=7.0)


def test_centre_is_the_factor_itself() -> None:
    assert factor_at(LEARNED, quantile=0.5) == pytest.approx(1.3)


def test_plan_takes_the_safe_factor() -> None:
    wanted = 1.3 * exp(0.06 * stats.t(7).ppf(0.9))
    assert factor_at(LEARNED) == pytest.approx(wanted)


def test_one_run_in_ten_exceeds_the_safe_factor() -> None:
    runs = np.exp(stats.t(7, log(1.3), 0.06).rvs(20_000, random_state=3))
    exceeding = float((runs > factor_at(LEARNED)).mean())
    # Binomial, three standard deviations of 20 000.
    assert exceeding == pytest.approx(1.0 - SAFE, abs=3 * (0.9 * 0.1 / 20_000) ** 0.5)


@given(low=st.floats(0.01, 0.98), more=st.floats(0.001, 0.01))
def test_factor_rises_with_caution(low: float, more: float) -> None:
    assert factor_at(LEARNED, quantile=low + more) > factor_at(LEARNED, quantile=low)


def test_interval_holds_nine_tenths_evenly() -> None:
    seen = interval(LEARNED)
    law = distribution(LEARNED)
    assert seen.centre == pytest.approx(1.3)
    assert law.below(log(seen.low)) == pytest.approx(0.05)
    assert law.below(log(seen.high)) == pytest.approx(0.95)
