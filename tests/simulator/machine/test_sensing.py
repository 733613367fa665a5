"""What the sensors show, at which times."""

from collections.abc import Callable
from dataclasses import fields, replace
from itertools import accumulate, pairwise
from math import ceil, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.cutting import CuttingEdge
from simulator.machine.samples import (
    Episode,
    EpisodeCourse,
    EpisodeState,
    Execution,
    PathMode,
    Samples,
    joined,
)
from simulator.machine.sensing import Sampler, sensed
from simulator.machine.spindle_course import ramped, standing
from simulator.machine.tooth_loads import ToothOptions
from simulator.machine.virtual import StockMap
from simulator.machine.wear import Wear
from simulator.motion.control import ExactStop
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.segments import ControlModel, Floats, arc, axis_limits, chained, lines
from simulator.removal.cutter import Cutter
from simulator.spec import Kienzle, Machine

Stocks = Callable[[], StockMap]

PATH = chained([
    lines([(0, 0, 5), (0, 0, 0)]),
    lines([(0, 0, 0), (40, 0, 0)], speed=20.0),
    arc((40, 0, 0), (40, 10, 0), pi, rise=2.0, speed=15.0),
    lines([(40, 20, 2), (40, 20, 2), (10, 5, 2)], speed=200.0),
])


def still(begin: float, end: float, execution: Execution = Execution.WAIT) -> Episode:
    return Episode(
        begin=begin,
        end=end,
        state=EpisodeState(execution=execution, line=3, tool=2, workingstep=1),
        spindle=standing(0.0, 10.0),
        position=np.array([1.0, 2.0, 3.0]),
    )


def moving(
    machine: Machine,
    stock: StockMap,
    *,
    begin: float = 0.0,
    control: ControlModel | None = None,
    teeth: ToothOptions | None = None,
) -> Episode:
    motion = (control or ExactStop()).plan(PATH, axis_limits(machine))
    stations = stock.cut(PATH, Cutter(diameter=10.0), is_clockwise=True)
    course = EpisodeCourse(
        segments=PATH,
        motion=motion,
        spindle_programmed=np.full(len(PATH), np.nan),
        stations=stations,
        edge=CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=2000.0, m_c=0.25)),
        wear=Wear(),
        teeth=teeth,
    )
    return Episode(
        begin=begin,
        end=begin + motion.duration,
        state=EpisodeState(execution=Execution.ACTIVE, line=0, spindle_programmed=50.0),
        spindle=standing(0.0, 50.0),
        position=PATH.start[0],
        course=course,
    )


def taken(episodes: list[Episode], machine: Machine, rate: float) -> Samples:
    sampler = Sampler(machine, rate=rate)
    return joined([part for episode in episodes for part in sampler.samples(episode)])


@settings(max_examples=100, deadline=None)
@given(
    spans=st.lists(st.floats(0.0, 3.0) | st.sampled_from([0.1, 0.01, 1e-12]), max_size=12),
    rate=st.sampled_from([1.0, 3.0, 10.0, 60.0, 250.0]) | st.floats(1.0, 100.0),
)
def test_every_sample_is_taken_once_whatever_the_episodes(
    mill: Machine, spans: list[float], rate: float
) -> None:
    edges = [0.0, *accumulate(spans)]
    episodes = [still(a, b) for a, b in pairwise(edges)]
    episodes.append(still(edges[-1], edges[-1], Execution.PROGRAM_COMPLETED))
    time = taken(episodes, mill, rate).time
    np.testing.assert_array_equal(time, np.arange(len(time)) / rate)
    # The last one is the first that is not before the end.
    assert edges[-1] - 1e-8 / rate <= time[-1] < edges[-1] + 1.0 / rate


@pytest.mark.parametrize("rate", [1.0, 10_000.0])
def test_least_and_greatest_rate(mill: Machine, rate: float) -> None:
    last = still(8.0, 8.0, Execution.PROGRAM_COMPLETED)
    samples = taken([still(0.0, 8.0), last], mill, rate)
    assert len(samples) == 8 * rate + 1
    assert samples.time[-1] == 8.0
    assert samples.execution[-1] == Execution.PROGRAM_COMPLETED
    assert (samples.execution[:-1] == Execution.WAIT).all()


def test_a_sample_at_the_edge_belongs_to_the_later_episode(mill: Machine) -> None:
    samples = taken(
        [still(0.0, 0.1 + 0.2), still(0.1 + 0.2, 1.0, Execution.ACTIVE)], mill, 10.0
    )
    assert samples.execution.tolist() == [Execution.WAIT] * 3 + [Execution.ACTIVE] * 7


def test_standing_machine(mill: Machine) -> None:
    samples = sensed(still(0.0, 1.0), mill, np.array([0.0, 0.5]))
    assert samples.position.tolist() == [[1.0, 2.0, 3.0]] * 2
    assert not samples.velocity.any()
    assert samples.path_mode.tolist() == [PathMode.NONE] * 2
    assert samples.line.tolist() == [3, 3]
    np.testing.assert_allclose(samples.spindle_power, 100.0 + 20.0 + 1.0)
    np.testing.assert_allclose(samples.total_power, 300.0 + 121.0)


def test_positions_are_the_integral_of_velocities(mill: Machine, even_stock: Stocks) -> None:
    episode = moving(mill, even_stock(), begin=2.0)
    assert episode.course is not None
    shown = np.arange(2.0, episode.end, 0.01)
    knots = np.unique(np.concatenate((shown, 2.0 + episode.course.motion.knots)))
    knots = np.unique(np.concatenate([knots[:-1] + np.diff(knots) * k / 8 for k in range(8)]))
    knots = np.append(knots, episode.end)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = 0.5 * np.diff(knots)
    times = ((knots[:-1] + half)[:, None] + half[:, None] * nodes).ravel()
    velocity = sensed(episode, mill, times).velocity.reshape(-1, len(nodes), 3)
    way = np.cumsum(np.einsum("k,n,kna->ka", half, weights, velocity), axis=0)
    position = sensed(episode, mill, knots).position
    np.testing.assert_allclose(position[0] + way, position[1:], rtol=0, atol=1e-9)
    np.testing.assert_allclose(position[-1], PATH.end[-1], atol=1e-9)


@pytest.mark.parametrize(
    "control", [ExactStop(), FixedTimeFilter(first=0.08, second=0.03)], ids=["stop", "fir"]
)
def test_common_times_show_the_same_at_any_rate(
    mill: Machine, even_stock: Stocks, control: ControlModel
) -> None:
    episode = moving(mill, even_stock(), control=control, teeth=ToothOptions(eccentricity=0.01))
    coarse = taken([episode], mill, 10.0)
    fine = taken([episode], mill, 1000.0)
    for each in fields(Samples):
        one, other = getattr(coarse, each.name), getattr(fine, each.name)[::100]
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12)


def test_mode_feed_and_line_are_those_of_the_segment(mill: Machine, even_stock: Stocks) -> None:
    episode = moving(mill, even_stock())
    assert episode.course is not None
    ends = episode.course.motion.ends
    samples = sensed(episode, mill, np.array([0.5 * ends[0], ends[0] + 0.5, ends[1] + 0.5]))
    assert samples.path_mode.tolist() == [PathMode.RAPID, PathMode.FEED, PathMode.FEED]
    assert samples.feed_programmed.tolist() == [0.0, 20.0, 15.0]
    assert samples.line.tolist() == [0, 1, 2]
    np.testing.assert_allclose(samples.path_speed[1:], [20.0, 15.0])
    # k_c = 2000·h^(−1/4) at f_z = 0.2 mm in a slot, h_m = 0.2·2/π; 20 mm² at 20 mm/s.
    chip = 0.2 * 2.0 / pi
    assert samples.cutting_power[1] == pytest.approx(2000.0 * chip**-0.25 * 0.4)
    assert samples.chip_thickness[1] == pytest.approx(chip)
    assert samples.cutting_power[0] == 0.0


def test_forces_of_teeth_have_the_power_of_the_mean(mill: Machine, even_stock: Stocks) -> None:
    times: Floats = np.linspace(0.5, 1.5, 400)
    mean = sensed(moving(mill, even_stock()), mill, times)
    tooth = sensed(moving(mill, even_stock(), teeth=ToothOptions()), mill, times)
    np.testing.assert_array_equal(tooth.cutting_power, mean.cutting_power)
    assert tooth.cutting_force.max() > 1.3 * mean.cutting_force.max()


def test_spindle_ramp_shows_during_a_move(mill: Machine, even_stock: Stocks) -> None:
    episode = moving(mill, even_stock())
    ramp = ramped(standing(0.0), 0.0, 50.0, acceleration=50.0)
    shown = sensed(replace(episode, spindle=ramp), mill, np.array([0.25, 0.5]))
    assert shown.spindle_speed.tolist() == [12.5, 25.0]
    # J·(2π)²·α·n = 0.01·4π²·50·n, over η = 0.8, and the idle power.
    wanted = 0.01 * 4.0 * pi**2 * 50.0 * 12.5 / 0.8 + 100.0 + 25.0 + 0.01 * 12.5**2
    assert shown.spindle_power[0] - shown.cutting_power[0] / 0.8 == pytest.approx(wanted)


def test_long_episodes_come_in_parts(mill: Machine) -> None:
    parts = list(Sampler(mill, rate=10_000.0).samples(still(0.0, 20.0)))
    assert len(parts) == ceil(200_000 / 65_536)
    assert sum(map(len, parts)) == 200_000
