"""Words that tell kinds, teeth and edges of tools."""

import pytest

from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.tool_words import edge_in, kind_in, teeth_in


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("3/8 centre drill", ToolKind.CENTER_DRILL),
        ("tap drill", ToolKind.DRILL),
        ("m6 tap", ToolKind.TAP),
        ("facing head", ToolKind.FACEMILL),
        ("surface ball", ToolKind.ENDMILL),
        ("probe", None),
    ],
)
def test_the_first_word_that_is_found_counts(text: str, kind: ToolKind | None) -> None:
    assert kind_in(text) is kind


def test_teeth_and_edges() -> None:
    assert teeth_in("4-flute") == 4
    assert teeth_in("z=3") == 3
    assert teeth_in("6 mm") is None
    assert edge_in("solid carbide") is CuttingMaterial.CARBIDE
    assert edge_in("hsse") is CuttingMaterial.HSS
    assert edge_in("mill") is None
