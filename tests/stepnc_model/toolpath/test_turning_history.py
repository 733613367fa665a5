"""The bar as earlier workingsteps left it."""

from pathlib import Path

import pytest

from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.toolpath.job import Job, job_of
from stepnc_model.toolpath.turning_history import bar_of
from stepnc_model.toolpath.turning_outline import outline_of
from stepnc_model.toolpath.turning_stock import Bar

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


def bar(name: str, *edits: tuple[str, str]) -> Bar:
    at = job(name, *edits)
    return bar_of(at, tuple(outline_of(at, ref, 30.0) for ref in at.step.features))


def test_the_first_workingstep_finds_the_whole_bar() -> None:
    first = bar("ROUGH FACE")
    assert (first.radius, first.left.low, first.left.high) == (30.0, -150.0, 2.0)


def test_a_roughed_face_leaves_its_allowance() -> None:
    assert bar("FINISH FACE").left.high == pytest.approx(0.5)
    assert bar("ROUGH CONTOUR").left.high == pytest.approx(0.0)


def test_a_roughed_contour_leaves_its_allowance() -> None:
    left = bar("FINISH CONTOUR").left
    assert left.at(-20.0) == pytest.approx(15.5)
    assert left.at(-100.0) == pytest.approx(27.5)
    assert left.at(-120.0) == 30.0


def test_the_thread_finds_its_relief() -> None:
    assert bar("THREAD M30 X 2").left.at(-27.0) == pytest.approx(12.5)


def test_the_part_is_what_no_feature_removes() -> None:
    part = bar("ROUGH FACE").part
    assert part.high == 0.0
    assert [part.at(z) for z in (-27.0, -50.0, -120.0)] == pytest.approx([12.5, 20.0, 30.0])


def test_without_a_bar_the_features_say_how_large_it_is() -> None:
    found = bar("ROUGH CONTOUR", ("0.02,$,$,#33,(#36)", "0.02,$,$,$,(#36)"))
    assert found.radius == 27.0
    assert "a diameter of 54 mm" in str(found.findings[0])
