"""Tolerances of ISO 286-1:2010, Table 1, and ISO 2768-1:1989, Table 1, as they are printed."""

import pytest

from stepnc_model.programs.tolerance import general_tolerance, standard_tolerance
from tests.every_case import every_case


@every_case(
    ("size", "grade", "micrometres"),
    [
        (3.0, 6, 6.0),
        (3.0, 11, 60.0),
        (5.0, 7, 12.0),
        (6.0, 8, 18.0),
        (10.0, 6, 9.0),
        (10.0, 14, 360.0),
        (12.0, 7, 18.0),
        (16.0, 9, 43.0),
        (20.0, 7, 21.0),
        (25.0, 7, 21.0),
        (25.0, 12, 210.0),
        (30.0, 5, 9.0),
        (40.0, 6, 16.0),
        (50.0, 8, 39.0),
        (50.0, 7, 25.0),
        (63.0, 7, 30.0),
        (80.0, 10, 120.0),
        (100.0, 14, 870.0),
        (120.0, 7, 35.0),
        (150.0, 7, 40.0),
        (180.0, 3, 8.0),
        (200.0, 6, 29.0),
        (300.0, 7, 52.0),
        (400.0, 7, 57.0),
        (500.0, 7, 63.0),
        (500.0, 1, 8.0),
        (630.0, 6, 44.0),
        (1000.0, 9, 230.0),
        (3150.0, 18, 33000.0),
    ],
)
def test_standard_tolerance_is_the_printed_one(
    size: float, grade: int, micrometres: float
) -> None:
    assert standard_tolerance(size, grade) == pytest.approx(micrometres * 1e-3, rel=1e-12)


@every_case(
    ("size", "deviation"),
    [
        (0.5, 0.1),
        (3.0, 0.1),
        (3.5, 0.1),
        (6.0, 0.1),
        (6.5, 0.2),
        (30.0, 0.2),
        (31.0, 0.3),
        (120.0, 0.3),
        (121.0, 0.5),
        (400.0, 0.5),
        (401.0, 0.8),
        (1000.0, 0.8),
        (1001.0, 1.2),
        (2000.0, 1.2),
        (2001.0, 2.0),
        (4000.0, 2.0),
    ],
)
def test_general_tolerance_is_the_printed_one(size: float, deviation: float) -> None:
    assert general_tolerance(size).half_width == deviation
    assert general_tolerance(size).code == "ISO 2768-m"


@every_case("grade", range(6, 19))
@every_case("size", [4.5, 8.0, 14.0, 24.0, 40.0, 65.0, 100.0, 150.0, 215.0, 450.0])
def test_standard_tolerance_follows_the_formula_of_its_annex(size: float, grade: int) -> None:
    """``i = 0.45·∛D + 0.001·D`` µm, 10 i for IT6, then steps of R5; the printed are rounded."""
    unit = 0.45 * size ** (1.0 / 3.0) + 0.001 * size
    expected = 10.0 ** (1.0 + (grade - 6) / 5.0) * unit * 1e-3
    assert standard_tolerance(size, grade) == pytest.approx(expected, rel=0.1)
