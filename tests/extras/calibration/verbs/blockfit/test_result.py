"""Text, JSON and page of ``blockfit``."""

import json
from pathlib import Path

import pytest

import stepnc
from tests.extras.calibration.verbs.blockfit.test_run import TABLE_2


@pytest.fixture
def result(tmp_path: Path) -> stepnc.Result:
    log = tmp_path / "table.csv"
    log.write_text(TABLE_2, encoding="utf-8")
    return stepnc.blockfit(log)


def test_text_shows_fits_with_their_intervals(result: stepnc.Result) -> None:
    shown = str(result)
    assert "through the origin  14516 (14293 to 14739)  4.133 (4.071 to 4.198)" in shown
    assert "held by: block rate 8, unknown 1" in shown


def test_json_has_units_in_its_keys(result: stepnc.Result) -> None:
    wire = json.loads(json.dumps(result.record()))
    assert wire["block_time_ms"]["low"] < wire["block_time_ms"]["value"]
    assert [each["cause"] for each in wire["points"]][:2] == ["unknown", "block rate"]
    assert wire["points"][1]["feed_mm_min"] == pytest.approx(3.6 * 25.4)
    assert len(wire["fits"][0]["residuals_mm_min"]) == 9


def test_page_says_that_the_printed_slope_is_no_fit(result: stepnc.Result) -> None:
    page = result.page()
    assert "14847 per minute, is none of its fits" in page
    assert "printed line, no fit of it" in page
