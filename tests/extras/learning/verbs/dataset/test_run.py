"""``dataset`` from Python: rows, CSV and programs, and what is refused."""

from pathlib import Path

import pyarrow.csv
import pytest

import stepnc
from stepnc_model.errors import StepNcError
from tests.extras.learning.test_dataset_run import DESIGN


def test_rows_csv_and_programs_are_written(tmp_path: Path) -> None:
    design, folder = tmp_path / "design.toml", tmp_path / "data"
    design.write_text(DESIGN, encoding="utf-8")
    result = stepnc.dataset(design, output=folder, rows=2, has_csv=True, has_programs=True)
    record = result.record()
    assert (record["rows"], record["made"]) == (2, 2)
    assert pyarrow.csv.read_csv(record["csv"]).num_rows == 2
    assert len(list(Path(record["programs"]).iterdir())) == 2
    assert stepnc.dataset(design, output=folder, rows=2).record()["made"] == 0


def test_a_missing_design_is_refused(tmp_path: Path) -> None:
    with pytest.raises((StepNcError, OSError), match=r"none\.toml"):
        stepnc.dataset(tmp_path / "none.toml", output=tmp_path / "data", rows=2)
