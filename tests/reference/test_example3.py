"""Example 3 of ISO 14649-11: counterboring from behind, along a tool path of its own."""

from pathlib import Path

import pytest

from stepnc_model.post.blocks import Linear, Rapid, SpindleDirection, SpindleOff, SpindleOn
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.frame import compound_of
from stepnc_model.toolpath.generate import generate, workingstep_path
from stepnc_model.toolpath.task import job_of

EXAMPLE = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649" / "EXAMPLE3.stp"

pytestmark = pytest.mark.skipif(
    not EXAMPLE.is_file(), reason="the public STEP-NC files are not beside the project"
)


def test_the_tool_folds_in_and_out_by_the_sense_of_its_spindle() -> None:
    """#39 turns it one way on the way through the hole, #37 the other way for the cut."""
    program = Program.load(EXAMPLE)
    blocks = list(blocks_of(program, list(generate(program)), name="EXAMPLE3"))
    events = [
        block for block in blocks if isinstance(block, (SpindleOn, Rapid, Linear, SpindleOff))
    ]
    turning = None
    through: list[SpindleDirection] = []
    cutting: list[SpindleDirection] = []
    for block in events:
        if isinstance(block, SpindleOn):
            turning = block.sense
        elif isinstance(block, Linear) and turning is not None:
            cutting.append(turning)
        elif isinstance(block, Rapid) and turning is not None and block.end[2] < -100.0:
            through.append(turning)
    assert cutting == [SpindleDirection.COUNTERCLOCKWISE]
    assert through[0] is SpindleDirection.CLOCKWISE


def test_the_tool_comes_over_the_security_plane() -> None:
    program = Program.load(EXAMPLE)
    (step,) = program.workingsteps
    blocks = blocks_of(program, list(generate(program)), name="EXAMPLE3")
    first = next(block for block in blocks if isinstance(block, Rapid))
    assert first.end[2] == job_of(program, step).security_z


def test_the_path_lies_in_the_compound_feature_and_begins_on_the_security_plane() -> None:
    """The plane is z = 50 mm there; in the element's own frame it would begin elsewhere."""
    program = Program.load(EXAMPLE)
    (step,) = program.workingsteps
    compound = compound_of(program, step.features[0])
    assert compound is not None
    job = job_of(program, step)
    path = workingstep_path(program, step)
    x, y, z = job.frame(compound).origin
    assert path.start == pytest.approx((x, y, z + 50.0))
