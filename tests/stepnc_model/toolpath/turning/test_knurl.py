"""A knurl is pressed in and fed along once."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.path import Move, MoveType, ToolPath


def cuts(path: ToolPath) -> list[Move]:
    return [move for move in path.moves if move.type is MoveType.CONTACT]


END = "ENDSEC;\nEND-"


KNURL = (
    ("#205=THREADING_ROUGH($,$,'THREAD M30 X 2',5.,$,#430,#304,#330,$,$,#355,0.)",
     "#205=KNURLING($,$,'K',5.,$,#430,#304,#330,$,$,$)"),
    ("#43,(#140),#205", "#43,(#601),#205"),
)  # fmt: skip


def knurl(path_of: Callable[..., ToolPath], depth: str) -> ToolPath:
    feature = f"#601=STRAIGHT_KNURL('K',#30,(),#41,#140,$,{depth},$,$,$,$,$);\n"
    size = "#602=TOLERANCED_LENGTH_MEASURE(0.5,#510);\n"
    return path_of("THREAD M30 X 2", *KNURL, (END, feature + size + END))


def test_a_knurl_is_pressed_in_and_fed_along(path_of: Callable[..., ToolPath]) -> None:
    assert [m.end for m in cuts(knurl(path_of, "#602"))] == [
        (14.5, 0.0, 0.0),
        (14.5, 0.0, -25.0),
    ]


def test_a_knurl_without_depth_is_refused(path_of: Callable[..., ToolPath]) -> None:
    with pytest.raises(SchemaError, match="tooth depth"):
        knurl(path_of, "$")
