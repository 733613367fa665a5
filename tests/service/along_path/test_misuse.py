"""Moves of NC code for which its tools are not made."""

from dataclasses import replace

from service.verbs.optimise.code_result import CodeAdvice
from stepnc_model.errors import Severity
from tests.every_case import every_case
from tests.service.along_path.foreign import MILL, advised

BLOCK = replace(MILL, stock="-20,-20,-20,70,40,0")
TOOLS = """number,kind,diameter_mm,teeth,centre_cutting
1,endmill,10,3,{centre}
2,drill,8,2,
3,drill,8.1,2,
4,reamer,8.2,6,
6,facemill,50,5,
"""
HEAD = "%\nO0001\nG21 G90 G17\n"
REAM = "T4 M6\nS500 M3\nG0 X30. Y10. Z5.\nG85 X30. Y10. Z-15. R2. F100.\nG80\nG0 Z50.\n"


def advice(text: str, *, centre: str = "", allow_plunge: bool = False) -> CodeAdvice:
    request = replace(BLOCK, allow_plunge=allow_plunge)
    return advised(HEAD + text + "M30\n%\n", request, tools=TOOLS.format(centre=centre))


def said(found: CodeAdvice, words: str) -> list[tuple[Severity, int]]:
    """Severity and line of what is said of a misuse."""
    return [(each.severity, each.line) for each in found.findings if words in each.message]


def test_a_drill_that_moves_sideways_keeps_its_feed_there() -> None:
    side = "T2 M6\nS1500 M3\nG0 X-30. Y5. Z-1.\nG1 X60. F60.\nG0 Z50.\n"
    found = advice(side + "G81 X30. Y20. Z-10. R2. F60.\nG80\n")
    assert said(found, "moves sideways in material") == [(Severity.WARNING, 7)]
    assert b"G1 X60. F60." in found.rewritten.data
    assert b"G81 X30. Y20. Z-10. R2. F60." not in found.rewritten.data


@every_case(
    ("before", "found_at"),
    [("T3 M6\nS1500 M3\nG0 X30. Y10. Z5.\nG81 X30. Y10. Z-18. R2. F200.\nG80\nG0 Z50.\n", 0),
     ("", 7)],
)  # fmt: skip
def test_a_reamer_without_a_hole_keeps_its_feed(before: str, found_at: int) -> None:
    found = advice(before + REAM)
    expected = [(Severity.ERROR, found_at)] if found_at else []
    assert said(found, "more than its allowance of 0.3 mm") == expected
    is_kept = b"G85 X30. Y10. Z-15. R2. F100." in found.rewritten.data
    assert is_kept is bool(found_at)
    assert bool(found.faults) is bool(found_at)


@every_case(
    ("tool", "centre", "allows", "severity"),
    [
        (6, "", False, Severity.ERROR),
        (6, "", True, Severity.WARNING),
        (1, "false", False, Severity.ERROR),
        (1, "", False, Severity.WARNING),
        (1, "true", False, None),
    ],
)
def test_a_mill_that_does_not_cut_over_centre_must_not_plunge(
    tool: int, centre: str, severity: Severity | None, *, allows: bool
) -> None:
    plunge = f"T{tool} M6\nS800 M3\nG0 X20. Y10. Z5.\nG1 Z-2. F50.\nX30. F100.\nG0 Z50.\n"
    found = advice(plunge, centre=centre, allow_plunge=allows)
    assert said(found, "solid material") == ([] if severity is None else [(severity, 7)])
    assert bool(found.faults) is (severity is Severity.ERROR)


def test_a_tap_that_moves_sideways_is_told() -> None:
    tools = TOOLS.format(centre="") + "5,tap,8,4,\n"
    side = "T5 M6\nS300 M3\nG0 X-30. Y5. Z-1.\nG1 X60. F60.\nG0 Z50.\n"
    found = advised(HEAD + side + "M30\n%\n", BLOCK, tools=tools)
    assert said(found, "a tap cuts along its axis alone") == [(Severity.WARNING, 7)]
