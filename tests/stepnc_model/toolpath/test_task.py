"""What a tool path is made from: heights and raw part of the sample parts."""

from pathlib import Path

import pytest

from stepnc_model.errors import Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.task import (
    ABOVE_STOCK,
    DEFAULT_CLEARANCE,
    DEFAULT_SECURITY,
    ToolPathTask,
    clamps_of,
    job_of,
    stock_of,
    unused_stock,
)

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def edited(*changes: tuple[str, str], part: str = "bracket") -> Program:
    text = (PARTS / f"{part}.stpnc").read_text(encoding="utf-8")
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name=part))


def first(program: Program) -> ToolPathTask:
    return job_of(program, program.workingsteps[0])


def test_the_security_plane_of_the_workingstep_comes_first() -> None:
    assert first(edited(("(0.,0.,50.)", "(0.,0.,35.)"))).security_z == 35.0


def test_the_setups_security_plane_comes_next() -> None:
    job = first(edited(("'ROUGH FACE',#43", "'ROUGH FACE',$")))
    assert job.security_z == 50.0
    assert job.findings == ()


def test_without_any_it_is_assumed_and_said() -> None:
    program = edited(
        ("'ROUGH FACE',#43", "'ROUGH FACE',$"), ("SETUP('SETUP 1',#41,#43", "SETUP('S',#41,$")
    )
    job = first(program)
    assert job.security_z == DEFAULT_SECURITY
    (finding,) = job.findings
    assert finding.severity is Severity.NOTE
    assert finding.attribute == "its_secplane"
    assert "z = 50 mm" in finding.message


def test_an_assumed_security_plane_lies_above_a_high_stock() -> None:
    program = edited(
        ("'ROUGH FACE',#43", "'ROUGH FACE',$"),
        ("SETUP('SETUP 1',#41,#43", "SETUP('S',#41,$"),
        ("156.,96.,42.", "156.,96.,142."),
    )
    assert first(program).security_z == 102.0 + DEFAULT_CLEARANCE


def test_a_block_is_a_box() -> None:
    """156 x 96 x 42 mm from (−3, −3, −40)."""
    program = edited()
    stock = stock_of(program, program.workingsteps[0].setup)
    assert stock is not None
    assert (stock.low, stock.high) == ((-3.0, -3.0, -40.0), (153.0, 93.0, 2.0))
    assert stock.radius is None


def test_a_bar_has_a_radius() -> None:
    """Bar of 60 mm, 152 mm long, from z = −150 mm."""
    program = edited(part="shaft")
    stock = stock_of(program, program.workingsteps[0].setup)
    assert stock is not None
    assert stock.radius == 30.0
    assert (stock.low[2], stock.high[2]) == (-150.0, 2.0)
    assert (stock.low[0], stock.high[0]) == (-30.0, 30.0)


def test_no_bounding_geometry_is_no_stock() -> None:
    program = edited(("0.05,$,$,#33,", "0.05,$,$,$,"))
    assert stock_of(program, None) is None


def test_messages_name_instance_line_and_attribute() -> None:
    job = first(edited())
    error = job.fault("too deep", job.step.ref, "its_feature")
    assert (error.entity, error.attribute) == ("#10 MACHINING_WORKINGSTEP", "its_feature")
    assert error.line == job.program.line(job.step.ref)
    assert job.note("guessed").entity == "#200 PLANE_ROUGH_MILLING"
    warning = job.warning("short", job.step.tool_ref, "its_id")
    assert (warning.severity, warning.entity) == (
        Severity.WARNING,
        "#400 MILLING_CUTTING_TOOL",
    )


def test_the_programmed_feed_is_that_of_the_technology() -> None:
    job = first(edited())
    assert (job.feed.technology, job.feed.ratio) == (job.step.technology_ref, 1.0)


def test_a_feature_stands_where_the_file_puts_it() -> None:
    program = edited()
    job = job_of(program, program.workingsteps[-1])
    assert job.frame(job.step.features[0]).origin == pytest.approx((127.0, 65.0, 0.0))


def test_a_rapid_comes_down_beside_the_stock_and_stops_above_it() -> None:
    """The stock of the bracket: x −3 to 153 mm, up to z = 2 mm; the face mill has 63 mm."""
    job = first(edited())
    assert job.rapid_z((75.0, 45.0, 12.0)) == 12.0
    assert job.rapid_z((75.0, 45.0, -5.0)) == 2.0 + ABOVE_STOCK
    assert job.rapid_z((-34.4, 45.0, -5.0)) == 2.0 + ABOVE_STOCK
    assert job.rapid_z((-34.6, 45.0, -5.0)) == -5.0


def test_a_security_plane_below_the_stock_is_raised_above_it() -> None:
    program = edited((
        "#45=CARTESIAN_POINT('',(0.,0.,50.));",
        "#45=CARTESIAN_POINT('',(0.,0.,2.5));",
    ))
    job = job_of(program, program.workingsteps[-1])
    assert job.frame(job.step.features[0]).origin == pytest.approx((127.0, 65.0, 0.0))


def test_clamping_positions_come_out_in_the_setup() -> None:
    """The jaws of the bracket, with the workpiece standing 100 mm further along x."""
    program = edited(("#42=WORKPIECE_SETUP(#30,#41,$,$,());",
                      "#42=WORKPIECE_SETUP(#30,#900,$,$,());\n"
                      "#900=AXIS2_PLACEMENT_3D('MOVED',#901,#501,#502);\n"
                      "#901=CARTESIAN_POINT('',(100.,0.,0.));"))  # fmt: skip
    setup = program.workingsteps[0].setup
    assert clamps_of(program, setup) == ((175.0, 93.0, -32.0), (175.0, -3.0, -32.0))


@pytest.mark.parametrize(("height", "is_used"), [("-39.", True), ("-1.", True), ("10.", False)])
def test_a_raw_part_above_all_features_is_not_used(height: str, is_used: bool) -> None:
    text = (PARTS / "bracket.stpnc").read_text(encoding="utf-8")
    place = text.index("#35=CARTESIAN_POINT('',(")
    line = text[place : text.index("\n", place)]
    x, y, _ = line.partition("(")[2].split("(")[1].split(")")[0].split(",")
    program = edited((line, f"#35=CARTESIAN_POINT('',({x},{y},{height}));"))
    setup = program.workingsteps[0].setup
    assert (stock_of(program, setup) is not None) is is_used
    told = unused_stock(program, setup)
    assert (told is None) is is_used
