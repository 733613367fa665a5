"""NC code whose mills cut deeper than their catalogue allows is told, and is not checked."""

import pytest

from service.verbs.optimise.code_result import CodeAdvice
from stepnc_model.errors import Severity
from tests.service.along_path.foreign import END, HEAD, LATHE, TOOLS, advised

SLOT = HEAD.replace("T1 M6", "T2 M6") + "G0 X-10. Y40.\nZ-{depth}.\nG1 X110. F300.\nG0 Z50.\n"
"""Slot as wide as the mill of 8 mm: one diameter deep at most."""

SIDE = SLOT.replace("Y40.", "Y-2.")
"""2 mm wide with the same mill: 2 diameters deep at most."""


def said(found: CodeAdvice) -> list[str]:
    return [
        each.message
        for each in found.findings
        if "axial depth" in each.message and each.severity is Severity.WARNING
    ]


def test_a_slot_that_is_too_deep_is_told_by_tool_and_line() -> None:
    found = advised(SLOT.format(depth=12) + END)
    (text,) = said(found)
    assert text.startswith(
        "T2: as programmed axial depth 12 mm exceeds its bound of 8 mm by 50 %, for a width of "
        "1 of the diameter, on "
    )
    assert "program more passes" in text
    (finding,) = (each for each in found.findings if each.message == text)
    assert finding.line == 8
    record = found.record()
    assert record["is_checked"] is False
    (risk,) = record["depth_risks"]
    assert (risk["id"], risk["line"]) == ("T2", 8)
    assert risk["depth_mm"] == pytest.approx(12.0)
    assert risk["bound_mm"] == pytest.approx(8.0)
    assert risk["width_mm"] == pytest.approx(8.0)
    assert risk["length_mm"] == pytest.approx(100.0, abs=9.0)
    assert "too deep in T2" in str(found)
    assert "too deep in T2" in found.page()


@pytest.mark.parametrize("text", [SLOT.format(depth=8), SIDE.format(depth=16)])
def test_a_depth_of_the_catalogue_is_checked(text: str) -> None:
    found = advised(text + END)
    assert said(found) == []
    assert found.record()["is_checked"] is True
    assert "too deep" not in str(found) + found.page()


def test_a_narrow_cut_has_the_depth_of_its_width() -> None:
    (text,) = said(advised(SIDE.format(depth=17) + END))
    assert "axial depth 17 mm exceeds its bound of 16 mm by 6.25 %" in text


def test_the_length_of_the_edges_bounds_the_depth_too() -> None:
    header, *rows = TOOLS.splitlines()
    tools = "\n".join([f"{header},edge_length_mm", *(f"{row},6" for row in rows)]) + "\n"
    (text,) = said(advised(SLOT.format(depth=8) + END, tools=tools))
    assert "axial depth 8 mm exceeds its bound of 6 mm by 33.3 %" in text


def test_turning_has_its_own_rule() -> None:
    text = (
        "%\nO0001\nG21 G40 G99\nG50 S2500\nT0101\nG97 S800 M3\nG0 X55. Z2.\nG0 X30.\n"
        "G1 Z-40. F0.2\nG0 X60.\nG0 X100. Z50.\nM30\n%\n"
    )
    assert said(advised(text, LATHE)) == []
