"""Example 3 of ISO 14649-11: counterboring from behind, along a tool path of its own."""

from pathlib import Path

import pytest

from stepnc_model.program import Program
from stepnc_model.toolpath.frame import compound_of
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.job import job_of

EXAMPLE = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649" / "EXAMPLE3.stp"

pytestmark = pytest.mark.skipif(
    not EXAMPLE.is_file(), reason="the public STEP-NC files are not beside the project"
)


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
