"""Tools of NC code that are used beyond their limits: their feeds do not rise."""

from dataclasses import replace

from tests.every_case import every_case
from tests.service.along_path.foreign import MILL, advised

BLOCK = replace(MILL, stock="-20,-20,-20,70,40,0")
SLOT = (
    "%\nO0001\nG21 G90 G17\nT1 M6\nS{speed} M3\nG0 G54 X-10. Y5.\nG43 H1 Z5.\n"
    "G1 Z-1. F200.\nX60. F200.\nG0 Z50.\nM30\n%\n"
)
HEAD = "number,kind,diameter_mm,teeth,centre_cutting,cutting_material"
CARBIDE = f"{HEAD}\n1,endmill,10,3,true,carbide\n"
VENDOR = (
    f"{HEAD},min_cutting_speed_m_min,max_cutting_speed_m_min\n"
    "1,endmill,10,3,true,carbide,20,{most}\n"
)


@every_case(
    ("tools", "speed", "source"),
    [
        (CARBIDE.replace("carbide", "hss"), 3000, "of 40 m/min (hss in AISI 1045)"),
        (VENDOR.format(most=150), 5000, "of 150 m/min (its row of the tool table)"),
        (VENDOR.format(most=160), 5000, ""),
        (CARBIDE, 5000, ""),
    ],
)
def test_a_tool_above_its_cutting_speed_raises_no_feed(
    tools: str, speed: int, source: str
) -> None:
    found = advised(SLOT.format(speed=speed), BLOCK, tools=tools)
    said = [each for each in found.findings if "cutting speed" in each.message]
    is_raised = found.time_after < 0.9 * found.time_before
    assert (not said, is_raised) == (not source, not source)
    for each in said:
        assert each.line == 8
        assert source in each.message


def test_a_tool_that_cannot_cut_the_material_keeps_its_feeds() -> None:
    code = SLOT.format(speed=5000)
    hard = replace(BLOCK, material="hardened_55hrc")
    found = advised(code, hard, tools=CARBIDE.replace("carbide", "hss"))
    (said,) = (each for each in found.findings if "does not cut" in each.message)
    assert said.message.startswith("tool 'endmill T1' keeps its feeds: high-speed steel")
    assert found.rewritten.data == code.encode()
    assert not found.is_advised
