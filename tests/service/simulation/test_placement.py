"""Stock beside the cutting moves: units and zero."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.simulation.code_setup import CodeSetup, GivenSetup, code_setup
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.program import read_program

GIVEN = GivenSetup(file=Path("part.nc"), material="c45", machine="vmc15")
MOVES = "T1 M6\nS5000 M3\nG0 X0 Y0 Z5\nG1 Z-.2 F10\nX3\nY2\nG0 Z5\n"
INCH = "(T1 D=.25 - FLAT END MILL)\nG20 G90 G54\n" + MOVES
MM = "(T1 D=6 - FLAT END MILL)\nG21 G90 G54\n" + MOVES


def setup(code: str, stock: str) -> CodeSetup:
    """Setup of a program with a given stock."""
    return code_setup(read_program(code.encode()), replace(GIVEN, stock=stock))


def units(found: CodeSetup) -> list[Finding]:
    """Findings on units."""
    return [each for each in found.findings if "inch" in each.message]


def test_a_stock_that_no_tool_meets_is_refused_with_both_boxes() -> None:
    with pytest.raises(StepNcError, match="no tool meets the stock: it reaches from 100, 100"):
        setup(MM, "100,100,-5,150,150,0")


def test_a_box_in_inches_is_told() -> None:
    (told,) = units(setup(INCH, "-.1,-.1,-.5,3.2,2.2,0"))
    assert told.severity is Severity.WARNING
    assert "--stock takes in mm" in told.message
    assert not units(setup(INCH, "-3,-3,-10,80,55,0"))


def test_an_inch_program_with_a_box_that_was_inches_already_is_told() -> None:
    (told,) = units(setup(INCH, "-80,-80,-300,2000,1400,0"))
    assert "25.4 times too large" in told.message


def test_a_large_part_with_a_small_pocket_is_no_fault_in_mm() -> None:
    assert not units(setup(MM, "-30,-30,-10,60,40,0"))
