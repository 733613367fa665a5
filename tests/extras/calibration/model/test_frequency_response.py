"""Frequency responses from CSV files, good and bad."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from extras.calibration.model.modal_fit import read_response
from simulator.errors import CalibrationError
from tests.every_case import every_case

ROWS: list[tuple[float, ...]] = [(100.0 * row, 1.0 + row, -0.5 * row) for row in range(12)]
GOOD = "frequency_hz,real_mm_n,imag_mm_n"


def write(path: Path, heading: str, rows: Sequence[tuple[float, ...]]) -> Path:
    lines = [heading, *(",".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("heading", "factor"),
    [
        ("frequency_hz,real_mm_n,imag_mm_n", 1.0),
        ("frequency_hz,real_um_n,imag_um_n", 1e-3),
        ("Frequency (Hz),Real (µm/N),Imaginary (µm/N)", 1e-3),
        ("Freq [Hz],Re [m/N],Im [m/N]", 1e3),
    ],
)
def test_a_receptance_comes_in_mm_per_n(heading: str, factor: float, tmp_path: Path) -> None:
    found = read_response(write(tmp_path / "tap.csv", heading, ROWS))
    assert found.name == "tap"
    assert found.frequency.tolist() == [row[0] for row in ROWS[1:]]
    expected = [factor * complex(row[1], row[2]) for row in ROWS[1:]]
    assert found.receptance.tolist() == pytest.approx(expected)


def test_a_semicolon_or_tab_separates_cells_with_decimal_commas(tmp_path: Path) -> None:
    path = write(tmp_path / "tap.csv", "frequency_hz,real_mm_n,imag_mm_n", ROWS)
    plain = path.read_text("utf-8")
    for mark in ";\t":
        path.write_text(plain.replace(",", mark).replace(".", ","), encoding="utf-8")
        found = read_response(path)
        assert found.frequency.tolist() == [row[0] for row in ROWS[1:]]
        assert found.receptance.tolist() == [complex(row[1], row[2]) for row in ROWS[1:]]


def test_an_accelerance_is_divided_by_minus_omega_squared(tmp_path: Path) -> None:
    path = write(tmp_path / "tap.csv", "frequency_hz,real_m_s2_n,imag_m_s2_n", ROWS)
    found = read_response(path)
    omega = 2.0 * np.pi * found.frequency[0]
    assert found.receptance[0] == pytest.approx(-1e3 * (2.0 - 0.5j) / omega**2)


@every_case(
    ("heading", "rows", "line", "column", "word"),
    [
        ("f,real_mm_n,imag_mm_n", ROWS, 0, "frequency_hz", "missing"),
        ("frequency_hz,a,b", ROWS, 0, "", "no column with the real part"),
        ("frequency_hz,real_mm_n,imag_m_n", ROWS, 0, "imag_mm_n", "missing"),
        ("frequency_hz,real_mm_n,real_m_n", ROWS, 0, "real_m_n", "one unit"),
        (GOOD, ROWS[:5], 0, "", "5 complete samples"),
        (GOOD, [*ROWS, (300.0, 1.0, 1.0)], 14, "frequency_hz", "ascend"),
        (GOOD, [*ROWS, (2e5, 1.0, 1.0)], 14, "frequency_hz", "200000 Hz"),
        (GOOD, [(-5.0, 1.0, 1.0), *ROWS], 2, "frequency_hz", "-5 Hz"),
        (GOOD, [(row[0], 0.0, 0.0) for row in ROWS], 0, "real_mm_n", "zero"),
    ],
)
def test_a_bad_file_is_told_with_line_and_column(
    heading: str,
    rows: list[tuple[float, ...]],
    line: int,
    column: str,
    word: str,
    tmp_path: Path,
) -> None:
    path = write(tmp_path / "tap.csv", heading, rows)
    with pytest.raises(CalibrationError) as error:
        read_response(path)
    assert (error.value.line, error.value.column) == (line, column)
    assert word in str(error.value)


def test_a_refusal_names_file_line_column_value_and_bound(tmp_path: Path) -> None:
    path = write(tmp_path / "tap.csv", GOOD, [*ROWS, (2e5, 1.0, 1.0)])
    with pytest.raises(CalibrationError) as error:
        read_response(path)
    assert str(error.value) == (
        f"{path}: line 14: frequency_hz: 200000 Hz, expected 0 to 100000 Hz"
    )


def test_a_cell_that_is_no_number_is_told_with_its_line(tmp_path: Path) -> None:
    path = write(tmp_path / "tap.csv", "frequency_hz,real_mm_n,imag_mm_n", ROWS)
    path.write_text(path.read_text().replace("300.0,4.0", "300.0,four"))
    with pytest.raises(CalibrationError, match=r"line 5: real_mm_n: 'four' is not a number"):
        read_response(path)
