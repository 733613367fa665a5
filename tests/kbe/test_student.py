"""Student's t against scipy.stats, which computes it in another way."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from kbe.statistics import StudentT
from tests.every_case import every_case

LAWS = st.builds(
    StudentT,
    centre=st.floats(-3.0, 3.0),
    scale=st.floats(0.01, 10.0),
    degrees=st.floats(1.0, 200.0),
)


@given(law=LAWS, probability=st.floats(0.001, 0.999))
def test_quantile_is_that_of_scipy_stats(law: StudentT, probability: float) -> None:
    wanted = stats.t(law.degrees, law.centre, law.scale).ppf(probability)
    assert law.quantile(probability) == pytest.approx(wanted, rel=1e-7, abs=1e-9)


@given(law=LAWS, low=st.floats(-30.0, 30.0), width=st.floats(0.0, 30.0))
def test_probability_of_an_interval_is_that_of_scipy_stats(
    law: StudentT, low: float, width: float
) -> None:
    known = stats.t(law.degrees, law.centre, law.scale)
    wanted = known.cdf(low + width) - known.cdf(low)
    assert law.between(low, low + width) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize(("degrees", "wanted"), [(1, 6.314), (5, 2.015), (10, 1.812)])
def test_printed_table_of_the_95th_of_100(degrees: int, wanted: float) -> None:
    found = StudentT(centre=0.0, scale=1.0, degrees=degrees).quantile(0.95)
    assert found == pytest.approx(wanted, abs=5e-4)


@every_case(("scale", "degrees"), [(0.0, 3.0), (1.0, 0.0), (float("nan"), 3.0)])
def test_what_is_no_distribution_is_refused(scale: float, degrees: float) -> None:
    with pytest.raises(ValueError, match="above 0"):
        StudentT(centre=0.0, scale=scale, degrees=degrees)


@pytest.mark.parametrize("probability", [0.0, 1.0, -0.1])
def test_certainty_has_no_quantile(probability: float) -> None:
    with pytest.raises(ValueError, match="probability"):
        StudentT(centre=0.0, scale=1.0, degrees=3.0).quantile(probability)
