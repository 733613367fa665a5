"""Rows that know where they stand."""

from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.spec import CuttingMaterial
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.placed_row import (
    FileValue,
    edge_values,
    file_length,
    placed_row,
)

FILE = Path("tools.json")


def mill(**changes: FileValue) -> dict[str, FileValue]:
    return {
        "number": FileValue(value=3, place="n"),
        "kind": FileValue(value="endmill", place="type"),
        "diameter_mm": file_length(0.5, "DC", FileUnit.INCH),
    } | changes


def test_lengths_become_millimetres() -> None:
    assert placed_row(mill(), FILE).row.diameter_mm == 12.7


def test_a_refusal_names_the_place_the_value_and_what_the_file_says() -> None:
    given = mill(diameter_mm=file_length(500.0, "DC", FileUnit.INCH))
    with pytest.raises(LibraryError) as refused:
        placed_row(given, FILE, place="data[0]", line=7)
    assert str(refused.value) == (
        "tools.json: line 7: DC: 12700 mm exceeds 2000 mm (the file says 500 inch)"
    )


def test_a_value_that_is_missing_is_named_by_its_key() -> None:
    given = mill()
    del given["diameter_mm"]
    with pytest.raises(LibraryError) as refused:
        placed_row(given, FILE, place="data[0]")
    assert str(refused.value) == (
        "tools.json: data[0]: diameter_mm: missing; expected a number, 0.01 to 2000 mm"
    )


def test_a_length_that_is_no_number_stays_to_be_refused() -> None:
    given = mill(diameter_mm=file_length("wide", "DC", FileUnit.INCH))
    with pytest.raises(LibraryError, match="DC: 'wide' is not a number"):
        placed_row(given, FILE)


@pytest.mark.parametrize(
    ("name", "material"),
    [
        ("HSS", CuttingMaterial.HSS),
        (" Carbide", CuttingMaterial.CARBIDE),
        ("ceramics", CuttingMaterial.CERAMIC),
    ],
)
def test_names_of_edge_materials(name: str, material: CuttingMaterial) -> None:
    assert edge_values(name, "BMC")["cutting_material"].value == material


def test_an_unknown_edge_material_gives_nothing() -> None:
    assert edge_values("unspecified", "BMC") == {}
