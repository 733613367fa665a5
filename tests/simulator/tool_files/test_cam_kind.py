"""Kinds of tools by the names of CAM systems."""

from simulator.spec import ToolKind
from simulator.tool_files.cam_kind import kind_named
from tests.every_case import every_case


@every_case(
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
