"""Feed, speed and depth edited in an operation of its own."""

from pathlib import Path

import pytest

from stepnc_model.editing.cut_settings import edit_depth, edit_number, rounded
from stepnc_model.editing.draft import Draft
from stepnc_model.entities.operations import Toolpath
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed

PARTS = Path(__file__).parents[2] / "examples" / "parts"


@pytest.mark.parametrize("number", [1 / 3, 1e-300, 123456789.123456789, -0.1])
def test_a_rounded_number_has_twelve_digits(number: float) -> None:
    assert rounded(number) == pytest.approx(number, rel=1e-11)
    assert rounded(rounded(number)) == rounded(number)


def test_a_number_that_is_the_same_is_not_written() -> None:
    program = Program.load(PARTS / "paper003_case1.stpnc")
    step, draft = program.workingsteps[0], Draft(program)
    feed = programmed(program, step.technology_ref).feed
    edit_number(draft, step, feed, feed.in_file(feed.value * (1.0 + 1e-14)))
    assert draft.edits.apply() == program.file.data


def test_a_shared_technology_is_copied_before_it_is_edited() -> None:
    program = Program.load(PARTS / "bracket.stpnc")
    steps = program.workingsteps
    one, other = next(
        (one, other)
        for one in steps
        for other in steps
        if one.technology_ref == other.technology_ref
        and one.operation_ref != other.operation_ref
    )
    draft = Draft(program)
    feed = programmed(program, one.technology_ref).feed
    edit_number(draft, one, feed, feed.in_file(2.0 * feed.value))
    file = Part21File.from_bytes(draft.edits.apply(), name=program.name)
    after = Program(file, name=program.name)
    fed = [
        programmed(after, after.workingsteps[step.index].technology_ref).feed.value
        for step in (one, other)
    ]
    assert fed == pytest.approx([2.0 * feed.value, feed.value])


PATHS = (
    "#900=TOOLPATH_LIST((#901,#902));\n"
    "#901=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,{},$,$,#903,$,$);\n"
    "#902=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#903,$,$);\n"
    "#903=POLYLINE('',(#904,#905));\n#904=CARTESIAN_POINT('',(0.,0.,0.));\n"
    "#905=CARTESIAN_POINT('',(1.,0.,0.));\nENDSEC;\nEND-ISO"
)
OTHER = "'AGAIN',#22,#30,#45,$);\n#45=PLANE_ROUGH_MILLING($,$,'B',10.,$,#50,#41,#42,$,"


def with_paths(technology: str, *, of_other: str = "$") -> Program:
    """Program with two operations of one technology, the first with a path that names it."""
    text = (PARTS / "paper002.stpnc").read_text()
    text = text.replace("(#3),$,#20,$", "(#3,#4),$,#20,$")
    text = text.replace("#40=PLANE_ROUGH_MILLING($,", "#40=PLANE_ROUGH_MILLING(#900,")
    more = f"#4=MACHINING_WORKINGSTEP({OTHER}#43,#43,#44,3.,0.);\n".replace(
        "($,", f"({of_other},"
    )
    text = text.replace("ENDSEC;\nEND-ISO", more + PATHS.format(technology))
    return Program(Part21File.from_bytes(text.encode(), name="paths"), name="paths")


@pytest.mark.parametrize("technology", ["#41", "$"])
def test_a_path_that_names_the_technology_follows_its_copy(technology: str) -> None:
    """It would keep the old feed: a helical ramp at 2400 mm/min where 457 are advised."""
    program = with_paths(technology)
    step, draft = program.workingsteps[0], Draft(program)
    feed = programmed(program, step.technology_ref).feed
    edit_number(draft, step, feed, 2.0 * feed.in_file(feed.value))
    after = Program(Part21File.from_bytes(draft.edits.apply(), name="paths"), name="paths")
    own = after.workingsteps[0].technology_ref
    assert own != step.technology_ref == after.workingsteps[1].technology_ref
    assert after.get(Ref[Toolpath](901)).its_technology == (None if technology == "$" else own)
    assert after.get(Ref[Toolpath](902)).its_technology is None


def test_a_path_of_two_operations_cannot_follow_both() -> None:
    program = with_paths("#41", of_other="#900")
    step, draft = program.workingsteps[0], Draft(program)
    feed = programmed(program, step.technology_ref).feed
    with pytest.raises(SchemaError, match=r'--set "#901.its_technology=\$"') as fault:
        edit_number(draft, step, feed, 2.0 * feed.in_file(feed.value))
    assert fault.value.attribute == "its_technology"


@pytest.mark.parametrize("name", ["paper003_case1", "shaft"])
def test_a_depth_is_that_of_the_operation_or_the_strategy(name: str) -> None:
    program = Program.load(PARTS / f"{name}.stpnc")
    draft = Draft(program)
    assert edit_depth(draft, program.workingsteps[0], 0.75)
    assert b"0.75" in draft.edits.apply()


def test_a_drill_has_none() -> None:
    program = Program.load(PARTS / "bracket.stpnc")
    drill = next(step for step in program.workingsteps if "drill" in step.operation_type)
    draft = Draft(program)
    assert not edit_depth(draft, drill, 0.75)
    assert draft.edits.apply() == program.file.data
