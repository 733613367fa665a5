"""A path while it is being made, on the sample bracket."""

from pathlib import Path

import pytest

from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.path import (
    ArcPlane,
    CannedCycle,
    CycleKind,
    Dwell,
    Feed,
    MoveType,
    SpindleCommand,
)
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask, job_of

BRACKET = Path(__file__).parents[3] / "examples" / "parts" / "bracket.stpnc"


@pytest.fixture(scope="module")
def job() -> ToolPathTask:
    program = Program.load(BRACKET)
    return job_of(program, program.workingsteps[-1])


@pytest.fixture
def course(job: ToolPathTask) -> PathBuilder:
    return PathBuilder(job, (0.0, 0.0, 50.0))


def test_it_knows_where_the_tool_is(course: PathBuilder) -> None:
    assert course.at == (0.0, 0.0, 50.0)
    course.rapid((1.0, 2.0, 5.0))
    assert course.at == (1.0, 2.0, 5.0)


def test_a_move_that_leads_nowhere_is_none(course: PathBuilder) -> None:
    course.rapid((0.0, 0.0, 50.0))
    assert course.count == 0


def test_a_full_circle_leads_back_and_is_a_move(course: PathBuilder) -> None:
    course.arc((0.0, 0.0, 50.0), MoveType.CONTACT, centre=(5.0, 0.0, 0.0), turn=6.28)
    assert course.count == 1


def test_rapids_have_no_feed_and_lines_the_programmed_one(
    course: PathBuilder, job: ToolPathTask
) -> None:
    course.rapid((1.0, 0.0, 50.0))
    course.line((1.0, 0.0, 0.0), MoveType.CONTACT)
    course.line((2.0, 0.0, 0.0), MoveType.CONTACT, Feed(technology=Ref(9), ratio=0.5))
    feeds = [move.feed for move in course.finished().moves]
    assert feeds == [
        None,
        Feed(technology=job.step.technology_ref),
        Feed(technology=Ref(9), ratio=0.5),
    ]


def test_an_arc_keeps_its_plane(course: PathBuilder) -> None:
    course.arc(
        (0.0, 5.0, 45.0),
        MoveType.CONTACT,
        centre=(0.0, 0.0, 45.0),
        turn=-1.0,
        plane=ArcPlane.YZ,
    )
    (move,) = course.finished().moves
    assert move.arc is not None
    assert (move.arc.plane, move.arc.turn) == (ArcPlane.YZ, -1.0)


def test_pauses_and_spindle_commands_are_steps(course: PathBuilder) -> None:
    course.dwell(seconds=2.0)
    course.dwell(revolutions=3.0)
    course.spindle(SpindleCommand.STOP)
    steps = (Dwell(seconds=2.0), Dwell(revolutions=3.0), SpindleCommand.STOP)
    assert course.finished().steps == steps
    assert course.finished().end == (0.0, 0.0, 50.0)


def test_a_finding_is_said_once(course: PathBuilder, job: ToolPathTask) -> None:
    course.find(job.note("guessed"))
    course.find(job.note("guessed"))
    course.find(job.note("guessed too"))
    assert [each.message for each in course.finished().findings] == ["guessed", "guessed too"]


def test_a_path_tells_whose_it_is(course: PathBuilder, job: ToolPathTask) -> None:
    cycle = CannedCycle(
        kind=CycleKind.DRILL, first=0, last=0, retract_z=5.0, bottom_z=-1.0, feed=job.feed
    )
    course.cycle(cycle)
    path = course.finished()
    step = job.step
    assert (path.workingstep, path.id) == (step.ref, step.id)
    assert (path.operation_ref, path.tool_ref) == (step.operation_ref, step.tool_ref)
    assert (path.technology_ref, path.functions_ref) == (
        step.technology_ref,
        step.functions_ref,
    )
    assert path.cycles == (cycle,)
    assert not path.is_turning
    assert path.start == (0.0, 0.0, 50.0)


def test_a_lathes_path_says_so(job: ToolPathTask) -> None:
    assert PathBuilder(job, (0.0, 0.0, 0.0), is_turning=True).finished().is_turning
