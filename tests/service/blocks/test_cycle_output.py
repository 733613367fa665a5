"""Text, JSON and page of ``cycletime``."""

import json
from pathlib import Path

import pytest

from service.blocks.cycle_output import cycle_time_json, cycle_time_page, print_cycle_time
from service.blocks.cycle_time import CycleTimeRequest, CycleTimeResult, cycle_time
from tests.service.blocks.test_cycle_time import code


@pytest.fixture
def result(tmp_path: Path) -> CycleTimeResult:
    return cycle_time(CycleTimeRequest(file=code(tmp_path), machine="vmc15"))


def test_text_shows_times_side_by_side(
    result: CycleTimeResult, capsys: pytest.CaptureFixture[str]
) -> None:
    print_cycle_time(result)
    shown = capsys.readouterr().out
    assert "part.ngc: machine vmc15, 4.2 ms a block, control fir" in shown
    assert "theoretical s  block rate s  predicted s" in shown
    assert "hint: " in shown


def test_json_has_rows_stretches_and_hints(result: CycleTimeResult) -> None:
    wire = json.loads(cycle_time_json(result))
    assert wire["total"]["theoretical_s"] == pytest.approx(result.total.programmed)
    assert wire["total"]["actual_s"] is None
    assert wire["stretches"][0]["cause"] == "block rate"
    assert wire["block_time_ms"] == pytest.approx(4.2)


def test_page_draws_the_feed_of_each_block(result: CycleTimeResult) -> None:
    page = cycle_time_page(result)
    assert "by the block rate" in page
    assert "Blocks that lose most" in page
