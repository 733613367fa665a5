"""Intervals over replications, beside Student's table."""

from math import inf, nan, sqrt

import pytest

from extras.factory.model.measures import (
    Level,
    Measure,
    Quantity,
    half_width,
    over_replications,
)


@pytest.mark.parametrize(
    ("count", "confidence", "quantile"),
    [(2, 0.95, 12.706), (10, 0.95, 2.262), (30, 0.95, 2.045), (30, 0.999, 3.659)],
)
def test_half_widths(count: int, confidence: float, quantile: float) -> None:
    values = [float(row) for row in range(count)]
    spread = sqrt(sum((each - sum(values) / count) ** 2 for each in values) / (count - 1))
    assert half_width(values, confidence=confidence) == pytest.approx(
        quantile * spread / sqrt(count), rel=5e-4
    )


def of(value: float) -> tuple[Measure, ...]:
    return (Measure(level=Level.LINE, name="", quantity=Quantity.WIP, value=value),)


def test_one_replication_has_no_interval() -> None:
    found = over_replications([of(3.0)])[0]
    assert (found.mean, found.half_width, found.count) == (3.0, inf, 1)


def test_runs_without_a_figure_do_not_count() -> None:
    found = over_replications([of(3.0), of(nan), of(5.0)])[0]
    assert (found.mean, found.count) == (4.0, 2)
