"""What features remove together, and allowances."""

from pathlib import Path

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.toolpath.job import Job, job_of
from stepnc_model.toolpath.turning_outline import outline_of
from stepnc_model.toolpath.turning_plane import HalfPlane
from stepnc_model.toolpath.turning_stock import allowance_of, operation_of, surface_of

SHAFT = Path(__file__).parents[3] / "examples" / "parts" / "shaft.stpnc"


def job(name: str, *edits: tuple[str, str]) -> Job:
    """A workingstep of the shaft with some texts replaced."""
    text = SHAFT.read_text()
    for before, after in edits:
        assert before in text
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="shaft"), name="shaft")
    (step,) = (step for step in program.workingsteps if step.id == name)
    return job_of(program, step)


def test_features_chain_into_one_surface() -> None:
    at = job("ROUGH CONTOUR")
    surface = surface_of(
        tuple(outline_of(at, ref, 30.0) for ref in at.step.features), HalfPlane()
    )
    assert (surface.low, surface.high) == (-110.0, 0.0)
    assert [surface.at(z) for z in (-50.0, -90.0)] == [20.0, 27.0]


def test_an_allowance_is_not_negative() -> None:
    at = job("ROUGH CONTOUR", ("#352,0.5)", "#352,-1.)"))
    with pytest.raises(SchemaError, match="an allowance of -1 mm"):
        allowance_of(at, at.step.operation_ref, at.step.operation)


def test_the_operation_of_a_lathe_is_needed() -> None:
    assert operation_of(job("ROUGH CONTOUR")).its_id == "ROUGH CONTOUR"
