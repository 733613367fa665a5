"""Kinds of tools by the names of CAM systems."""

import pytest

from simulator.spec import ToolKind
from simulator.tool_files.cam_kind import kind_named


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("flat end mill", ToolKind.ENDMILL),
        ("Ball  End Mill", ToolKind.ENDMILL),
        ("spot_drill", ToolKind.CENTER_DRILL),
        ("tap left hand", ToolKind.TAP),
        ("holder", None),
        ("probe", None),
        ("", None),
    ],
)
def test_kinds(name: str, kind: ToolKind | None) -> None:
    assert kind_named(name) is kind
