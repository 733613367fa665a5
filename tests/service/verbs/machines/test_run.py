"""The verb ``machines``."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

import stepnc
from service.verbs.library import EntryResult
from service.verbs.machines.result import machine_facts
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine, machine_names
from simulator.spec import ModeDirection, VibratingPart, VibrationMode
from stepnc_model.errors import StepNcError

MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="END MILL 20MM",
    direction=ModeDirection.XY,
    natural_frequency=1_150.0,
    damping_ratio=0.03,
    stiffness=5_000.0,
    source="tap test",
)


def test_every_machine_has_a_row_with_its_power() -> None:
    found = stepnc.machines()
    rows = str(found).splitlines()[2:]
    assert [row.split()[0] for row in rows] == list(machine_names())
    power = {row["name"]: row["power_kw"] for row in found.table().to_pylist()}
    assert power["vmc15"] == 15.0
    assert found.table("machines")["title"].to_pylist()[0]


def test_a_machine_tells_its_source_and_all_its_data() -> None:
    found = stepnc.machines("vmc15")
    assert str(found).startswith("vmc15: ")
    assert "\nsource: " in str(found)
    assert found.record()["spindle"]["max_speed"] == load_machine("vmc15").spindle.max_speed


def test_a_machine_may_be_a_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(machine_toml(replace(load_machine("vmc15"), title="Mine")))
    assert stepnc.machines(str(file)).record()["title"] == "Mine"


def test_an_unknown_machine_is_answered_with_the_known_ones() -> None:
    with pytest.raises(StepNcError, match="unknown machine 'nonsense'; known: "):
        stepnc.machines("nonsense")


def test_a_machine_shows_its_measured_modes() -> None:
    work = replace(MODE, part=VibratingPart.WORKPIECE, tool="", direction=ModeDirection.X)
    wide = replace(MODE, tool="", tool_diameter=12.0)
    machine = replace(load_machine("vmc15"), modes=(MODE, work, wide))
    shown = str(EntryResult(entry=machine, facts=machine_facts(machine)))
    assert re.search(
        r"mode of tool END MILL 20MM along xy +1150 Hz, damping 0\.03, 5 N/µm", shown
    )
    assert "mode of workpiece along x " in shown
    assert "mode of tool 12 mm along xy " in shown
