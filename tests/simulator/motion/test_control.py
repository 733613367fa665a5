import pytest

from simulator.motion.control import DEVIATION, ExactStop, JunctionDeviation, control_model
from simulator.motion.fir import FilterWithinLimits
from simulator.motion.linuxcnc_planner import LinuxCncPlanner
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import AxisLimits, lines
from simulator.planner_settings import PlannerSettings


def test_names_are_those_of_the_command_line() -> None:
    assert [str(each) for each in ControlModelName] == [
        "exact-stop",
        "junction",
        "fir",
        "linuxcnc",
    ]


def test_each_name_gives_its_model(limits: AxisLimits) -> None:
    assert control_model(ControlModelName.EXACT_STOP, limits) == ExactStop()
    assert control_model(ControlModelName.JUNCTION, limits) == JunctionDeviation(
        deviation=DEVIATION
    )
    assert control_model(ControlModelName.FIR, limits) == FilterWithinLimits()
    planner = PlannerSettings(max_feed_override=2.0)
    found = control_model(ControlModelName.LINUXCNC, limits, planner=planner)
    assert found == LinuxCncPlanner(settings=planner)


def test_deviation_is_handed_on(limits: AxisLimits) -> None:
    model = control_model(ControlModelName.JUNCTION, limits, deviation=0.5)
    assert model == JunctionDeviation(deviation=0.5)
    with pytest.raises(ValueError, match="junction deviation"):
        control_model(ControlModelName.JUNCTION, limits, deviation=0.0)


@pytest.mark.parametrize("control", ControlModelName)
def test_every_model_refuses_a_path_without_segments(
    control: ControlModelName, limits: AxisLimits
) -> None:
    with pytest.raises(ValueError, match="at least one segment"):
        control_model(control, limits).plan(lines([(0, 0, 0)]), limits)


@pytest.mark.parametrize("control", ControlModelName)
def test_every_model_ends_at_rest_where_the_path_ends(
    control: ControlModelName, limits: AxisLimits
) -> None:
    path = lines([(0, 0, 0), (5, 0, 0), (5, 7, -2)], speed=25.0)
    motion = control_model(control, limits).plan(path, limits)
    end = motion.at(motion.ends[-1:])
    assert end.position[0] == pytest.approx([5.0, 7.0, -2.0], abs=1e-9)
    assert end.velocity[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    assert motion.knots[0] == 0.0
    assert motion.knots[-1] == motion.duration == motion.ends[-1]
