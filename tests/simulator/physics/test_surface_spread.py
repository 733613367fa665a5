from math import log

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import t

from simulator.physics.surface import corner_coefficient
from simulator.physics.surface_spread import (
    RoughnessForecast,
    forecast,
    student_quantile,
    unmeasured_spread,
)
from stepnc_model.units import mm_from_um, speed_from_m_min

STEEL = unmeasured_spread("P")


def of_feed(feed: float, *, m_min: float = 150.0, is_dry: bool = False) -> RoughnessForecast:
    """Surface of a corner of 0.8 mm in steel."""
    return forecast(
        STEEL,
        corner_coefficient(0.8) * feed**2,
        cutting_speed=speed_from_m_min(m_min),
        is_dry=is_dry,
    )


@given(share=st.floats(0.5, 0.95), degrees=st.floats(4.0, 100.0))
def test_quantiles_are_student_s(share: float, degrees: float) -> None:
    expected = float(t.ppf(share, degrees))
    assert student_quantile(share, degrees) == pytest.approx(expected, rel=1e-3, abs=1e-9)


@given(share=st.floats(0.02, 0.98), feed=st.floats(0.0, 0.5))
def test_probability_is_the_inverse_of_the_quantile(share: float, feed: float) -> None:
    found = of_feed(feed)
    assert found.probability(found.quantile(share)) == pytest.approx(share, abs=1e-9)


def test_a_surface_without_a_trace_keeps_the_published_floor() -> None:
    """0.7 µm at 150 m/min, wet; the median of nine studies."""
    assert of_feed(0.0).median == pytest.approx(0.7e-3)


@given(feed=st.floats(0.01, 0.5), more=st.floats(1.01, 3.0), share=st.floats(0.5, 0.95))
def test_a_greater_feed_leaves_a_rougher_surface(
    feed: float, more: float, share: float
) -> None:
    assert of_feed(more * feed).median > of_feed(feed).median
    # Beside the floor a trace of which less is known may narrow the spread a little.
    assert of_feed(more * feed).quantile(share) > 0.97 * of_feed(feed).quantile(share)


def test_a_dry_or_slow_cut_is_rougher() -> None:
    assert of_feed(0.1, is_dry=True).median > of_feed(0.1).median
    assert of_feed(0.1, m_min=80.0).median > of_feed(0.1).median
    assert of_feed(0.1, m_min=20.0).median == of_feed(0.1, m_min=60.0).median


def test_a_published_table_lies_within_the_spread() -> None:
    """AISI 1045, r 0.8 mm, wet, 150 m/min: Hindawi 2018, 2560253, table 3."""
    for feed, measured in ((0.15, 1.181), (0.1, 0.941)):
        found = of_feed(feed)
        away = log(mm_from_um(measured) / found.median) / found.deviation
        assert abs(away) < 1.0


def test_teeth_make_the_trace_of_a_mill_rougher() -> None:
    one, four = (
        forecast(STEEL, 1e-3, cutting_speed=2500.0, is_dry=False, teeth=teeth)
        for teeth in (1, 4)
    )
    assert one.median < four.median < 16.0 * one.median
