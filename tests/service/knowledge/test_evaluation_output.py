"""The table in every form, to stdout and to files."""

import csv
import io
import json
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kbe.selection import EVERYTHING
from service.knowledge.evaluation_output import put_summary, put_table
from service.reading import silent
from service.requests.knowledge import EvaluationRequest
from stepnc_model.errors import StepNcError

SLOTS = EvaluationRequest(feature_kind="slot", machine="vmc15")


def put(place: Path, form: str, output: Path | None) -> int:
    return put_table(str(place), SLOTS, form=form, output=output, tell=silent)


@pytest.mark.parametrize("form", ["text", "csv", "json", "html"])
def test_a_file_is_what_stdout_shows(
    form: str,
    shop_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    output = tmp_path / f"table.{form}"
    count = put(shop_file, form, output)
    assert capsys.readouterr().out == ""
    assert put(shop_file, form, None) == count > 0
    shown, written = capsys.readouterr().out, output.read_text(encoding="utf-8")
    assert len(shown.splitlines()) == len(written.splitlines())
    assert "ENDMILL 18" in shown
    assert "ENDMILL 18" in written


def test_csv_and_parquet_have_the_same_lines(
    shop_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    put(shop_file, "csv", None)
    lines = list(csv.DictReader(io.StringIO(capsys.readouterr().out, newline="")))
    put(shop_file, "parquet", tmp_path / "table.parquet")
    rows = pq.read_table(tmp_path / "table.parquet").to_pylist()
    assert [float(line["force_mean_percent"]) for line in lines] == [
        row["force_mean_percent"] for row in rows
    ]
    assert [line["tool"] for line in lines] == [row["tool"] for row in rows]


def test_bytes_are_not_for_a_terminal(shop_file: Path) -> None:
    with pytest.raises(StepNcError, match=r"-o FILE\.parquet"):
        put(shop_file, "parquet", None)


def test_a_summary_is_no_page(shop_file: Path, tmp_path: Path) -> None:
    for form in ("html", "text"):
        with pytest.raises(StepNcError, match="to a CSV, JSON or Parquet"):
            put_summary(str(shop_file), EVERYTHING, form=form, output=tmp_path / "x")
    put_summary(str(shop_file), EVERYTHING, form="json", output=tmp_path / "x.json")
    groups = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))["groups"]
    put_summary(str(shop_file), EVERYTHING, form="parquet", output=tmp_path / "x.parquet")
    assert len(groups) == pq.read_table(tmp_path / "x.parquet").num_rows > 0
