"""Threads against ISO 68-1 and the drawing of the shaft."""

from pathlib import Path

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.toolpath.job import Job, job_of
from stepnc_model.toolpath.path import Move, MoveType, ToolPath
from stepnc_model.toolpath.turning import turning_path

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


def path_of(name: str, *edits: tuple[str, str]) -> ToolPath:
    return turning_path(job(name, *edits))


def cuts(path: ToolPath) -> list[Move]:
    return [move for move in path.moves if move.type is MoveType.CONTACT]


LIST = "(0.434,0.18,0.138,0.116,0.102,0.093,0.085,0.079)"
NAME = "THREAD M30 X 2"


def bottoms(path: ToolPath) -> list[float]:
    return [m.end[0] for m in cuts(path)]


def test_depths_are_those_of_the_list() -> None:
    found = bottoms(path_of(NAME))
    assert found[:2] == pytest.approx([15.0 - 0.434, 15.0 - 0.614])
    assert found[-1] == pytest.approx(15.0 - 1.227)
    assert len(found) == 8


def test_without_depths_the_thread_is_as_deep_as_its_standard_says() -> None:
    """0.61343 · 2 mm; equal chip areas: the first pass takes 1/√8 of it."""
    found = bottoms(path_of(NAME, (LIST, "()")))
    assert found[-1] == pytest.approx(15.0 - 0.61343 * 2.0, abs=1e-4)
    assert 15.0 - found[0] == pytest.approx(0.61343 * 2.0 / 8.0**0.5, abs=1e-4)


def test_even_depths_are_even() -> None:
    edits = ((LIST, "(0.4)"), ("CONSTANT_REMOVAL_AMOUNT", "CONSTANT_DEPTH"))
    depths = [15.0 - x for x in bottoms(path_of(NAME, *edits))]
    steps = [b - a for a, b in zip([0.0, *depths], depths, strict=False)]
    assert steps == pytest.approx([depths[-1] / 4.0] * 4)


def test_passes_are_bound_to_the_spindle() -> None:
    for move in cuts(path_of(NAME)):
        assert move.feed is not None
        assert move.feed.is_synchronised
        assert move.feed.per_revolution == 2.0


def test_run_in_is_two_pitches_and_run_out_ends_in_the_relief() -> None:
    path = path_of(NAME)
    starts = [a[2] for a, m in path.segments() if m.type is MoveType.CONTACT]
    assert starts[-1] == pytest.approx(4.0)
    assert {m.end[2] for m in cuts(path)} == {-27.0}


def test_the_right_flank_stays_where_it_is() -> None:
    """Fed in along a flank of 30 degrees: z of the tip less depth times tan 30."""
    path = path_of(NAME)
    starts = [a for a, m in path.segments() if m.type is MoveType.CONTACT]
    flanks = [z + (15.0 - x) * 3.0**-0.5 for x, _, z in starts]
    assert flanks == pytest.approx([flanks[0]] * 8, abs=1e-3)


def test_a_left_hand_thread_is_cut_away_from_the_chuck() -> None:
    edit = ("#431,.RIGHT.,2.,\n     .RIGHT.", "#431,.RIGHT.,2.,\n     .LEFT.")
    path = path_of(NAME, edit)
    assert all(m.end[2] > a[2] for a, m in path.segments() if m.type is MoveType.CONTACT)


def test_without_relief_it_is_said() -> None:
    path = path_of(NAME, ("(#14,#15)", "(#15)"))
    assert "no relief" in str(path.findings)


def test_an_inside_thread_is_refused() -> None:
    with pytest.raises(SchemaError, match="inside thread"):
        path_of(NAME, (".EXTERNAL.", ".INTERNAL."))
