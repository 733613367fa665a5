"""Text, JSON, page and tables of ``cycletime``."""

import json
from pathlib import Path

import pandas as pd
import pytest

import stepnc
from tests.service.verbs.cycletime.test_run import code


@pytest.fixture
def result(tmp_path: Path) -> stepnc.Result:
    return stepnc.cycletime(code(tmp_path), machine="vmc15")


def test_text_shows_times_side_by_side(result: stepnc.Result) -> None:
    shown = str(result)
    assert "part.ngc: machine vmc15, 4.2 ms a block, control fir" in shown
    assert "theoretical s  block rate s  predicted s" in shown
    assert "hint: " in shown


def test_json_has_rows_stretches_and_hints(result: stepnc.Result) -> None:
    wire = json.loads(json.dumps(result.record()))
    assert wire["total"]["theoretical_s"] == pytest.approx(1.0)
    assert wire["total"]["actual_s"] is None
    assert wire["stretches"][0]["cause"] == "block rate"
    assert wire["block_time_ms"] == pytest.approx(4.2)


def test_page_draws_the_feed_of_each_block(result: stepnc.Result) -> None:
    page = result.page()
    assert "by the block rate" in page
    assert "Blocks that lose most" in page


def test_tables_and_files(result: stepnc.Result, tmp_path: Path) -> None:
    assert result.table("rows")["theoretical_s"].to_pylist() == pytest.approx([1.0])
    saved = pd.read_csv(result.save(tmp_path / "rows.csv"))
    assert list(saved["predicted_s"]) == list(result.to_pandas()["predicted_s"])
    assert "<td>1.00</td>" in result._repr_html_()
