"""A stretch by time: which station holds, where powers are not smooth, how long it cuts."""

from collections.abc import Callable
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from simulator.machine.cutting import CuttingEdge
from simulator.machine.samples import ARC_STEP, EpisodeCourse
from simulator.machine.wear import Wear
from simulator.motion.control import ExactStop
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.segments import (
    ControlModel,
    Floats,
    Kinematics,
    Segments,
    arc,
    axis_limits,
    chained,
    lines,
)
from simulator.removal.stations import StationKind, Stations
from simulator.spec import Kienzle, Machine

PATH = chained([
    lines([(0, 0, 0), (10, 0, 0), (10, 0, 0)], speed=20.0),
    arc((10, 0, 0), (10, 5, 0), pi, speed=20.0),
])

Planned = Callable[..., EpisodeCourse]


def stations() -> Stations:
    """Air, 6 mm of cut, air; nothing; a cut on the arc."""
    count = 5
    nothing = np.zeros(count)
    return Stations(
        segment=np.array([0, 0, 0, 1, 2]),
        station=np.array([2.0, 8.0, 10.0, 0.0, 5.0 * pi]),
        kind=np.full(count, int(StationKind.MILLING)),
        section=np.array([0.0, 5.0, 0.0, 0.0, 5.0]),
        growth=np.zeros(5),
        axial_depth=nothing,
        radial_width=nothing,
        entry_angle=nothing,
        exit_angle=nothing,
        contact_angle=nothing,
        chip_ratio=nothing,
        diameter=nothing,
    )


@pytest.fixture
def planned(mill: Machine) -> Planned:
    def course(control: ControlModel | None = None, *, path: Segments = PATH) -> EpisodeCourse:
        return EpisodeCourse(
            segments=path,
            motion=(control or ExactStop()).plan(path, axis_limits(mill)),
            spindle_programmed=np.full(len(path), np.nan),
            stations=stations(),
            edge=CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=2000.0, m_c=0.0)),
            wear=Wear(),
        )

    return course


def at(segment: list[int], station: list[float]) -> Kinematics:
    nothing: Floats = np.zeros((len(segment), 3))
    return Kinematics(
        position=nothing,
        velocity=nothing,
        acceleration=nothing,
        segment=np.array(segment),
        station=np.array(station),
    )


def test_each_station_holds_for_the_stretch_before_it(planned: Planned) -> None:
    course = planned()
    found = course.stations_at(at([0, 0, 0, 0, 0, 2, 2], [0.0, 1.9, 2.1, 8.0, 9.0, 0.1, 15.7]))
    assert found.tolist() == [0, 0, 1, 1, 2, 4, 4]


def test_a_segment_that_has_just_begun_has_a_station_of_its_own(planned: Planned) -> None:
    """While the filter settles, the command stands where two segments meet."""
    course = planned()
    found = course.stations_at(at([0, 0, 1, 2], [0.0, 10.0, 0.0, 0.0]))
    assert found.tolist() == [0, 2, 3, 4]


@pytest.mark.parametrize(
    "control", [ExactStop(), FixedTimeFilter(first=0.06, second=0.02)], ids=["stop", "fir"]
)
def test_nodes_hold_every_change_of_station(planned: Planned, control: ControlModel) -> None:
    """Between two nodes, away from their ends, one station holds."""
    course = planned(control)
    nodes = course.nodes
    assert nodes[0] == 0.0
    assert nodes[-1] == pytest.approx(course.motion.duration)
    spans = np.diff(nodes)
    inside = nodes[:-1, None] + spans[:, None] * np.array([0.01, 0.99])
    rows = course.stations_at(course.motion.at(inside.ravel())).reshape(-1, 2)
    wrong = course.stations.section[rows[:, 0]] != course.stations.section[rows[:, 1]]
    assert spans[wrong].sum() < 0.003


def test_arcs_are_cut_where_their_axes_change(planned: Planned) -> None:
    course = planned()
    on_arc = course.motion.at(course.nodes)
    angle = on_arc.station[on_arc.segment == 2] / 5.0
    assert np.diff(angle).max() <= ARC_STEP * 1.1


def test_cutting_seconds_are_the_time_with_chips(planned: Planned) -> None:
    """6 mm at 20 mm/s in the middle of the line, then all of the arc from rest to rest."""
    arc_time = 5.0 * pi / 20.0 + 20.0 / 2000.0
    assert planned().cutting_seconds == pytest.approx(6.0 / 20.0 + arc_time, abs=2e-3)


def test_each_cut_knows_when_it_began(planned: Planned) -> None:
    """Where seconds with chips begin to count."""
    course = planned()
    times = np.linspace(0.0, course.motion.duration, 2001)
    seconds = np.interp(times, *course._cut_clock)
    began = course.entry_times(times)
    grows = np.diff(seconds) > 0.0
    first = times[1:][grows & ~np.concatenate(([False], grows[:-1]))]
    known = np.unique(began[began > 0.0])
    assert known == pytest.approx(first, abs=2.0 * times[1])
    assert (began <= times).all()


def test_wear_counts_time_with_chips(planned: Planned) -> None:
    course = replace(planned(), wear=Wear(flank=0.1, per_second=0.01))
    times = np.array([0.0, 0.1, course.motion.duration])
    seconds = np.array([0.0, 0.0, course.cutting_seconds])
    np.testing.assert_allclose(course.worn(times), 0.1 + 0.01 * seconds)
    constant = replace(course, wear=Wear(flank=0.1))
    np.testing.assert_allclose(constant.worn(times), 0.1)


@pytest.mark.parametrize("points", [[(0, 0, 0), (0, 0, 0)], [(0, 0, 0), (5, 0, 0)]])
def test_path_of_one_segment(
    mill: Machine, planned: Planned, points: list[tuple[int, int, int]]
) -> None:
    path = lines(points, speed=20.0)
    nothing = np.zeros(1)
    names = [
        "section",
        "axial_depth",
        "radial_width",
        "entry_angle",
        "exit_angle",
        "contact_angle",
        "growth",
    ]
    met = Stations(
        segment=np.array([0]),
        station=path.length,
        kind=np.array([int(StationKind.AIR)]),
        chip_ratio=nothing,
        diameter=nothing,
        **dict.fromkeys(names, nothing),
    )
    motion = ExactStop().plan(path, axis_limits(mill))
    course = EpisodeCourse(
        segments=path,
        motion=motion,
        spindle_programmed=np.array([np.nan]),
        stations=met,
        edge=None,
        wear=Wear(),
    )
    assert course.nodes[-1] == motion.duration
    assert course.cutting_seconds == 0.0
