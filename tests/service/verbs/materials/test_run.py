"""The verb ``materials``."""

import json

import pytest

import stepnc
from simulator.library import material_names
from stepnc_model.errors import StepNcError


def test_every_material_has_a_row_with_its_force() -> None:
    found = stepnc.materials()
    rows = str(found).splitlines()[2:]
    assert [row.split()[0] for row in rows] == list(material_names())
    c45 = next(row for row in found.table().to_pylist() if row["name"] == "c45")
    assert (c45["iso_group"], c45["k_c11_n_mm2"], c45["m_c"]) == ("P", 1500.0, 0.22)


@pytest.mark.parametrize("name", ["c45", "1.0503"])
def test_a_material_is_found_by_its_names_and_tells_its_source(name: str) -> None:
    found = stepnc.materials(name)
    assert str(found).startswith("c45: AISI 1045")
    assert "\nsource: " in str(found)
    assert found.record()["kienzle"]["k_c11"] == 1500.0


def test_json_is_an_array_of_names_and_titles() -> None:
    found: object = json.loads(json.dumps(stepnc.materials().record()))
    assert isinstance(found, list)
    assert [row["name"] for row in found] == list(material_names())
    assert all(row["title"] for row in found)


def test_an_unknown_material_is_refused() -> None:
    with pytest.raises(StepNcError, match="unknown material 'unobtanium'"):
        stepnc.materials("unobtanium")
