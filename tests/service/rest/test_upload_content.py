"""Uploaded files are refused with what is wrong before they are stored."""

from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import parquet

from service.rest import upload_content as inputs
from service.rest.upload_content import STREAMS, require_content
from service.storage.files import FileKind
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

HEADING = "time_s,x_axis_position_actual,z_axis_position_actual\n"
TRIANGLE = "solid a\n" + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n" + "endsolid\n"
TOOLS = '[[tool]]\nnumber = 4\nkind = "endmill"\ndiameter_mm = 10\n'


@every_case(
    ("kind", "name", "text"),
    [
        (FileKind.LOG, "run.csv", f"{HEADING}0,1,2\n"),
        (
            FileKind.LOG,
            "run.csv",
            f"{HEADING}0;1,5;2\n".replace(",x", ";x").replace(",z", ";z"),
        ),
        (FileKind.LOG, "run.shdr", "* comment\n2026-01-05T06:00:00Z|x_axis_position|12.5\n"),
        (FileKind.LOG, "run.xml", "<MTConnectStreams/>"),
        (FileKind.TOOLS, "tools.toml", TOOLS),
        (FileKind.REQUIRED_PART, "part.stl", TRIANGLE),
    ],
)
def test_good_files_are_accepted(kind: FileKind, name: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    require_content(kind, path)


@every_case(
    ("kind", "name", "text", "why"),
    [
        (FileKind.LOG, "run.csv", "time_s,x\n", "x_axis_position_actual"),
        (FileKind.LOG, "run.csv", "\0\0\0", "time_s"),
        (FileKind.LOG, "run.parquet", "PAR1", "cannot be read"),
        (FileKind.LOG, "run.xml", "<a/>", "MTConnectStreams"),
        (FileKind.LOG, "run.xml", "<a", "line 1: not well-formed"),
        (FileKind.LOG, "run.xml", f"<{STREAMS}><a></{STREAMS}>", "line 1: not well-formed"),
        (FileKind.LOG, "run.xml", f"<!DOCTYPE a><{STREAMS}/>", "document type"),
        (FileKind.LOG, "run.shdr", "yesterday|x|1\n", "no line of SHDR"),
        (FileKind.LOG, "run.log", "x" * 200_000, "no line of SHDR"),
        (FileKind.TOOLS, "tools.toml", "[[tool]]\nnumber = -1\n", "number"),
        (FileKind.REQUIRED_PART, "part.stl", "solid a\nendsolid\n", "no triangles"),
        (FileKind.REQUIRED_PART, "part.stl", "ISO-10303-21;", "no DATA section"),
    ],
)
def test_other_files_are_refused(
    kind: FileKind, name: str, text: str, why: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StepNcError, match=why):
        require_content(kind, path)


def test_a_table_has_a_bounded_number_of_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inputs, "MOST_ROWS", 10)
    path = tmp_path / "run.parquet"
    for rows in (0, 11):
        columns = {name: pa.array([0.0] * rows) for name in HEADING.strip().split(",")}
        parquet.write_table(pa.table(columns), path)
        with pytest.raises(StepNcError, match=f"{rows} rows: it must be 1 to 10"):
            require_content(FileKind.LOG, path)


def test_a_document_has_a_bounded_number_of_elements(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inputs, "MOST_ELEMENTS", 10)
    path = tmp_path / "run.xml"
    for count in (9, 10):
        path.write_text(f"<{STREAMS}>{'<a/>' * count}</{STREAMS}>", encoding="utf-8")
        if count == 9:
            require_content(FileKind.LOG, path)
    with pytest.raises(StepNcError, match="more than 10 elements"):
        require_content(FileKind.LOG, path)
