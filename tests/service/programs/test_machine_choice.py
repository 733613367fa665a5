from pathlib import Path

import pytest

from service.programs.machine_choice import (
    load_material_named,
    machine_for,
    material_for,
)
from service.programs.reading import read_program
from simulator.errors import UnknownMachine, UnknownMaterial
from simulator.spec import MachineKind
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from tests.service.test_keep_going import program as two_holes

PARTS = Path(__file__).parents[3] / "examples" / "parts"


@pytest.mark.parametrize(("part", "kind"), [("bracket", "mill"), ("shaft", "lathe")])
def test_without_a_name_the_machine_suits_the_program(part: str, kind: str) -> None:
    program = read_program(PARTS / f"{part}.stpnc", units="iso")
    assert machine_for("", program).kind is MachineKind(kind)
    assert machine_for("paper000", program).name == "paper000"


def test_without_a_name_the_material_is_that_of_the_file() -> None:
    program = read_program(PARTS / "bracket.stpnc", units="iso")
    assert material_for("", program).material.name == "c45"
    assert material_for("AISI 1045", program).material.name == "c45"


def test_unknown_names_are_refused() -> None:
    program = read_program(PARTS / "bracket.stpnc", units="iso")
    with pytest.raises(UnknownMachine):
        machine_for("none", program)
    with pytest.raises(UnknownMaterial):
        load_material_named("none")


def test_a_program_without_a_usable_workingstep_suits_no_machine() -> None:
    lacking = two_holes(_41="#41=DRILLING($,$,'OP',10.,$,$,#61,#63,$,$,$,$,$,$);")
    lacking = lacking.replace(b"(#3,#4,#5),$,#7", b"(#4),$,#7")
    with pytest.raises(SchemaError, match="the operation has no tool"):
        machine_for("", Program(Part21File.from_bytes(lacking)))
