"""Holes whose tools leave the axis, from the sample bracket to the control and back."""

from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

import pytest

from stepnc_model.nc.exact_reading import read
from stepnc_model.part21.reader import Part21File
from stepnc_model.post.blocks import Block
from stepnc_model.post.canonical import Canonical, commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import generate
from tests.stepnc_model.post.trace import difference

BRACKET = Path(__file__).parents[3] / "examples" / "parts" / "bracket.stpnc"
REAMING = "#214=REAMING($,$,'REAM HOLE 1',5.,$,#460,#312,#330,3.,$,9.8,$,1.,#360,.F.,$,$)"
REAMER = (
    "#460=MILLING_CUTTING_TOOL('REAMER 10MM JS7',#461,(#463),110.,$,$);\n"
    "#461=TAPERED_REAMER(#462,6,.RIGHT.,.F.,$,$);\n"
    "#462=MILLING_TOOL_DIMENSION(10.,$,$,45.,$,$,$)"
)
BORER = (
    "#460=MILLING_CUTTING_TOOL('BACK 14MM',#461,(#463),110.,#503,$);\n"
    "#461=BACKSIDE_COUNTERBORE(#462,1,.RIGHT.,.F.,$);\n"
    "#462=MILLING_TOOL_DIMENSION(14.,$,$,6.,$,$,$)"
)
THREADER = (
    "#460=MILLING_CUTTING_TOOL('THREAD M12',#461,(#463),110.,$,$);\n"
    "#461=MILLING_THREADING_TOOL(#462,2,.RIGHT.,.F.,$);\n"
    "#462=MILLING_TOOL_DIMENSION(9.8,20.,$,45.,$,$,$)"
)
THREAD = (
    "#620=CATALOGUE_THREAD('M12',#30,(),#161,#163,#621,(#160),.T.,$,#622,#622,12.,#623,#622,"
    "#624);\n"
    "#621=PARTIAL_AREA_DEFINITION(30.,#161,$);\n"
    "#622=DESCRIPTIVE_PARAMETER('HAND','RIGHT');\n"
    "#623=NUMERIC_PARAMETER('PITCH',1.75,'MM');\n"
    "#624=SPECIFICATION((),'ISO 261',$,$);\n"
)
PARTS = {
    "back boring": (
        (REAMING, "#214=BACK_BORING($,$,'BACK',5.,$,#460,#311,#330,2.,10.,10.,0.5,$,$)"),
        (REAMER, BORER),
        ("#166=TOLERANCED_LENGTH_MEASURE(10.,", "#166=TOLERANCED_LENGTH_MEASURE(14.,"),
    ),
    "thread drilling": (
        (REAMING, "#214=THREAD_DRILLING($,$,'M12',5.,$,#460,#311,#330,3.,$,$,0.5,2.,$,.F.)"),
        (REAMER, THREADER),
        ("#170=", THREAD + "#170="),
    ),
    "thread drilling forward": (
        (REAMING, "#214=THREAD_DRILLING($,$,'M12',5.,$,#460,#311,#330,3.,$,$,0.5,2.,$,.T.)"),
        (REAMER, THREADER),
        ("#170=", THREAD + "#170="),
    ),
}

Interpreter = Callable[[Iterable[str]], tuple[Canonical, ...]]


@cache
def posted(name: str) -> tuple[Block, ...]:
    text = BRACKET.read_text(encoding="utf-8")
    for before, after in (*PARTS[name], ("(#20,#21,#22,#23,#24,#25)", "(#24)")):
        assert before in text
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name=name))
    (hole,) = (path for path in generate(program) if getattr(path, "id", "") == "REAM HOLE 1")
    return tuple(blocks_of(program, [hole], name=name))


@pytest.mark.parametrize("name", PARTS)
def test_linuxcnc_runs_it_as_meant(name: str, interpreter: Interpreter) -> None:
    blocks = posted(name)
    assert difference(commands(blocks), interpreter(write(blocks, Dialect.LINUXCNC))) == ""


@pytest.mark.parametrize("control", Dialect)
@pytest.mark.parametrize("name", PARTS)
def test_every_control_is_told_the_same(name: str, control: Dialect) -> None:
    blocks = posted(name)
    lines = [line for text in write(blocks, control) for line in text.split("\n")]
    back = read(lines, control)
    assert difference(commands(blocks), back, length=2.5e-3, speed=0.5) == ""
