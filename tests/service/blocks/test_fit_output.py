"""Text, JSON and page of ``blockfit``."""

import json
from pathlib import Path

import pytest

from service.blocks.block_fit import BlockFitRequest, BlockFitResult, fit_blocks
from service.blocks.fit_output import block_fit_json, block_fit_page, print_block_fit
from tests.service.blocks.test_block_fit import TABLE_2


@pytest.fixture
def result(tmp_path: Path) -> BlockFitResult:
    log = tmp_path / "table.csv"
    log.write_text(TABLE_2, encoding="utf-8")
    return fit_blocks(BlockFitRequest(log=str(log)))


def test_text_shows_fits_with_their_intervals(
    result: BlockFitResult, capsys: pytest.CaptureFixture[str]
) -> None:
    print_block_fit(result)
    shown = capsys.readouterr().out
    assert "through the origin  14516 (14293 to 14739)  4.133 (4.071 to 4.198)" in shown
    assert "held by: block rate 8, unknown 1" in shown


def test_json_has_units_in_its_keys(result: BlockFitResult) -> None:
    wire = json.loads(block_fit_json(result))
    assert wire["block_time_ms"]["low"] < wire["block_time_ms"]["value"]
    assert [each["cause"] for each in wire["points"]][:2] == ["unknown", "block rate"]
    assert wire["points"][1]["feed_mm_min"] == pytest.approx(3.6 * 25.4)
    assert len(wire["fits"][0]["residuals_mm_min"]) == 9


def test_page_says_that_the_printed_slope_is_no_fit(result: BlockFitResult) -> None:
    page = block_fit_page(result)
    assert "14847 per minute, is none of its fits" in page
    assert "printed line, no fit of it" in page
