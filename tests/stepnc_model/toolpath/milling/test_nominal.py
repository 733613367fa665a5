"""Nominal walls of the bracket, whose sizes are those of its drawing."""

from math import pi
from pathlib import Path

import pytest

from service.programs.reading import read_program
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.milling.nominal import nominal_walls

PARTS = Path(__file__).parents[4] / "examples" / "parts"
BRACKET = read_program(PARTS / "bracket.stpnc", units="iso")


def step_of(program: Program, name: str) -> ResolvedWorkingstep:
    return next(step for step in program.workingsteps if step.id == name)


def test_a_reamed_hole_is_a_circle() -> None:
    (wall,) = nominal_walls(BRACKET, step_of(BRACKET, "REAM HOLE 1"))
    assert sum(edge.length for edge in wall.chain) == pytest.approx(10.0 * pi)
    assert wall.inset(1.0) == 0.0


def test_a_pocket_has_its_outline_and_its_island() -> None:
    walls = nominal_walls(BRACKET, step_of(BRACKET, "FINISH POCKET"))
    assert {wall.bottom for wall in walls} == {-12.0}
    assert len(walls) == 2


def test_a_face_has_only_a_floor() -> None:
    (wall,) = nominal_walls(BRACKET, step_of(BRACKET, "FINISH FACE"))
    assert wall.chain == ()
    assert wall.bottom == 0.0


def test_what_is_turned_has_no_walls() -> None:
    shaft = read_program(PARTS / "shaft.stpnc", units="iso")
    assert nominal_walls(shaft, step_of(shaft, "FINISH CONTOUR")) == ()
