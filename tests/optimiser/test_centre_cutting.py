"""Which mills may go straight down into the solid."""

from optimiser.planning.formulate import OptimisationTask
from stepnc_model.errors import Severity
from stepnc_model.programs.tool import tool_of
from tests.optimiser.plans import advice_of, after, edited, measured

OPEN = ("ROUGH OPEN POCKET", "FINISH OPEN POCKET")
RAMP = ("'ROUGH OPEN POCKET',10.,$,#430,#305,#330,5.,#340,",
        "'ROUGH OPEN POCKET',10.,$,#430,#305,#330,5.,#342,")  # fmt: skip


def test_the_form_of_some_bodies_tells() -> None:
    program = edited("bracket")
    told = {}
    for step in program.workingsteps:
        tool = tool_of(program, step.tool_ref)
        told[tool.keyword] = tool.centre_cutting
    assert told["FACEMILL"] is False
    assert told["TAPERED_ENDMILL"] is None
    flat = "TAPERED_ENDMILL(#432,4,.RIGHT.,.F.,$,$)"
    ball = edited("bracket", (flat, "BALL_ENDMILL(#432,4,.RIGHT.,.F.,$)"))
    step = next(each for each in ball.workingsteps if each.id == OPEN[0])
    assert tool_of(ball, step.tool_ref).centre_cutting is True


def told_of_centre(task: OptimisationTask) -> list[tuple[Severity, str]]:
    plan = measured("bracket", task)
    return [(f.severity, f.entity) for f in plan.findings if "centre" in f.message]


def test_an_unknown_cutter_is_told_once_to_take_a_ramp() -> None:
    ((severity, entity),) = told_of_centre(OptimisationTask())
    assert severity is Severity.WARNING
    assert entity == "#430 MILLING_CUTTING_TOOL"
    assert measured("bracket", OptimisationTask()).faults == ()


def test_a_cutter_that_does_not_cut_over_centre_may_not_go_straight_down() -> None:
    task = OptimisationTask(centre_cutting={"END MILL 10MM": False})
    plan = measured("bracket", task)
    assert [fault.split(":")[0] for fault in plan.faults] == list(OPEN)
    assert {severity for severity, _ in told_of_centre(task)} == {Severity.ERROR}
    ramped = measured("bracket", task, RAMP)
    assert [fault.split(":")[0] for fault in ramped.faults] == [OPEN[1]]


def test_a_user_may_let_it() -> None:
    task = OptimisationTask(centre_cutting={"END MILL 10MM": False}, allow_plunge=True)
    assert measured("bracket", task).faults == ()
    assert {severity for severity, _ in told_of_centre(task)} == {Severity.WARNING}
    for name in OPEN:
        told = (
            advice_of(measured("bracket", each), name) for each in (task, OptimisationTask())
        )
        one, other = (after(advice).setting for advice in told)
        assert one.plunge_feed == other.plunge_feed


def test_one_that_is_known_to_needs_no_word() -> None:
    assert told_of_centre(OptimisationTask(centre_cutting={"END MILL 10MM": True})) == []
