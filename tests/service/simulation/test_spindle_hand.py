"""Tools of NC code that turn against their hand."""

from pathlib import Path

from service.simulation.spindle_hand import turned_against
from simulator.tool_files.read import read_tools
from stepnc_model.nc.program import read_program
from tests.every_case import every_case
from tests.service.along_path.foreign import MILL, advised

CODE = (
    "G21 G90 G17\nT1 M6\nS3000 {turns}\nG0 X-10. Y10. Z2.\nG1 Z-2. F100.\nX60. F300.\n"
    "G0 Z5.\nM30\n"
)


@every_case(
    ("row", "turns", "words"),
    [
        ("endmill,10,3,", "M4", "M4 (lines 5–6), against a right-hand tool"),
        ("endmill,10,3,", "M3", ""),
        ("endmill,10,3,left", "M3", "M3 (lines 5–6), against a left-hand tool"),
        ("drill,8,2,left", "M4", ""),
        ("drill,8,2,", "M4", "against a right-hand tool"),
        ("facemill,50,5,neutral", "M4", ""),
        ("tap,8,4,", "M4", ""),
    ],
)
def test_a_tool_that_turns_against_its_hand_is_told(
    tmp_path: Path, row: str, turns: str, words: str
) -> None:
    table = tmp_path / "tools.csv"
    table.write_text(f"number,kind,diameter_mm,teeth,hand\n1,{row}\n")
    program = read_program(CODE.format(turns=turns).encode())
    found = list(turned_against(program, read_tools(table).by_number))
    assert [(number, each.line) for number, each in found] == ([(1, 5)] if words else [])
    assert all(words in each.message for _, each in found)


def test_its_feeds_do_not_rise() -> None:
    tools = "number,kind,diameter_mm,teeth,centre_cutting\n1,endmill,10,3,true\n"
    m3, m4 = (advised(CODE.format(turns=turns), MILL, tools=tools) for turns in ("M3", "M4"))
    assert m3.time_after < 0.9 * m3.time_before
    assert m4.rewritten.data == CODE.format(turns="M4").encode()
    assert any("turns with M4" in each.message for each in m4.findings)
