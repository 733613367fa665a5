"""What a program may mean otherwise than it is read is a warning."""

from pathlib import Path

import pytest

from stepnc_model.errors import Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.remarks import doubts
from tests.service.test_keep_going import program

PARTS = Path(__file__).parents[2] / "examples" / "parts"
INCH = (
    "#900=(CONVERSION_BASED_UNIT('INCH',#902)LENGTH_UNIT()NAMED_UNIT(#903));",
    "#901=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#900))"
    "REPRESENTATION_CONTEXT('',''));",
    "#902=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#904);",
    "#903=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);",
    "#904=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));",
)


def told(data: bytes) -> list[str]:
    found = list(doubts(Program(Part21File.from_bytes(data))))
    assert {each.severity for each in found} <= {Severity.WARNING}
    return [f"{each.entity}: {each.message}" for each in found]


def added(*instances: str) -> bytes:
    """The program of two holes with more instances."""
    end = b"ENDSEC;\nEND-ISO"
    return program().replace(end, "\n".join(instances).encode() + b"\n" + end)


def test_a_program_without_doubts_has_none() -> None:
    assert told(program()) == []


@pytest.mark.parametrize("part", sorted(PARTS.glob("*.stpnc")), ids=lambda path: path.stem)
def test_no_sample_is_doubted(part: Path) -> None:
    assert told(part.read_bytes()) == []


def test_a_unit_that_nothing_uses_may_be_meant_for_all() -> None:
    (text,) = told(added(*INCH))
    assert "#901: gives a unit of length of 25.4 mm" in text
    used = "#905=SHAPE_REPRESENTATION('',(),#901);"
    assert told(added(*INCH, used)) == []
    millimetres = [each.replace("(#900)", "(#904)") for each in INCH]
    assert told(added(*millimetres)) == []


def test_a_drill_that_fits_its_hole_in_inches() -> None:
    data = program()
    begin = data.index(b"#54=MILLING_TOOL_DIMENSION(") + len("#54=MILLING_TOOL_DIMENSION(")
    end = data.index(b",", begin)
    found = told(data[:begin] + b"0.3937" + data[end:])
    assert len(found) == 3
    assert found[0].startswith("#50 MILLING_CUTTING_TOOL: diameter 0.3937 mm: in inches it")
    assert told(data[:begin] + b"0.4" + data[end:]) == []


def test_two_workingsteps_with_one_id() -> None:
    (text,) = told(program().replace(b"WORKINGSTEP('AFTER'", b"WORKINGSTEP('GOOD'"))
    assert text.startswith("#5 MACHINING_WORKINGSTEP: 'GOOD' is also the id of #3")


def test_one_workingstep_that_is_run_twice_is_none_of_them() -> None:
    assert told(program().replace(b"(#3,#4,#5),$,#7", b"(#3,#4,#3),$,#7")) == []
