"""Power over time: energies in intervals, and the demand over quarters of an hour."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from extras.factory.model.power_series import PowerSeries

SPANS = st.lists(
    st.tuples(st.floats(0.0, 3500.0), st.floats(0.01, 3600.0), st.floats(0.0, 1e6)),
    min_size=1,
    max_size=20,
)


@given(spans=SPANS)
def test_energy_is_kept_in_its_place(spans: list[tuple[float, float, float]]) -> None:
    series = PowerSeries(0.0, 3600.0)
    expected = np.zeros(60)
    for begin, length, energy in spans:
        end = min(begin + length, 3600.0)
        series.waiting.extend((begin, end, energy))
        for row in range(60):
            shared = max(0.0, min(end, 60.0 * (row + 1)) - max(begin, 60.0 * row))
            expected[row] += energy * shared / (end - begin)
    assert series.energies() == pytest.approx(expected, rel=1e-6, abs=1e-4)


def test_demand_is_the_greatest_mean_of_a_quarter() -> None:
    series = PowerSeries(0.0, 3600.0)
    series.waiting.extend([0.0, 3600.0, 3.6e6, 1000.0, 1500.0, 1e6, 2690.0, 2710.0, 9e4])
    # 1 kW all the time, and 2 kW for 500 s in the second quarter.
    assert series.demand(3600.0) == pytest.approx(1000.0 + 1e6 / 900.0)
    assert series.demand(1799.0) == pytest.approx(1000.0)


def test_a_short_run_has_its_mean() -> None:
    series = PowerSeries(100.0, 3600.0)
    series.waiting.extend((100.0, 200.0, 5e4))
    assert series.demand(200.0) == pytest.approx(500.0)
