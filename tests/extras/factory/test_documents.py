"""MTConnect documents of the first parts of a shop."""

from dataclasses import replace
from pathlib import Path

import pytest
from lxml import etree

from extras.factory.cycles import PartCycles
from extras.factory.documents import FirstParts, PartDocuments
from extras.factory.model.cycle import cycle_of
from extras.factory.model.records import Listeners
from extras.factory.model.shop_file import read_shop
from extras.factory.model.streams import Streams
from extras.factory.plan import machining_plan
from extras.factory.replications import run_shop
from extras.factory.requests import FactoryRequest
from extras.factory.run import run_factory
from service.programs.machine_choice import material_for
from service.programs.reading import read_program
from service.progress import silent
from service.requests.runs import SimulationRequest
from service.simulation.run import machine_of
from service.simulation.setup import prepared_program
from simulator.machine.interpreter import interpret
from simulator.machine.virtual import VirtualMachine
from tests.extras.agent.model.conftest import require_valid
from tests.extras.factory.shops import PARTS

FIXED = """
title = "Slots on the machine of paper 003"
hours = 1
[[machine]]
name = "MILL 1"
machine = "paper003"
[[machine]]
name = "saw"
[[product]]
name = "slot"
batch = 3
[[product.step]]
machines = ["saw"]
time_s = 30
power_w = 100
[[product.step]]
machines = ["MILL 1"]
program = "paper003_case1.stpnc"
"""

DRAWN = """
hours = 0.5
[[machine]]
name = "MILLING_MACHINE_1"
machine = "paper003"
[[product]]
name = "pocket"
material = "steel"
batch = 2
[[product.step]]
program = "paper003_pocket.stpnc"
machines = ["MILLING_MACHINE_1"]
[product.step.vary]
feed_mm_s = [60, 90]
"""


def shop_file(folder: Path, text: str) -> Path:
    for part in ("paper003_case1.stpnc", "paper003_pocket.stpnc"):
        (folder / part).write_bytes((PARTS / part).read_bytes())
    file = folder / "shop.toml"
    file.write_text(text, encoding="utf-8")
    return file


def value(root: etree._Element, name: str) -> list[str]:
    return [
        each.text or "" for each in root.iter() if isinstance(each.tag, str)
        and each.get("name") == name and each.get("dataItemId") is not None
    ]  # fmt: skip


def test_a_part_has_the_energy_of_the_table(tmp_path: Path) -> None:
    shop = read_shop(shop_file(tmp_path, FIXED))
    plan = machining_plan(shop, PartCycles(), place="shop.toml")
    chosen, streams = FirstParts(3), Streams(seed=11)
    run_shop(shop, plan, streams, listeners=Listeners(part=(chosen.part,)))
    maker = PartDocuments(shop, plan, Streams(seed=11), tell=silent)
    program = read_program(tmp_path / "paper003_case1.stpnc", units="iso")
    milled = [part for part in chosen.parts if part.made.machine == 0]
    assert len(milled) == 3
    assert len({part.made.energy for part in milled}) == 3
    for part in milled:
        run = maker.run(part)
        # The same machine once more, for the exact energy.
        prepared = prepared_program(
            program, run.virtual.machine, material_for("", program), tell=silent
        )
        fresh = machine_of(SimulationRequest(), prepared).setup
        again = VirtualMachine(replace(fresh, deviation=run.virtual.setup.deviation))
        cycle = cycle_of(again.run(interpret(prepared.blocks, again.machine)), again.machine)
        assert cycle.energy == pytest.approx(part.made.energy, rel=1e-9)


def test_documents_are_named_by_machine_and_part(tmp_path: Path) -> None:
    file, told = shop_file(tmp_path, FIXED), list[str]()
    folder = tmp_path / "out"
    request = FactoryRequest(documents=2, seed=11, has_energy=True)
    result = run_factory(file, request, folder=folder, tell=told.append)
    assert result.documents_written == 2
    found = sorted(each.name for each in (folder / "mtconnect").iterdir())
    assert found == ["MILL_1_0-0.xml", "MILL_1_0-1.xml"]
    assert "no document of step 1 of slot on saw: it has a time and no program" in told
    root = require_valid((folder / "mtconnect" / "MILL_1_0-1.xml").read_bytes(), "2.7")
    assert value(root, "part")[-1] == "0-1"
    assert value(root, "batch")[-1] == "0"
    assert value(root, "program")[-1] == "paper003_case1.stpnc"
    rows = (folder / "MILL 1.csv").read_text().splitlines()
    joules = float(rows[2].split(",")[rows[0].split(",").index("machiningenergy_j")])
    # The document adds up 20 samples a second.
    assert float(value(root, "energy")[-1]) == pytest.approx(joules, rel=5e-3)


def test_drawn_settings_are_those_of_the_part(tmp_path: Path) -> None:
    file = shop_file(tmp_path, DRAWN)
    folder = tmp_path / "out"
    result = run_factory(file, FactoryRequest(documents=2, has_energy=True), folder=folder)
    assert result.documents_written == 2
    rows = (folder / "MILLING_MACHINE_1.csv").read_text().splitlines()
    heads = rows[0].split(",")
    feeds = []
    for row in rows[1:3]:
        cells = dict(zip(heads, row.split(","), strict=True))
        name = f"MILLING_MACHINE_1_{cells['id']}.xml"
        root = etree.fromstring((folder / "mtconnect" / name).read_bytes())
        programmed = {float(each) for each in value(root, "feed_prog") if each[:1].isdigit()}
        feed = 1000.0 * float(cells["FR"])
        assert any(each == pytest.approx(feed, rel=1e-3) for each in programmed)
        energy = float(value(root, "energy")[-1])
        assert energy == pytest.approx(float(cells["machiningenergy_j"]), rel=0.02)
        feeds.append(feed)
    assert feeds[0] != feeds[1]
