"""A knurl is pressed in and fed along once."""

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


END = "ENDSEC;\nEND-"


KNURL = (
    ("#205=THREADING_ROUGH($,$,'THREAD M30 X 2',5.,$,#430,#304,#330,$,$,#355,0.)",
     "#205=KNURLING($,$,'K',5.,$,#430,#304,#330,$,$,$)"),
    ("#43,(#140),#205", "#43,(#601),#205"),
)  # fmt: skip


def knurl(depth: str) -> ToolPath:
    feature = f"#601=STRAIGHT_KNURL('K',#30,(),#41,#140,$,{depth},$,$,$,$,$);\n"
    size = "#602=TOLERANCED_LENGTH_MEASURE(0.5,#510);\n"
    return path_of("THREAD M30 X 2", *KNURL, (END, feature + size + END))


def test_a_knurl_is_pressed_in_and_fed_along() -> None:
    assert [m.end for m in cuts(knurl("#602"))] == [(14.5, 0.0, 0.0), (14.5, 0.0, -25.0)]


def test_a_knurl_without_depth_is_refused() -> None:
    with pytest.raises(SchemaError, match="tooth depth"):
        knurl("$")
