"""The table in every format, to stdout and to files."""

import csv
import io
import json
from pathlib import Path

import pyarrow.parquet as pq
import pytest

import stepnc
from service.outputs.output_format import OutputFormat
from service.verbs.kbe.table.result import EvaluationResult, SummaryResult
from stepnc_model.errors import StepNcError


def table(place: Path, **words: object) -> EvaluationResult:
    found = stepnc.kbe_table(kb=str(place), feature_kind="slot", machine="vmc15", **words)  # type: ignore[arg-type]
    assert isinstance(found, EvaluationResult)
    return found


@pytest.mark.parametrize("form", ["text", "csv", "json", "html"])
def test_a_file_is_what_is_printed(form: str, shop_file: Path, tmp_path: Path) -> None:
    output = tmp_path / f"table.{form}"
    shown = table(shop_file, output=output, format=form).printed(OutputFormat(form))
    assert output.read_text(encoding="utf-8") == f"{shown}\n"
    assert "ENDMILL 18" in shown


def test_csv_and_parquet_have_the_same_lines(shop_file: Path, tmp_path: Path) -> None:
    file = tmp_path / "table.parquet"
    shown = table(shop_file, output=file).printed(OutputFormat.CSV)
    lines = list(csv.DictReader(io.StringIO(shown, newline="")))
    rows = pq.read_table(file).to_pylist()
    assert [float(line["force_mean_percent"]) for line in lines] == [
        row["force_mean_percent"] for row in rows
    ]
    assert [line["tool"] for line in lines] == [row["tool"] for row in rows]


def test_bytes_are_not_for_a_terminal(shop_file: Path) -> None:
    with pytest.raises(StepNcError, match=r"-o FILE\.parquet"):
        table(shop_file, format="parquet")


def test_a_summary_is_no_page(shop_file: Path, tmp_path: Path) -> None:
    found = stepnc.kbe_table(kb=str(shop_file), summary=True, output=tmp_path / "x.json")
    assert isinstance(found, SummaryResult)
    with pytest.raises(StepNcError, match="to a CSV, JSON, Parquet or text"):
        found.save(tmp_path / "x.html")
    groups = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))["groups"]
    rows = pq.read_table(found.save(tmp_path / "x.parquet")).num_rows
    assert len(groups) == rows == len(found.summary.groups) > 0
