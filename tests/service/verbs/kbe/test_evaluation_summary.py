"""The summary of outcomes."""

from math import sqrt
from pathlib import Path
from statistics import mean, stdev

import pytest

from kbe.queries import EVERYTHING
from service.knowledge.evaluation_columns import SUMMARY
from service.knowledge.evaluation_table import Summary, summary
from service.rendering.columns import file_columns, file_rows
from service.verbs.kbe.table.result import SummaryResult
from stepnc_model.outcome import ProcessOutcome


@pytest.fixture(scope="module")
def found(shop_file: Path) -> Summary:
    return summary(str(shop_file), EVERYTHING)


def test_means_and_spreads_are_those_of_the_outcomes(
    found: Summary, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    row = next(file_rows(SUMMARY, found.groups))
    assert list(row) == [field.name for field in file_columns(SUMMARY)]
    group = found.groups[0]
    deviations = [
        100.0 * (each.force.deviation or 0.0)
        for each in shop_outcomes
        if each.context == group.context and each.feature.kind == group.feature_kind
    ]
    assert row["force_count"] == row["outcomes"] == len(deviations)
    assert row["force_mean_percent"] == pytest.approx(mean(deviations), rel=1e-9)
    assert row["force_deviation_percent"] == pytest.approx(
        stdev(deviations), rel=1e-6, abs=sqrt(1e-12)
    )


def test_json_and_table_have_every_group(found: Summary) -> None:
    result = SummaryResult(summary=found)
    assert len(result.record()["groups"]) == len(found.groups)
    out = str(result).splitlines()
    assert len(out) == len(found.groups) + 3
    assert "1200 outcomes" in out[-1]
