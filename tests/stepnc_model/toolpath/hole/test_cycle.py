"""What a tool does in one hole, operation by operation.

A hole of 10 mm, 30 mm deep with a flat bottom, in the sample bracket; a tool of 9.8 mm without
a point; retract plane at z = 5 mm, security plane at 50 mm.
"""

from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.hole.cycle import PECK_CLEARANCE
from stepnc_model.toolpath.hole.operation import hole_path
from stepnc_model.toolpath.path import (
    CannedCycle,
    CycleKind,
    Dwell,
    Move,
    MoveType,
    SpindleCommand,
    ToolPath,
)
from stepnc_model.toolpath.task import job_of
from tests.every_case import every_case

TEXT = (
    (Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc")
    .read_text(encoding="utf-8")
    .replace("#167=THROUGH_BOTTOM_CONDITION();", "#167=FLAT_HOLE_BOTTOM();")
    .replace("(0.,0.,-40.));\n#166", "(0.,0.,-30.));\n#166")
    .replace("DIMENSION(9.8,20.,$,60.", "DIMENSION(9.8,$,$,60.")
)
OPERATION = "#212=DRILLING($,$,'DRILL HOLE 1',5.,$,#450,#311,#330,3.,$,$,$,$,#361);"


def path(
    kind: str,
    *,
    depth: str = "$",
    dwell: str = "$",
    retract: str = "$",
    strategy: str = "$",
    rest: str = "",
    changes: tuple[tuple[str, str], ...] = (),
) -> ToolPath:
    """Path of one operation."""
    made = (
        f"#212={kind}($,$,'DRILL HOLE 1',5.,$,#450,#311,#330,3.,{depth},$,{dwell},{retract},"
        f"{strategy}{rest});"
    )
    assert OPERATION in TEXT
    text = TEXT.replace(OPERATION, made)
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="bracket"))
    (step,) = (step for step in program.workingsteps if step.id == "DRILL HOLE 1")
    return hole_path(job_of(program, step))


def shown(found: ToolPath) -> list[str]:
    """Steps between the way down to the retract plane and that up from it, in short."""
    lines = []
    for step in found.steps[1:-1]:
        if isinstance(step, Move):
            lines.append(f"{'rapid' if step.feed is None else 'feed'} {step.end[2]:g}")
        elif isinstance(step, Dwell):
            lines.append(f"dwell {step.seconds:g}")
        elif isinstance(step, SpindleCommand):
            lines.append(step.value)
    return lines


def cycle(found: ToolPath) -> CannedCycle:
    (only,) = found.cycles
    return only


class TestDrilling:
    def test_it_feeds_in_and_out(self) -> None:
        found = path("DRILLING")
        assert shown(found) == ["feed -30", "feed 5"]
        assert cycle(found).kind is CycleKind.DRILL
        assert (cycle(found).retract_z, cycle(found).bottom_z) == (5.0, -30.0)

    def test_a_dwell_at_the_bottom_is_in_the_cycle(self) -> None:
        found = path("DRILLING", dwell="0.5")
        assert shown(found) == ["feed -30", "dwell 0.5", "feed 5"]
        assert (cycle(found).kind, cycle(found).dwell) == (CycleKind.DWELL, 0.5)

    def test_the_same_feed_out_by_order_is_a_boring_cycle(self) -> None:
        assert cycle(path("DRILLING", retract="1.")).kind is CycleKind.BORE

    def test_another_feed_out_is_no_cycle(self) -> None:
        found = path("DRILLING", retract="3.")
        assert found.cycles == ()
        feeds = [move.feed.ratio for move in found.moves if move.feed is not None]
        assert feeds == [1.0, 3.0]

    def test_several_feeds_are_no_cycle(self) -> None:
        found = path("DRILLING", strategy="#361")
        assert shown(found) == ["feed -2", "feed -30", "feed 5"]
        assert found.cycles == ()

    def test_a_negative_dwell_is_refused(self) -> None:
        with pytest.raises(PathError, match="dwell_time_bottom: -1 s"):
            path("DRILLING", dwell="-1.")


class TestPeck:
    def test_without_a_retract_distance_it_clears_the_chips(self) -> None:
        found = path("MULTISTEP_DRILLING", rest=",0.,12.,10.,$")
        assert shown(found) == [
            "feed -12",
            "rapid 5",
            "rapid -11",
            "feed -22",
            "rapid 5",
            "rapid -21",
            "feed -30",
            "rapid 5",
        ]
        assert found.cycles == ()

    def test_with_one_it_breaks_the_chip(self) -> None:
        found = path("MULTISTEP_DRILLING", rest=",2.,12.,12.,$")
        assert shown(found) == [
            "feed -12",
            "rapid -10",
            "feed -24",
            "rapid -22",
            "feed -30",
            "rapid 5",
        ]
        assert cycle(found).kind is CycleKind.CHIP_BREAK
        assert (cycle(found).step_depth, cycle(found).retract_distance) == (12.0, 2.0)

    def test_equal_steps_are_a_cycle(self) -> None:
        found = path("MULTISTEP_DRILLING", rest=",-1.,10.,10.,$")
        assert cycle(found).kind is CycleKind.PECK
        assert (cycle(found).first, cycle(found).last) == (1, len(found.steps) - 2)
        assert cycle(found).retract_distance == 0.0

    def test_a_dwell_between_steps_is_made_and_is_no_cycle(self) -> None:
        found = path("MULTISTEP_DRILLING", rest=",2.,20.,20.,0.3", dwell="1.")
        assert shown(found) == [
            "feed -20",
            "dwell 0.3",
            "rapid -18",
            "feed -30",
            "dwell 1",
            "rapid 5",
        ]
        assert found.cycles == ()

    def test_a_feed_on_retract_holds_for_the_last_one(self) -> None:
        assert shown(path("MULTISTEP_DRILLING", rest=",2.,20.,20.,$", retract="2."))[-1] == (
            "feed 5"
        )

    def test_a_feed_on_retract_of_zero_is_none(self) -> None:
        given, left = path("DRILLING", retract="0."), path("DRILLING")
        assert shown(given) == shown(left)
        (told,) = [each for each in given.findings if each.attribute == "feed_on_retract"]
        assert told.severity is Severity.WARNING

    def test_a_first_step_to_the_bottom_is_one_stroke(self) -> None:
        assert shown(path("MULTISTEP_DRILLING", rest=",2.,30.,5.,$")) == ["feed -30", "rapid 5"]

    @every_case(
        ("rest", "message"),
        [
            (",0.,0.,10.,$", "first_depth: 0.0 mm"),
            (",0.,10.,-1.,$", "depth_of_step: -1.0 mm"),
            (",0.,10.,0.00001,$", "depth_of_step: 2000000 pecks"),
        ],
    )
    def test_steps_that_lead_nowhere_are_refused(self, rest: str, message: str) -> None:
        with pytest.raises(PathError, match=message):
            path("MULTISTEP_DRILLING", rest=rest)

    @given(
        first=st.floats(0.5, 40.0),
        step=st.floats(0.5, 40.0),
        distance=st.floats(-5.0, 50.0),
        depth=st.floats(1.0, 38.0),
    )
    def test_no_rapid_enters_what_is_not_drilled_yet(
        self, first: float, step: float, distance: float, depth: float
    ) -> None:
        found = path(
            "MULTISTEP_DRILLING", rest=f",{distance!r},{first!r},{step!r},$", depth=repr(depth)
        )
        drilled = 0.0
        for start, move in found.segments():
            if move.feed is None and move.end[2] < start[2] and move.end[2] < 5.0:
                assert move.end[2] >= drilled + PECK_CLEARANCE - 1e-9
            drilled = min(drilled, move.end[2])
            assert move.end[2] <= 50.0
        assert drilled == pytest.approx(-depth)
        feeds = [move.end[2] for move in found.moves if move.type is MoveType.CONTACT]
        assert all(b < a for a, b in pairwise(feeds))


class TestBoring:
    REST = ",.F.,$,$"
    STOP = ",.T.,$,$"

    @pytest.mark.parametrize("kind", ["BORING", "REAMING"])
    def test_it_feeds_in_and_out_as_a_cycle(self, kind: str) -> None:
        found = path(kind, rest=self.REST)
        assert shown(found) == ["feed -30", "feed 5"]
        assert cycle(found).kind is CycleKind.BORE

    def test_a_stop_at_the_bottom_ends_on_the_retract_plane(self) -> None:
        found = path("BORING", rest=self.STOP, dwell="2.")
        assert shown(found) == ["feed -30", "dwell 2", "stop", "feed 5", "start"]
        assert (cycle(found).kind, cycle(found).dwell) == (CycleKind.BORE_STOP, 2.0)
        assert cycle(found).last == len(found.steps) - 2

    def test_an_oriented_stop_is_no_cycle(self) -> None:
        change = (
            "#330=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$",
            "#330=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,#502",
        )
        found = path("BORING", rest=self.STOP, changes=(change,))
        assert "orient" in shown(found)
        assert found.cycles == ()

    def test_a_test_cut_comes_out_to_be_measured(self) -> None:
        """Waiting position 40 mm beside the hole and 20 mm above it."""
        point = ("#500=", "#640=CARTESIAN_POINT('WAIT',(40.,0.,20.));\n#500=")
        found = path("BORING", rest=",.F.,3.,#640", changes=(point,))
        assert shown(found) == [
            "feed -3",
            "feed 5",
            "stop",
            "rapid 20",
            "rapid 20",
            "rapid 20",
            "start",
            "rapid 5",
            "feed -30",
            "feed 5",
        ]
        assert (150.0, 65.0, 20.0) in [move.end for move in found.moves]
        (finding,) = found.findings
        assert (finding.severity, finding.attribute) == (Severity.WARNING, "depth_of_testcut")
        assert found.steps[cycle(found).first] == found.moves[-3]

    def test_a_waiting_position_below_the_retract_plane_is_passed_above_it(self) -> None:
        point = ("#500=", "#640=CARTESIAN_POINT('WAIT',(40.,0.,-20.));\n#500=")
        found = path("BORING", rest=",.F.,3.,#640", changes=(point,))
        assert (150.0, 65.0, 5.0) in [move.end for move in found.moves]

    @pytest.mark.parametrize("depth", ["30.", "-1."])
    def test_a_test_cut_that_is_none_is_refused(self, depth: str) -> None:
        with pytest.raises(PathError, match=r"depth_of_testcut: .*between 0 and"):
            path("BORING", rest=f",.F.,{depth},$")


class TestTapping:
    def test_it_comes_out_with_the_spindle_reversed(self) -> None:
        found = path("TAPPING", rest=",.F.")
        assert found.steps[2] is SpindleCommand.REVERSE
        assert shown(found) == ["feed -30", "reverse", "feed 5", "start"]
        assert cycle(found).kind is CycleKind.TAP

    def test_both_ways_are_synchronised(self) -> None:
        """5.3 mm/s at 38 rev/s."""
        feeds = [move.feed for move in path("TAPPING", rest=",.T.").moves if move.feed]
        assert all(feed.is_synchronised for feed in feeds)
        assert [feed.per_revolution for feed in feeds] == [pytest.approx(5.3 / 38.0)] * 2

    def test_a_tap_may_be_wider_than_its_hole(self) -> None:
        wider = ("DIMENSION(9.8,$", "DIMENSION(12.,$")
        assert shown(path("TAPPING", rest=",.F.", changes=(wider,)))[0] == "feed -30"
