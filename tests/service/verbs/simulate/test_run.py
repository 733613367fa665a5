"""``simulate`` takes programs of every kind, told by their content."""

from pathlib import Path

import pytest

import stepnc
from stepnc_model.errors import StepNcError
from tests.golden.stories import CODE, STOCK, TOOLS

PAPER = Path(__file__).parents[4] / "examples" / "parts" / "paper002.stpnc"


def test_nc_code_is_run_as_a_file_and_by_its_option(tmp_path: Path) -> None:
    code, tools = tmp_path / "O1001", tmp_path / "tools.csv"
    code.write_text(CODE, encoding="ascii")
    tools.write_text(TOOLS, encoding="ascii")
    one = stepnc.simulate(
        code, tools=tools, stock=STOCK, material="c45", machine="vmc15"
    ).record()
    other = stepnc.simulate(
        nc=code, tools=tools, stock=STOCK, material="c45", machine="vmc15"
    ).record()
    assert one == other
    assert one["total"]["volume_mm3"] > 7000.0


def test_a_run_has_tables_a_page_and_a_figure(tmp_path: Path) -> None:
    page = tmp_path / "run.html"
    found = stepnc.simulate(PAPER, machine="vmc15", material="c45", report=page)
    assert page.read_text(encoding="utf-8").count("<html") == 1
    assert found.table()["time_s"].to_pylist()
    assert found.plot().data
    assert "kWh" in str(found)


def test_options_of_nc_code_need_it(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="--dialect needs NC code"):
        stepnc.simulate(PAPER, machine="vmc15", dialect="haas")
    with pytest.raises(StepNcError, match="--tools-unit needs a tool table"):
        stepnc.simulate(PAPER, machine="vmc15", tools_unit="mm")
    with pytest.raises(StepNcError, match="kept no signals"):
        stepnc.simulate(PAPER, machine="vmc15").page()
