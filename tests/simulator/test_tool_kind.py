"""Kinds of tools by their names in EXPRESS."""

import pytest

from simulator.spec import ToolKind
from simulator.tool_kind import tool_kind
from stepnc_model.programs.tool import Tool


@pytest.mark.parametrize(
    ("keyword", "diameter", "kind"),
    [
        ("FACEMILL", 63.0, ToolKind.FACEMILL),
        ("FACEMILL", 10.0, ToolKind.ENDMILL),
        ("BALL_ENDMILL", 6.0, ToolKind.ENDMILL),
        ("TWIST_DRILL", 8.0, ToolKind.DRILL),
    ],
)
def test_a_small_face_mill_is_an_end_mill(
    keyword: str, diameter: float, kind: ToolKind
) -> None:
    assert tool_kind(Tool(id="T", keyword=keyword, diameter=diameter, teeth=4)) is kind
