"""How deep a tool goes, against the geometry of points and bottoms.

A drill of 9.8 mm with a lip angle of 20 degrees unless the test says otherwise: its point is
4.9·tan 20° = 1.7835 mm long. The hole is 10 mm wide and 30 mm deep; the stock ends at −40 mm.
"""

from dataclasses import dataclass
from math import radians, sqrt, tan
from pathlib import Path

import pytest

from stepnc_model.entities.milling import DrillingTypeOperation
from stepnc_model.errors import Finding, PathError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.hole.feature import (
    Depth,
    depth_findings,
    depth_of,
    holes_of,
    tip_length,
)
from stepnc_model.toolpath.task import ToolPathTask, job_of
from tests.every_case import every_case

BRACKET = Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc"
POINT = 4.9 * tan(radians(20.0))
DEPTH_30 = ("(0.,0.,-40.));\n#166", "(0.,0.,-30.));\n#166")
BOTTOM = "#167=THROUGH_BOTTOM_CONDITION();"
FLAT = (BOTTOM, "#167=FLAT_HOLE_BOTTOM();")
DRILL = "#452=MILLING_TOOL_DIMENSION(9.8,20.,$,60.,$,$,$);"
OPERATION = "'DRILL HOLE 1',5.,$,#450,#311,#330,3.,$,"


def job_for(name: str, *changes: tuple[str, str]) -> ToolPathTask:
    text = BRACKET.read_text(encoding="utf-8")
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="bracket"))
    (step,) = (step for step in program.workingsteps if step.id == name)
    return job_of(program, step)


@dataclass(frozen=True)
class Found:
    depth: Depth
    findings: list[Finding]


def drilled(*changes: tuple[str, str], name: str = "DRILL HOLE 1") -> Found:
    job = job_for(name, DEPTH_30, *changes)
    operation = job.step.operation
    assert isinstance(operation, DrillingTypeOperation)
    (hole,) = holes_of(job, operation)
    depth = depth_of(job, operation, hole)
    return Found(depth=depth, findings=depth_findings(job, operation, hole, depth))


def sizes(depth: Depth) -> tuple[float, float]:
    return depth.full, depth.tip


class TestTip:
    @every_case(
        ("dimension", "expected"),
        [
            ("9.8,20.,$,60.,$,$,$", POINT),
            ("9.8,0.3490658503988659,$,60.,$,$,$", POINT),
            ("9.8,$,$,60.,$,$,$", 0.0),
            ("9.8,0.,$,60.,0.,$,$", 0.0),
            ("9.8,$,$,60.,0.8,$,$", 0.8),
            # 8·tan 31° + 2/cos 31° by a table of functions: 8·0.600861 + 2·1.166633
            ("20.,31.,0.1,45.,2.,5.,8.", 7.140152),
            ("20.,31.,0.1,45.,2.,$,$", 7.140152),
        ],
    )
    def test_it_follows_from_angle_and_corner(self, dimension: str, expected: float) -> None:
        change = (DRILL, f"#452=MILLING_TOOL_DIMENSION({dimension});")
        assert tip_length(job_for("DRILL HOLE 1", change)) == pytest.approx(expected, abs=2e-6)

    def test_a_balls_is_its_radius(self) -> None:
        change = ("#451=TWIST_DRILL(", "#451=BALL_ENDMILL(")
        assert tip_length(job_for("DRILL HOLE 1", change)) == 4.9

    @every_case("angle", ["90.", "118.", "-20.", "1.6"])
    def test_an_angle_that_makes_no_point_is_refused(self, angle: str) -> None:
        change = (DRILL, DRILL.replace("20.", angle))
        with pytest.raises(PathError, match=r"#452 .*tool_top_angle.* 0 to 90 degrees"):
            tip_length(job_for("DRILL HOLE 1", change))


class TestBottom:
    def test_through_a_hole_the_full_diameter_passes_by_the_overcut(self) -> None:
        depth = drilled().depth
        assert sizes(depth) == pytest.approx((33.0, 33.0 + POINT))

    def test_on_a_flat_bottom_the_tip_stops_and_it_is_said(self) -> None:
        found = drilled(FLAT)
        assert found.depth.tip == 30.0
        (finding,) = found.findings
        assert finding.severity is Severity.NOTE
        assert "1.783 mm above" in finding.message

    def test_a_corner_radius_does_not_change_a_flat_bottom(self) -> None:
        change = (BOTTOM, "#167=FLAT_WITH_RADIUS_HOLE_BOTTOM(#166);")
        assert drilled(change).depth.tip == 30.0

    def test_a_tool_without_point_cuts_a_flat_bottom_and_nothing_is_said(self) -> None:
        found = drilled(FLAT, (DRILL, DRILL.replace("20.", "$")))
        assert found.depth == Depth(full=30.0, tip=30.0)
        assert found.findings == []

    def test_a_conical_bottom_is_what_the_drill_leaves(self) -> None:
        change = (BOTTOM, "#167=CONICAL_HOLE_BOTTOM(118.,$);")
        depth = drilled(change).depth
        assert sizes(depth) == pytest.approx((30.0, 30.0 + POINT))

    def test_a_point_longer_than_a_spherical_cap_stops_on_it(self) -> None:
        """Cap of a sphere of radius 25 mm on a circle of 5 mm: 25 − √600."""
        change = (
            BOTTOM,
            "#167=SPHERICAL_HOLE_BOTTOM(#601);\n#601=TOLERANCED_LENGTH_MEASURE(25.,$);",
        )
        assert drilled(change).depth.tip == pytest.approx(30.0 + 25.0 - sqrt(600.0))

    def test_a_ball_cuts_the_half_sphere_of_its_radius(self) -> None:
        """Ball of 10 mm: its cylinder ends where the sphere begins."""
        depth = drilled(
            (
                BOTTOM,
                "#167=SPHERICAL_HOLE_BOTTOM(#601);\n#601=TOLERANCED_LENGTH_MEASURE(5.,$);",
            ),
            ("#451=TWIST_DRILL(", "#451=BALL_ENDMILL("),
            (DRILL, "#452=MILLING_TOOL_DIMENSION(10.,$,$,60.,$,$,$);"),
        ).depth
        assert sizes(depth) == pytest.approx((30.0, 35.0))

    def test_a_sphere_smaller_than_the_hole_is_refused(self) -> None:
        change = (
            BOTTOM,
            "#167=SPHERICAL_HOLE_BOTTOM(#601);\n#601=TOLERANCED_LENGTH_MEASURE(4.,$);",
        )
        with pytest.raises(
            PathError, match="sphere radius 4 mm is smaller than the hole radius 5 mm"
        ):
            drilled(change)

    def test_a_negative_overcut_is_refused(self) -> None:
        with pytest.raises(PathError, match=r"overcut_length: -3 mm"):
            drilled((OPERATION, OPERATION.replace("3.,$,", "-3.,$,")))


class TestCuttingDepth:
    def test_it_is_measured_to_the_full_diameter(self) -> None:
        depth = drilled((OPERATION, OPERATION.replace("3.,$,", "3.,12.,"))).depth
        assert sizes(depth) == pytest.approx((12.0, 12.0 + POINT))

    def test_deeper_than_a_blind_hole_is_a_warning(self) -> None:
        found = drilled(FLAT, (OPERATION, OPERATION.replace("3.,$,", "3.,31.,")))
        (finding,) = found.findings
        assert (finding.severity, finding.attribute) == (Severity.WARNING, "cutting_depth")
        assert "31 mm is deeper than the hole depth of 30 mm" in finding.message

    @pytest.mark.parametrize("depth", ["0.", "-2."])
    def test_it_must_be_positive(self, depth: str) -> None:
        with pytest.raises(PathError, match=r"cutting_depth: .*must be positive"):
            drilled((OPERATION, OPERATION.replace("3.,$,", f"3.,{depth},")))

    def test_it_is_enough_where_the_feature_has_no_depth(self) -> None:
        no_plane = ("#161,#163,#166", "#161,$,#166")
        given = (OPERATION, OPERATION.replace("3.,$,", "3.,12.,"))
        assert drilled(no_plane, given).depth.full == 12.0
        with pytest.raises(PathError, match=r"#160 .*depth: neither the hole's depth"):
            drilled(no_plane)

    def test_a_centre_drills_is_measured_to_its_tip(self) -> None:
        assert drilled(name="CENTRE HOLE 1").depth.tip == 1.0

    def test_without_it_a_centre_drill_goes_in_by_its_point(self) -> None:
        """3·tan 20°."""
        change = ("'CENTRE HOLE 1',5.,$,#440,#310,#330,$,1.", "'C',5.,$,#440,#310,#330,$,$")
        depth = drilled(change, name="CENTRE HOLE 1").depth
        assert sizes(depth) == pytest.approx((0.0, 3.0 * tan(radians(20.0))))


class TestSink:
    SINK = ("#212=DRILLING(", "#212=COUNTER_SINKING(")
    WIDE = (DRILL, "#452=MILLING_TOOL_DIMENSION(16.,45.,$,60.,$,$,$);")
    TAPER = ("#163,#166,$,#167", "#163,#166,#601,#167")
    ANGLE = ("#160=ROUND", "#601=ANGLE_TAPER(45.);\n#160=ROUND")

    def test_the_cone_is_as_wide_as_the_sink_at_the_top(self) -> None:
        """90 degrees on 10 mm: 5 mm deep."""
        found = drilled(self.SINK, self.WIDE, self.TAPER, self.ANGLE)
        assert sizes(found.depth) == pytest.approx((-3.0, 5.0))

    def test_its_cutting_depth_is_measured_to_the_tip(self) -> None:
        given = (OPERATION, OPERATION.replace("3.,$,", "3.,4.,"))
        assert drilled(self.SINK, self.WIDE, given).depth.tip == 4.0

    def test_a_hole_without_taper_does_not_tell(self) -> None:
        with pytest.raises(PathError, match="a cutting depth is needed"):
            drilled(self.SINK, self.WIDE)

    def test_a_tool_narrower_than_the_sink_is_refused(self) -> None:
        with pytest.raises(
            PathError, match=r"tool of 9\.8 mm is too narrow for a sink of 10 mm"
        ):
            drilled(self.SINK, self.TAPER, self.ANGLE)


class TestFit:
    @every_case(("diameter", "fits"), [("10.", True), ("10.01", True), ("10.02", False)])
    def test_a_drill_wider_than_the_hole_is_refused(self, diameter: str, fits: bool) -> None:
        change = (DRILL, DRILL.replace("9.8", diameter))
        if fits:
            drilled(change)
            return
        with pytest.raises(
            PathError, match=r"tool of 10\.02 mm diameter is too wide for a hole of 10 mm"
        ):
            drilled(change)

    def test_a_taper_is_as_wide_as_its_narrow_end(self) -> None:
        """1 degree over 30 mm: 10 − 2·30·tan 1° = 8.95 mm."""
        changes = (
            ("#163,#166,$", "#163,#166,#601"),
            ("#160=R", "#601=ANGLE_TAPER(1.);\n#160=R"),
        )
        with pytest.raises(PathError, match=r"a hole of 8\.95\d* mm"):
            drilled(*changes)
        drilled(
            *changes,
            (
                "#451=TWIST_DRILL(#452,2,.RIGHT.,.F.,$)",
                "#451=TAPERED_DRILL(#452,2,.RIGHT.,.F.,$,1.)",
            ),
        )

    def test_a_blind_hole_through_the_bottom_of_the_stock_is_refused(self) -> None:
        change = ("(0.,0.,-30.));\n#166", "(0.,0.,-40.5));\n#166")
        with pytest.raises(PathError, match=r"z = -40\.5 mm breaks .* z = -40 mm"):
            drilled(FLAT, change, (DRILL, DRILL.replace("20.", "$")))

    def test_a_short_cutting_edge_is_a_warning(self) -> None:
        found = drilled((DRILL, DRILL.replace("60.", "34.")))
        (finding,) = found.findings
        assert finding.severity is Severity.WARNING
        assert "cutting edge of 34 mm is shorter than the depth of 34.78 mm" in finding.message

    def test_a_short_tool_is_a_warning(self) -> None:
        found = drilled(("'DRILL 9.8MM',#451,(#453),95.", "'DRILL 9.8MM',#451,(#453),30."))
        (finding,) = found.findings
        assert finding.attribute == "overall_assembly_length"
