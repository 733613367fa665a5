"""A program in passes of another depth has the path that the written file has."""

from pathlib import Path

import pytest

from optimiser.cuts.path_trial import with_depth
from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import Point

PARTS = Path(__file__).parents[2] / "examples" / "parts"


def program(part: str, *change: str) -> Program:
    text = (PARTS / f"{part}.stpnc").read_text()
    if change:
        assert change[0] in text
        text = text.replace(change[0], change[1])
    return Program(Part21File.from_bytes(text.encode(), name=part), name=part)


def step_of(part: Program, name: str) -> ResolvedWorkingstep:
    (found,) = (step for step in part.workingsteps if step.id == name)
    return found


def points(part: Program, step: ResolvedWorkingstep) -> list[Point]:
    return [move.end for move in workingstep_path(part, step).moves]


@pytest.mark.parametrize(
    ("part", "name", "old", "new", "depth"),
    [
        ("paper002", "ROUGH THE FACE", "#43,#43,#44,3.,0.)", "#43,#43,#44,1.5,0.)", 1.5),
        ("shaft", "ROUGH CONTOUR", "TURNING(1.,.T.,(2.),", "TURNING(1.,.T.,(4.),", 4.0),
    ],
)
def test_the_path_is_that_of_the_edited_file(
    part: str, name: str, old: str, new: str, depth: float
) -> None:
    as_is = program(part)
    step = step_of(as_is, name)
    edited = program(part, old, new)
    expected = points(edited, step_of(edited, name))
    assert points(*with_depth(as_is, step, depth)) == expected
    assert points(as_is, step) != expected


def test_a_hole_has_no_depth_to_choose() -> None:
    part = program("bracket")
    with pytest.raises(PathError, match="sets no depth of its passes"):
        with_depth(part, step_of(part, "DRILL HOLE 1"), 5.0)
