"""Tables of cuts: read with decimal commas, refused with line and column."""

from pathlib import Path

import pytest

from extras.calibration.model.cut_table import kept_rows, kept_text, read_cut_table
from simulator.errors import CalibrationError


def _table(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_semicolons_and_decimal_commas_are_read(tmp_path: Path) -> None:
    table = read_cut_table(_table(tmp_path / "a.csv", "feed_mm;ra_um;tool\n0,1;1,5;T1\n;;\n"))
    (row,) = table.rows
    assert row.numbers == {"feed_mm": 0.1, "ra_um": 1.5}
    assert row.key == "tool T1"


def test_unknown_columns_are_told_with_the_nearest_name(tmp_path: Path) -> None:
    table = read_cut_table(_table(tmp_path / "a.csv", "feed_mm,ra_mm\n0.1,1.5\n"))
    assert "ra_um" in table.findings[0].message


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("feed_mm\nx\n", "line 2: feed_mm: 'x' is not a number"),
        ("feed_mm\n0.1\n200\n", "line 3: feed_mm: 200 is outside 0.0001 to 20"),
        ("feed_mm\nnan\n", "line 2: feed_mm: nan is outside"),
        ("feed_mm,use\n0.1,both\n", "line 2: use: 'both' must be fit, test or empty"),
        ("feed_mm,feed_mm\n1,2\n", "line 1: feed_mm: the column occurs twice"),
        ("feed_mm\n1,2\n", "line 2: more cells than columns"),
        ("feed_mm\n", "no rows"),
        ("a,b\n1,2\n", "line 1: no column of a cut"),
    ],
)
def test_what_is_no_cut_is_refused_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(CalibrationError, match=said):
        read_cut_table(_table(tmp_path / "a.csv", text))


def test_kept_rows_are_those_that_were_read(tmp_path: Path) -> None:
    text = "feed_mm,ra_um,coolant,use\n0.2,2.5,wet,fit\n0.1,1.5,dry,\n"
    rows = read_cut_table(_table(tmp_path / "a.csv", text)).rows
    again = kept_rows(kept_text(rows), "")
    assert sorted(row.text for row in rows) == [row.text for row in again]
