"""Feed, speed and depth edited in an operation of its own."""

from pathlib import Path

import pytest

from stepnc_model.draft import Draft
from stepnc_model.edit_conditions import edit_depth, edit_number, rounded
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.technology import programmed

PARTS = Path(__file__).parents[2] / "examples" / "parts"


@pytest.mark.parametrize("number", [1 / 3, 1e-300, 123456789.123456789, -0.1])
def test_a_rounded_number_has_twelve_digits(number: float) -> None:
    assert rounded(number) == pytest.approx(number, rel=1e-11)
    assert rounded(rounded(number)) == rounded(number)


def test_a_number_that_is_the_same_is_not_written() -> None:
    program = Program.load(PARTS / "paper003_case1.stpnc")
    step, draft = program.workingsteps[0], Draft(program)
    feed = programmed(program, step.technology_ref).feed
    edit_number(draft, step, feed, feed.in_file(feed.value * (1.0 + 1e-14)))
    assert draft.edits.apply() == program.file.data


def test_a_shared_technology_is_copied_before_it_is_edited() -> None:
    program = Program.load(PARTS / "bracket.stpnc")
    steps = program.workingsteps
    one, other = next(
        (one, other)
        for one in steps
        for other in steps
        if one.technology_ref == other.technology_ref
        and one.operation_ref != other.operation_ref
    )
    draft = Draft(program)
    feed = programmed(program, one.technology_ref).feed
    edit_number(draft, one, feed, feed.in_file(2.0 * feed.value))
    file = Part21File.from_bytes(draft.edits.apply(), name=program.name)
    after = Program(file, name=program.name)
    fed = [
        programmed(after, after.workingsteps[step.index].technology_ref).feed.value
        for step in (one, other)
    ]
    assert fed == pytest.approx([2.0 * feed.value, feed.value])


@pytest.mark.parametrize("name", ["paper003_case1", "shaft"])
def test_a_depth_is_that_of_the_operation_or_the_strategy(name: str) -> None:
    program = Program.load(PARTS / f"{name}.stpnc")
    draft = Draft(program)
    assert edit_depth(draft, program.workingsteps[0], 0.75)
    assert b"0.75" in draft.edits.apply()


def test_a_drill_has_none() -> None:
    program = Program.load(PARTS / "bracket.stpnc")
    drill = next(step for step in program.workingsteps if "drill" in step.operation_type)
    draft = Draft(program)
    assert not edit_depth(draft, drill, 0.75)
    assert draft.edits.apply() == program.file.data
