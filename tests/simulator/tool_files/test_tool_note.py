"""What single comments say about tools, each in the manner of a postprocessor."""

import pytest

from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.tool_note import ToolNote, defined_note, note_of

INCH = 25.4
END, DRILL, FACE = ToolKind.ENDMILL, ToolKind.DRILL, ToolKind.FACEMILL


def note(text: str, unit: float = 1.0) -> ToolNote:
    """What a comment says."""
    return note_of(text, line=1, unit=unit)


@pytest.mark.parametrize(
    ("text", "unit", "number", "diameter", "kind"),
    [
        # Fusion, HSMWorks
        ("T1 D=10. CR=0. - ZMIN=-5. - FLAT END MILL", 1.0, 1, 10.0, END),
        ("T2 D=5. CR=0. TAPER=118DEG - ZMIN=-12. - DRILL", 1.0, 2, 5.0, DRILL),
        ("T9 D=0.5 CR=0. - ZMIN=-0.2 - FACE MILL", INCH, 9, 12.7, FACE),
        ("#12 D=10 CR=0 - ZMIN=-5 - flat end mill", 1.0, 12, 10.0, END),
        # Mastercam
        ("T1 | 1/2 FLAT ENDMILL | H1 | DIA 0.5", INCH, 1, 12.7, END),
        ("T1|10. FLAT ENDMILL|H1|D1|TOOL DIA. - 10.", 1.0, 1, 10.0, END),
        ("TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - .5", INCH, 1, 12.7, None),
        ("T9 | 1-1/4 FACE MILL | H9", INCH, 9, 31.75, FACE),
        # CamBam
        ("T5 : 3.175", 1.0, 5, 3.175, None),
        # FreeCAD
        ("TC: 6mm endmill", 1.0, None, 6.0, END),
        ("Begin toolchange: TC: 1/4in Endmill", 1.0, None, 6.35, END),
        # Vectric
        ("Tool: End Mill (1/4 inch)", INCH, None, 6.35, END),
        ("{[T1] End Mill 6 mm}", 1.0, 1, 6.0, END),
        ("1 = End Mill {1/4 inch}", INCH, 1, 6.35, END),
        # Estlcam
        ("Tool: 3mm endmill", 1.0, None, 3.0, END),
        ("No. 1: 6mm end mill", 1.0, 1, 6.0, END),
        # SolidCAM
        ("T1 - END MILL - D10.", 1.0, 1, 10.0, END),
        ("TOOL -1- MILL DIA 10. R0. MM", 1.0, 1, 10.0, END),
        # Heidenhain and Sinumerik
        ("T12 D=+10 CR=+0", 1.0, 12, 10.0, None),
        ("* - T3 D=16 face mill", 1.0, 3, 16.0, FACE),
        # People
        ("FACE MILL D63", 1.0, None, 63.0, FACE),
        ("T3 - 6.8 DRILL", 1.0, 3, 6.8, DRILL),
        ("T1  6MM EM 3FL", 1.0, 1, 6.0, None),
        ("10MM 3 FLUTE", 1.0, None, 10.0, None),
        ("TOOL 3 - 8MM SPOT DRILL 90 DEG", 1.0, 3, 8.0, ToolKind.CENTER_DRILL),
        ("T6 NO. 3 CENTER DRILL D3.15", 1.0, 6, 3.15, ToolKind.CENTER_DRILL),
    ],
)
def test_number_diameter_and_kind(
    text: str, unit: float, number: int | None, diameter: float, kind: ToolKind | None
) -> None:
    found = note(text, unit)
    assert found.is_of_tool
    assert (found.number, found.kind) == (number, kind)
    assert found.diameter == pytest.approx(diameter)


@pytest.mark.parametrize(
    "text",
    [
        "2D POCKET1",
        "USING HIGH FEED G1 F500. INSTEAD OF G0.",
        "STOCK LEFT 0.5 MM",
        "MILL POCKET 20 MM DEEP",
        "T4 M8X1.25 TAP",
        "MATERIAL - ALUMINUM INCH - 2024",
        "NO. 4 CENTER DRILL",
        "X5.5 Y3 MM",
        "1/0 MILL",
        "",
    ],
)
def test_other_comments_describe_no_tool(text: str) -> None:
    assert not note(text).is_of_tool


def test_corners_points_teeth_and_edges() -> None:
    bull = note("T4 D=12. CR=1. - BULL NOSE END MILL")
    assert (bull.corner_radius, bull.is_bull) == (1.0, True)
    assert note("T3 D=8. CR=4. - BALL END MILL").corner_radius == 4.0
    assert note("T2 | 3/8 BALL ENDMILL", INCH).corner_radius == pytest.approx(4.7625)
    assert note("T2 D=5. TAPER=118DEG - DRILL").angle_deg == 118.0
    assert note("T1 6MM END MILL Z=4 HSS").teeth == 4
    assert note("T1 6MM END MILL Z=4 HSS").edge is CuttingMaterial.HSS
    assert note("T1 D=6. - ZMIN=-5. Z3 LEVEL END MILL").teeth is None


@pytest.mark.parametrize("text", ["T2 1/2 V-BIT 90", "T5 D=20 T-SLOT CUTTER", "T1 D=3 PROBE"])
def test_shapes_that_no_comment_tells(text: str) -> None:
    assert note(text).is_shaped


def test_klartext_defines_a_radius() -> None:
    found = defined_note("5 TOOL DEF 12 L+0 R+5 ; mill", line=5, unit=1.0)
    assert found is not None
    assert (found.number, found.diameter) == (12, 10.0)
    assert defined_note("5 TOOL CALL 12 Z", line=5, unit=1.0) is None


def test_a_stated_mill_has_its_four_numbers() -> None:
    flat = note_of("TOOL/MILL,3.18, 0.00, 0.000, 0.0", line=1, unit=1.0)
    assert (flat.diameter, flat.corner_radius, flat.is_shaped) == (3.18, 0.0, False)
    assert flat.is_of_tool
    ball = note_of("TOOL/MILL, .25, .125, 1., 0", line=1, unit=25.4)
    assert (ball.diameter, ball.corner_radius) == (6.35, 3.175)
    assert note_of("TOOL/MILL,0.1,0.05,0.0,30.0", line=1, unit=1.0).is_shaped
