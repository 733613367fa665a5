"""Units of length, and sizes that names of tools state."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.tool_files.file_unit import FileUnit, named_sizes, other_size
from tests.every_case import every_case


@every_case(
    ("name", "sizes"),
    [
        ("1/8 end mill", [3.175]),
        ("1-1/2 face mill", [38.1]),
        ('0.25" ball', [6.35]),
        ("6mm end mill", [6.0]),
        ("END MILL 20MM", [20.0]),
        ("2.5 mm drill", [2.5]),
        (".5 inch", [12.7]),
        ("Drill 1/16 - 1/8", [1.5875, 3.175]),
        ("#7 tap drill", []),
        ("M6 tap", []),
        ("roughing, 4 flutes", []),
        ("1/0 nothing", []),
    ],
)
def test_sizes_of_a_name(name: str, sizes: list[float]) -> None:
    assert list(named_sizes(name)) == pytest.approx(sizes)


@every_case(
    ("name", "diameter", "told"),
    [
        ("1/8 end mill", 0.125, 3.175),
        ("1/8 end mill", 3.175, None),
        ("2mm end mill", 50.8, 2.0),
        ("12 mm mill, 0.5 inch shank", 12.7, None),
        ("9.8 mm drill", 10.0, None),
        ("mill", 0.5, None),
    ],
)
def test_a_name_contradicts_a_diameter_by_an_inch_only(
    name: str, diameter: float, told: float | None
) -> None:
    assert other_size(name, diameter) == (None if told is None else pytest.approx(told))


@given(st.floats(0.1, 60.0), st.text(max_size=40))
def test_a_diameter_that_its_name_states_is_never_refused(size: float, more: str) -> None:
    assert other_size(f"{size:.3f} mm {more}", size) is None


def test_an_inch_is_25_4_mm() -> None:
    assert FileUnit.INCH.mm(2.0) == 50.8
    assert FileUnit.MM.mm(2.0) == 2.0
