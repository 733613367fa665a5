"""The device model of a machine, in every schema version and with both sets of ids."""

from dataclasses import replace

import pytest

from extras.agent.model.documents import DocumentWriter
from extras.agent.model.machine_model import MachineModel, device_uuid, machine_model
from simulator.client.document_choices import NameSet, SchemaVersion
from simulator.library import load_machine, machine_names
from tests.every_case import every_case
from tests.extras.agent.model.conftest import require_valid

MILL = (
    *(f"{axis}_axis_position_sample" for axis in "xyz"),
    *(f"{axis}_axis_wattage_sample" for axis in "xyz"),
    "c_axis_wattage_sample",
    "coolant_wattage_sample",
    "electric_wattage_sample",
)
"""paper 003, Table 2"""

LATHE = (
    "x_axis_position_actual",
    "x_axis_wattage",
    "z_axis_position_actual",
    "z_axis_wattage",
    "c_axis_wattage",
    "coolant_wattage",
    "load_wattage",
)
"""paper 000, §3.4"""


def document(found: MachineModel) -> bytes:
    writer = DocumentWriter(
        model=found.model, sender="test", instance=1, changed="2026-01-01T00:00:00Z"
    )
    return writer.devices(None, assets=0, size=1000)


@every_case("name", machine_names())
@every_case("version", list(SchemaVersion))
@every_case("names", list(NameSet))
def test_every_machine_has_a_valid_model(
    name: str, version: SchemaVersion, names: NameSet
) -> None:
    found = machine_model(load_machine(name), version=version, names=names)
    require_valid(document(found), version.value)


@pytest.mark.parametrize(("machine", "ids"), [("paper003", MILL), ("paper000", LATHE)])
def test_ids_of_the_papers(machine: str, ids: tuple[str, ...]) -> None:
    found = machine_model(load_machine(machine), names=NameSet.PAPERS)
    for id in ids:
        item = found.model.items[found.model.index[id]]
        assert item.category == "SAMPLE"
        assert item.type == ("POSITION" if "position" in id else "WATTAGE")
    wattage = {item.id for item in found.model.items if item.type == "WATTAGE"}
    assert wattage == {id for id in ids if "wattage" in id}


def test_what_a_version_does_not_know_is_left_out_and_told() -> None:
    machine = load_machine("vmc15")
    old = machine_model(machine, version=SchemaVersion.V1_3)
    assert set(old.left_out) == {
        "PATH_FEEDRATE", "PROCESS_KIND_ID", "ELECTRICAL_ENERGY", "PART_GROUP_ID",
    }  # fmt: skip
    new = machine_model(machine, version=SchemaVersion.V2_7)
    assert new.left_out == ()
    step = next(item for item in new.model.items if item.type == "PROCESS_KIND_ID")
    assert step.sub_type == "ISO_STEP_EXECUTABLE"


def test_travels_and_speeds_are_specifications() -> None:
    machine = load_machine("vmc15")
    (linear,) = machine_model(machine).model.root.findall('.//Linear[@name="X"]')
    low, high = machine.axes[0].travel
    travel = linear.find(".//Specification[@type='POSITION']")
    assert (float(travel.findtext("Minimum")), float(travel.findtext("Maximum"))) == (low, high)
    speed = machine_model(machine).model.root.find(".//Rotary//Specification/Maximum")
    assert float(speed.text) == pytest.approx(12_000)


def test_a_users_machine_has_a_model_of_its_own() -> None:
    mine = replace(load_machine("vmc15"), name="shop7")
    found = machine_model(mine).model
    assert {item.id.partition("_")[0] for item in found.items} == {"agent", "shop7"}
    assert device_uuid(mine) != device_uuid(load_machine("vmc15"))
    assert device_uuid(mine) == device_uuid(mine)
