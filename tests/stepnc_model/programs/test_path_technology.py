"""Tool paths with technologies of their own, and tools of which a file has only the name."""

import pytest

from stepnc_model.ap238.vendor_arc import vendor_arc
from stepnc_model.errors import SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import tool_name, tool_of
from stepnc_model.programs.user_tools import GivenTool
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import Move
from tests.stepnc_model.path_only import FACE, PathText, path_only_text

FACEMILL = GivenTool(number=7, id="T50", body="FACEMILL", diameter=50.0, teeth=5)


def program(
    paths: tuple[PathText, ...] = FACE, *, tools: tuple[GivenTool, ...] = ()
) -> Program:
    file = Part21File.from_bytes(path_only_text(paths).encode(), name="face.stpnc")
    return Program(file, name="face.stpnc", tools=tools)


def test_the_feed_is_that_of_the_paths_that_cut_most() -> None:
    found = program()
    (step,) = found.workingsteps
    assert step.operation_type == "freeform_operation"
    assert step.operation.its_technology not in step.technologies
    assert len(step.technologies) == 3
    assert programmed(found, step.technology_ref).feed.value == pytest.approx(5.0)


def test_paths_with_the_same_values_follow_one_technology() -> None:
    found = program()
    (step,) = found.workingsteps
    moves = [each for each in workingstep_path(found, step).steps if isinstance(each, Move)]
    assert [move.feed is None for move in moves] == [False, False, False, False, True]
    feeds = [move.feed.technology for move in moves if move.feed is not None]
    assert feeds[0] != step.technology_ref
    assert feeds[1:] == [step.technology_ref] * 3


def test_an_arc_of_a_vendors_property_is_followed_and_said() -> None:
    found = program()
    (step,) = found.workingsteps
    path = workingstep_path(found, step)
    (arc,) = (each.arc for each in path.steps if isinstance(each, Move) and each.arc)
    assert arc.centre == pytest.approx((60.0, 10.0, -1.0))
    assert arc.turn == pytest.approx(3.14159265)
    assert any(
        "read from 'next-nc circular motion'" in each.message for each in found.findings()
    )


@pytest.mark.parametrize(
    "text", ["", "[]", '{"start": [0, 0]}', '{"start": 1e999}', "{" * 9999]
)
def test_a_property_that_is_no_arc_is_none(text: str) -> None:
    assert vendor_arc(text) is None


def test_a_helix_of_a_vendors_property_ends_where_it_says() -> None:
    helix = PathText(
        feed=300.0,
        arc='{"start":[60,0,-1],"end":[60,20,-3],"center":[60,10,-1],"plane":"XY",'
        '"clockwise":true,"sweepRadians":9.42477796076938,"axialRise":-2}',
    )
    found = program((helix,))
    moves = [
        each
        for each in workingstep_path(found, found.workingsteps[0]).steps
        if isinstance(each, Move)
    ]
    assert moves[-1].end == pytest.approx((60.0, 20.0, -3.0))
    radii = [((m.end[0] - 60.0) ** 2 + (m.end[1] - 10.0) ** 2) ** 0.5 for m in moves]
    assert radii == pytest.approx([10.0] * len(moves))


def test_a_path_without_length_is_left_out_and_noted() -> None:
    found = program()
    path = workingstep_path(found, found.workingsteps[0])
    (note,) = [each for each in path.findings if "no length" in each.message]
    assert note.severity is Severity.NOTE


def test_a_tool_that_a_file_only_names_is_that_of_the_table() -> None:
    without = program()
    (step,) = without.workingsteps
    with pytest.raises(SchemaError, match="--tools gives a table with tool '7'"):
        tool_of(without, step.tool_ref)
    assert tool_name(without, step.tool_ref) == "7"
    given = program(tools=(FACEMILL,))
    tool = tool_of(given, step.tool_ref)
    assert (tool.id, tool.keyword, tool.diameter, tool.teeth) == ("7", "FACEMILL", 50.0, 5)
    assert given.changed(given.source).tools == given.tools
