"""``factory`` from Python: figures, page, and options of a live shop."""

from pathlib import Path

import pytest

import stepnc
from extras.factory.verbs.factory.result import ShopResult
from extras.factory.verbs.factory.run import REPORT
from stepnc_model.errors import StepNcError
from tests.extras.factory.shops import TIMED


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    path = tmp_path / "shop.toml"
    path.write_text(TIMED.format(hours=2), encoding="utf-8")
    return path


def test_figures_are_text_json_and_table(shop: Path) -> None:
    result = stepnc.factory(shop, replications=2)
    assert isinstance(result, ShopResult)
    assert "± 95 % interval of the mean" in str(result)
    record = result.record()
    assert record["hours"] == 2.0
    assert result.table("measures")["quantity"].to_pylist() == [
        each["quantity"] for each in record["measures"]
    ]
    assert result.csv().count("\n") == 1 + len(record["measures"])


def test_the_page_is_in_the_folder(shop: Path, tmp_path: Path) -> None:
    stepnc.factory(shop, output=tmp_path / "out", has_report=True)
    assert "States over time" in (tmp_path / "out" / REPORT).read_text(encoding="utf-8")


def test_what_does_not_fit_is_refused(shop: Path, tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="--report, --documents and --energy write files"):
        stepnc.factory(shop, has_report=True)
    with pytest.raises(StepNcError, match="--port needs --live"):
        stepnc.factory(shop, port=5001)
    with pytest.raises(StepNcError, match="leave out -o"):
        stepnc.factory(shop, is_live=True, output=tmp_path / "out")
    with pytest.raises(StepNcError, match="leave out --replications"):
        stepnc.factory(shop, is_live=True, replications=2)
