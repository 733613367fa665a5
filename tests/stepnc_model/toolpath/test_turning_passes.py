"""Scan lines and passes along a surface."""

from pathlib import Path

import pytest

from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.toolpath.job import Job, job_of
from stepnc_model.toolpath.path import MoveType, ToolPath
from stepnc_model.toolpath.turning import turning_path
from stepnc_model.toolpath.turning_passes import is_joined, oriented, shortened
from stepnc_model.toolpath.turning_piece import Piece

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


CHAIN = [
    Piece(start=(5.0, 1.0), end=(0.0, 1.0)),
    Piece(start=(0.0, 1.0), end=(0.0, 4.0)),
    Piece(start=(0.0, 4.0), end=(-5.0, 4.0)),
]


def test_a_chain_turned_round_is_still_joined() -> None:
    back = oriented(CHAIN, towards=1)
    assert is_joined(back)
    assert back[0].start == (-5.0, 4.0)


def test_a_chain_begins_where_it_is_cut_off() -> None:
    assert shortened(CHAIN, 2.0)[0].start == (2.0, 1.0)
    assert shortened(CHAIN, -1.0)[0].start == (-1.0, 4.0)


@pytest.mark.parametrize("name", ["ROUGH CONTOUR", "FINISH CONTOUR", "ROUGH FACE"])
def test_the_first_contact_is_met_at_the_overcut(name: str) -> None:
    """No cut begins in rapid: a feed through air comes first."""
    moves = path_of(name).moves
    first = next(i for i, move in enumerate(moves) if move.type is MoveType.CONTACT)
    assert moves[first - 1].type is MoveType.NO_CONTACT
