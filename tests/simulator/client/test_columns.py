"""Columns of what machines tell."""

from collections.abc import Sequence
from dataclasses import replace
from math import isnan
from pathlib import Path

import pytest
from lxml import etree

from extras.agent.model.machine_model import machine_model
from simulator.client.columns import Cell, RecordedColumn, RowMaker, columns_of
from simulator.client.connection import ClientItem, ClientObservation, items_of
from simulator.client.document_choices import NameSet
from simulator.client.xml_text import without_namespaces
from simulator.library import load_machine
from simulator.machine.timeline import COLUMNS

SHARED = Path(__file__).parents[4] / "shared" / "mtconnect"
OURS = {column.name for column in COLUMNS}


@pytest.mark.parametrize("names", list(NameSet))
def test_columns_of_our_machine_are_those_of_its_simulation(names: NameSet) -> None:
    model = machine_model(load_machine("vmc15"), names=names).model
    found = {each.name for each in columns_of(items_of(model.root))} & OURS
    expected = {
        *(f"{axis}_axis_position_actual" for axis in "xyz"),
        *(f"{axis}_axis_wattage" for axis in "xyz"),
        "c_axis_wattage", "coolant_wattage", "load_wattage", "path_feedrate_actual",
        "rotary_velocity_actual", "cutting_force", "execution", "line", "workingstep",
    }  # fmt: skip
    assert expected <= found
    assert ("electric_wattage" in found) is (names is NameSet.MODERN)


def test_columns_of_a_mill_of_others() -> None:
    file = SHARED / "devices-mill.xml"
    if not file.is_file():
        pytest.skip("devices-mill.xml is not in ../shared/mtconnect")
    root = without_namespaces(etree.parse(str(file)).getroot())
    columns = columns_of(items_of(root.find("Devices")))
    names = [each.name for each in columns]
    assert len(names) == len(set(names))
    expected = {"x_axis_position_actual", "z_axis_wattage", "c_axis_wattage", "workingstep"}
    expected |= {"electric_wattage", "path_feedrate_actual", "execution", "line"}
    assert expected <= set(names)
    assert "mill1_xload" in names


def column(name: str, *, is_text: bool = False) -> RecordedColumn:
    return RecordedColumn(name=name, id=name, units="", is_text=is_text)


def rows_of(*batches: Sequence[ClientObservation]) -> list[dict[str, Cell]]:
    maker = RowMaker(columns=(column("x"), column("y"), column("state", is_text=True)))
    found = [dict(row) for batch in batches for row in maker.rows(batch)]
    return found + [dict(row) for row in maker.last()]


def test_a_row_is_a_moment_and_holds_what_is_known() -> None:
    rows = rows_of(
        [
            ClientObservation("state", 1, 100.0, "ACTIVE"),
            ClientObservation("x", 2, 100.0, "1.5"),
        ],
        [
            ClientObservation("y", 3, 100.0, "2"),
            ClientObservation("other", 4, 100.1, "9"),
            ClientObservation("x", 5, 100.2, "3"),
            ClientObservation("state", 6, 100.3, None),
            ClientObservation("y", 7, 100.4, None),
            ClientObservation("x", 8, 100.5, "odd"),
        ],
    )
    assert [row["time_s"] for row in rows] == [0.0, 0.2, 0.5]
    assert [row["x"] for row in rows][:2] == [1.5, 3.0]
    assert [row["y"] for row in rows][:2] == [2.0, 2.0]
    assert [row["state"] for row in rows] == ["ACTIVE", "ACTIVE", None]
    assert isnan(rows[2]["x"])  # type: ignore[arg-type]
    assert isnan(rows[2]["y"])  # type: ignore[arg-type]


def test_moments_are_in_order_whatever_the_order_of_observations() -> None:
    rows = rows_of(
        [
            ClientObservation("x", 1, 100.2, "2"),
            ClientObservation("x", 2, 100.0, "0"),
            ClientObservation("y", 3, 100.1, "7"),
        ],
        [
            ClientObservation("x", 4, 100.1, "1"),
            ClientObservation("y", 5, 100.15, "8"),
            ClientObservation("x", 6, 100.3, "3"),
        ],
    )
    assert [row["time_s"] for row in rows] == [0.0, 0.1, 0.2, 0.3]
    assert [row["x"] for row in rows] == [0.0, 0.0, 2.0, 3.0]
    assert [row["y"] for row in rows][1:] == [7.0, 8.0, 8.0]


def test_a_clock_that_is_set_back_goes_on() -> None:
    rows = rows_of(
        [ClientObservation("x", 1, 5000.0, "1")],
        [ClientObservation("x", 2, 1400.0, "2")],
        [ClientObservation("x", 3, 1400.1, "3")],
    )
    assert [row["x"] for row in rows] == [1.0, 2.0, 3.0]


def test_a_position_of_the_path_has_a_column_for_each_axis() -> None:
    item = ClientItem(
        id="tip", name="", category="SAMPLE", type="PATH_POSITION", sub_type="ACTUAL",
        units="MILLIMETER_3D", component="Path", component_name="", device="m",
    )  # fmt: skip
    offset = replace(item, id="wo", category="EVENT", type="WORK_OFFSET", sub_type="", units="")
    columns = columns_of([item, offset])
    names = ["path_position_x", "path_position_y", "path_position_z", "work_offset"]
    assert [each.name for each in columns] == names
    assert columns[0].units == "MILLIMETER"
    maker = RowMaker(columns=columns)
    rows = maker.rows([
        ClientObservation("wo", 1, 0.0, "1"),
        ClientObservation("tip", 2, 0.0, "1.5 -2 3"),
        ClientObservation("tip", 3, 1.0, "1.5 -2"),
        ClientObservation("tip", 4, 2.0, None),
    ])
    assert [rows[0][name] for name in names] == [1.5, -2.0, 3.0, "1"]
    assert isnan(float(rows[1]["path_position_z"] or 0.0))
