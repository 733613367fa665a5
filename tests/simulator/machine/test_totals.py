"""Time, energy and peaks, against closed forms."""

from collections.abc import Callable
from dataclasses import fields, replace
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from simulator.library import load_machine, load_material
from simulator.machine.cutting import CuttingEdge
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode, EpisodeCourse, EpisodeState, Execution
from simulator.machine.sensing import axes_power
from simulator.machine.spindle_course import SpindleCourse, ramped, standing
from simulator.machine.tooling import loaded_tool
from simulator.machine.totals import Energy, Peak, Total, added
from simulator.machine.virtual import MachineSetup, StockMap, VirtualMachine
from simulator.machine.wear import Wear
from simulator.motion.control import ExactStop
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.segments import ControlModel, Segments, arc, axis_limits, lines
from simulator.physics.flutes import CuttingEdges
from simulator.physics.spindle import spindle_power
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stations import StationKind, air
from simulator.spec import Kienzle, Machine, MachineKind
from stepnc_model.post.neutral import blocks_of, tool_numbers
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.toolpath.task import stock_of

PARTS = Path(__file__).parents[3] / "examples" / "parts"

Stocks = Callable[[], StockMap]


def still(
    begin: float, end: float, *, spindle: SpindleCourse | None = None, coolant: bool = False
) -> Episode:
    return Episode(
        begin=begin,
        end=end,
        state=EpisodeState(execution=Execution.WAIT, line=1, coolant_on=coolant),
        spindle=spindle or standing(0.0),
        position=np.zeros(3),
    )


def moving(
    machine: Machine,
    path: Segments,
    *,
    stock: StockMap | None = None,
    spindle: SpindleCourse | None = None,
    control: ControlModel | None = None,
) -> Episode:
    motion = (control or ExactStop()).plan(path, axis_limits(machine))
    stations = air(np.arange(len(path)), path.length)
    if stock is not None:
        stations = stock.cut(path, Cutter(diameter=10.0), is_clockwise=True)
    course = EpisodeCourse(
        segments=path,
        motion=motion,
        spindle_programmed=np.full(len(path), np.nan),
        stations=stations,
        edge=CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=2000.0, m_c=0.0)),
        wear=Wear(),
    )
    return Episode(
        begin=0.0,
        end=motion.duration,
        state=EpisodeState(execution=Execution.ACTIVE, line=0),
        spindle=spindle or standing(0.0),
        position=path.start[0],
        course=course,
    )


def axes(energy: Energy) -> float:
    return energy.x_axis + energy.y_axis + energy.z_axis


def test_wait_draws_constant_power(mill: Machine) -> None:
    found = added(Total(), still(3.0, 13.0, coolant=True), mill)
    assert found.duration == 10.0
    assert found.energy == Energy(coolant=2000.0, base=3000.0)
    assert found.energy.total == 5000.0
    assert found.cutting_time == found.rapid_time == found.volume == 0.0
    assert found.waiting_time == 10.0
    assert found.air_time == 0.0


def test_rapid_has_the_energy_of_the_reference() -> None:
    """100 mm at 16 m/min on the machine of 2018: 0.41944 s, 55.08 J of the axis."""
    machine = load_machine("paper003")
    found = added(Total(), moving(machine, lines([(0, 0, 0), (100, 0, 0)])), machine)
    assert found.duration == pytest.approx(0.41944, abs=1e-5)
    assert found.rapid_time == pytest.approx(0.41944, abs=1e-5)
    assert found.energy.x_axis == pytest.approx(55.08, rel=1e-3)
    assert found.energy.y_axis == found.energy.z_axis == 0.0
    assert found.energy.base == pytest.approx(370.0 * found.duration)


@pytest.mark.parametrize(
    ("feed_mm_min", "seconds", "joules"), [(124.46, 48.980, 21.13), (88.9, 68.572, None)]
)
def test_feed_has_the_energy_of_the_reference(
    feed_mm_min: float, seconds: float, joules: float | None
) -> None:
    """101.6 mm of slot, cases 1 and 2 of 2018, without its cut."""
    machine = load_machine("paper003")
    path = lines([(0, 0, 0), (101.6, 0, 0)], speed=feed_mm_min / 60)
    found = added(Total(), moving(machine, path), machine)
    assert found.duration == pytest.approx(seconds, rel=1e-4)
    if joules is not None:
        assert found.energy.x_axis == pytest.approx(joules, rel=1e-3)


def test_spindle_ramp_has_the_energy_of_the_reference() -> None:
    """0 to 1750 rpm at 10 rev/s²: 2.9167 s, 6060.3 W at its end, 8396 J over η = 0.95."""
    machine = load_machine("paper003")
    spindle = replace(machine.spindle, idle_power=0.0)
    course = ramped(standing(0.0), 1.0, 1750 / 60, acceleration=10.0)
    found = added(
        Total(),
        still(0.0, 5.0, spindle=course),
        replace(machine, spindle=replace(spindle, efficiency=1.0)),
    )
    assert found.energy.spindle == pytest.approx(8396.0, rel=1e-3)
    assert found.power.value == pytest.approx(31.416 * 183.26, rel=1e-3)
    assert found.power.time == pytest.approx(1.0 + 2.91667, rel=1e-5)
    lossy = added(Total(), still(0.0, 5.0, spindle=course), machine)
    assert lossy.energy.spindle == pytest.approx(8396.0 / 0.95, rel=1e-3)


def drawn(machine: Machine, course: SpindleCourse, begin: float, end: float) -> float:
    """Energy of the spindle by midpoints between the knots of its course, J.

    A piece of 12 s errs by 0.03 J at most at a corner of the power (3000 W/s), and by as much
    where it is curved; an adaptive rule does not get to its end at some corners.
    """
    inside = course.times[(course.times > begin) & (course.times < end)]
    whole = 0.0
    for start, stop in pairwise([begin, *inside.tolist(), end]):
        step = (stop - start) / 4096
        times = start + step * (np.arange(4096) + 0.5)
        power = spindle_power(machine.spindle, course.speed(times), course.acceleration(times))
        whole += step * float(np.sum(power))
    return whole


@settings(max_examples=25, deadline=None)
@given(
    first=st.floats(-200.0, 200.0),
    second=st.floats(-200.0, 200.0),
    at=st.floats(0.1, 6.0),
    cuts=st.lists(st.floats(0.01, 11.9), max_size=4),
)
def test_ramps_over_several_episodes_have_the_energy_of_the_course(
    mill: Machine, first: float, second: float, at: float, cuts: list[float]
) -> None:
    """Through zero, interrupted, wherever the episodes end."""
    course = ramped(standing(0.0, first), at, second, acceleration=50.0)
    edges = [0.0, *sorted(cuts), 12.0]
    total = Total()
    for begin, end in pairwise(edges):
        total = added(total, still(begin, end, spindle=course), mill)
    wanted = drawn(mill, course, 0.0, 12.0)
    assert total.energy.spindle == pytest.approx(wanted, rel=2e-4, abs=0.5)
    assert total.duration == pytest.approx(12.0)
    assert total.energy.base == pytest.approx(3600.0)


def test_stopping_draws_only_what_friction_needs_more(mill: Machine) -> None:
    """``∫ max(0, η·P_idle − J·4π²·α·n) dt/η``, no power comes back."""
    course = ramped(standing(0.0, 100.0), 0.0, 0.0, acceleration=50.0)
    found = added(Total(), still(0.0, 2.0, spindle=course), mill)

    def power(speed: float) -> float:
        friction = 0.8 * (100.0 + 2.0 * speed + 0.01 * speed**2)
        return max(0.0, friction - 0.01 * 4.0 * pi**2 * 50.0 * speed) / 0.8

    wanted = quad(power, 0.0, 10.0, points=[4.4])[0] / 50.0
    # Where it begins lies within one of the pieces into which a ramp is cut.
    assert found.energy.spindle == pytest.approx(wanted, abs=0.1)


def test_cut_has_its_volume_power_and_peaks(mill: Machine, even_stock: Stocks) -> None:
    """20 mm² along 60 mm at 2000 N/mm²: 2400 J; at 20 mm/s and 50 rev/s 800 W, 509.3 N."""
    path = lines([(0, 0, 0), (60, 0, 0)], speed=20.0)
    found = added(
        Total(), moving(mill, path, stock=even_stock(), spindle=standing(0.0, 50.0)), mill
    )
    assert found.volume == pytest.approx(1200.0)
    assert found.cutting_energy == pytest.approx(2400.0)
    assert found.cutting_time == pytest.approx(found.duration)
    assert found.force.value == pytest.approx(509.296, rel=1e-6)
    assert found.chip.value == pytest.approx(20.0 / 100.0 * 2.0 / pi)
    assert found.power.value == pytest.approx(1000.0 + 225.0)
    assert found.energy.spindle == pytest.approx(3000.0 + 225.0 * found.duration)
    assert found.overload_time == 0.0


def test_peak_of_a_short_cut_is_at_its_greatest_speed(
    mill: Machine, even_stock: Stocks
) -> None:
    """2 mm at 2000 mm/s² never reaches 150 mm/s: √(a·L) = 63.25 mm/s."""
    path = lines([(0, 0, 0), (2, 0, 0)], speed=150.0)
    episode = moving(mill, path, stock=even_stock(), spindle=standing(0.0, 50.0))
    found = added(Total(), episode, mill)
    assert found.chip.value == pytest.approx(63.2456 / 100.0 * 2.0 / pi, rel=1e-5)
    assert found.volume == pytest.approx(40.0)


def test_overload_is_timed(mill: Machine, even_stock: Stocks) -> None:
    """1225 W against the 1000 W of a weaker motor, all of the steady cut."""
    weak = replace(mill, max_cutting_force=400.0)
    path = lines([(0, 0, 0), (60, 0, 0)], speed=20.0)
    episode = moving(mill, path, stock=even_stock(), spindle=standing(0.0, 50.0))
    # 20 mm/s have 509 N; 400 N are passed at 15.7 mm/s of the ramps of 10 ms.
    found = added(Total(), episode, weak)
    assert found.overload_time == pytest.approx(found.duration - 0.02, abs=0.02)


def test_axes_of_an_arc_have_the_energy_of_fine_quadrature(mill: Machine) -> None:
    path = arc((20, 0, 0), (0, 0, 0), 1.7 * pi, rise=5.0, speed=30.0)
    episode = moving(mill, path)
    found = added(Total(), episode, mill)
    times = (np.arange(200_000) + 0.5) / 200_000 * episode.end
    course = episode.course
    assert course is not None
    at = course.motion.at(times)
    power = axes_power(mill, at.velocity, at.acceleration, feed_force=np.zeros(len(times)))
    wanted = power.mean(axis=0) * episode.end
    energy = [found.energy.x_axis, found.energy.y_axis, found.energy.z_axis]
    assert energy == pytest.approx(wanted.tolist(), rel=1e-3)


def test_drive_and_edge_have_peaks_of_their_own(mill: Machine, even_stock: Stocks) -> None:
    """800 W at the edge; a spindle that runs up before the cut draws more, without chips."""
    path = lines([(0, 0, 0), (60, 0, 0)], speed=20.0)
    spindle = standing(0.0, 50.0)
    found = added(Total(), moving(mill, path, stock=even_stock(), spindle=spindle), mill)
    assert found.cutting_power.value == pytest.approx(800.0)
    assert found.drive_power.value == pytest.approx(found.power.value)
    course = ramped(standing(0.0), 0.0, 100.0, acceleration=50.0)
    running = added(found, still(0.0, 2.0, spindle=course), mill)
    assert running.power.value > 2.0 * found.power.value
    assert running.drive_power == found.drive_power
    assert running.cutting_power == found.cutting_power


def test_plunges_of_a_mill_have_thrust_and_no_part_in_its_force(
    mill: Machine, even_stock: Stocks
) -> None:
    """One stock by two tools: of a drill the force counts, of a mill that sinks it does not."""
    path = lines([(0, 0, 60), (0, 0, 0)], speed=20.0)
    whole = moving(mill, path, stock=even_stock(), spindle=standing(0.0, 50.0))
    course = whole.course
    assert course is not None
    assert course.edge is not None
    stations = course.stations
    sunk = replace(stations, kind=np.full(len(stations), int(StationKind.DRILLING)))
    sinking = replace(course, stations=sunk)
    flutes = CuttingEdges(teeth=2, diameter=10.0)
    as_mill = replace(sinking, edge=replace(course.edge, flutes=flutes))
    drilled = added(Total(), replace(whole, course=sinking), mill)
    plunged = added(Total(), replace(whole, course=as_mill), mill)
    assert drilled.thrust.value == plunged.thrust.value > 0.0
    assert drilled.force.value > plunged.force.value == 0.0
    assert drilled.cutting_power == plunged.cutting_power
    assert added(Total(), whole, mill).thrust.value == 0.0


def test_the_way_is_what_comes_before_the_path_and_after_it(mill: Machine) -> None:
    path = lines([(0, 0, 0), (30, 0, 0), (60, 0, 0)], speed=20.0)
    whole = moving(mill, path)
    course = whole.course
    assert course is not None
    assert added(Total(), whole, mill).way_time == 0.0
    first = replace(whole, course=replace(course, way=1))
    assert added(Total(), first, mill).way_time == pytest.approx(course.motion.ends[0])
    last = replace(whole, course=replace(course, way=1, back=1))
    assert added(Total(), last, mill).way_time == pytest.approx(whole.end)
    home = replace(whole, course=replace(course, back=1))
    left = whole.end - course.motion.ends[0]
    assert added(Total(), home, mill).way_time == pytest.approx(left)
    waiting = still(0.0, 3.0)
    assert added(Total(), waiting, mill).way_time == 0.0
    on_way = replace(waiting, state=replace(waiting.state, is_way=True))
    both = added(added(Total(), on_way, mill), first, mill)
    assert both.way_time == pytest.approx(3.0 + course.motion.ends[0])
    assert both.plus(both).way_time == pytest.approx(2.0 * both.way_time)


def test_totals_add_and_keep_the_greater_peaks() -> None:
    one = Total(duration=1.0, power=Peak(value=5.0, time=1.0, line=2), volume=3.0)
    two = Total(duration=2.0, power=Peak(value=7.0, time=4.0, line=9), volume=4.0)
    both = one.plus(two)
    assert both == two.plus(one)
    assert (both.duration, both.volume, both.power.line) == (3.0, 7.0, 9)


@given(st.lists(st.floats(0.0, 1e6), min_size=12, max_size=12))
def test_energies_of_components_sum_to_the_total(values: list[float]) -> None:
    names = [each.name for each in fields(Energy)]
    one = Energy(**dict(zip(names, values[:6], strict=True)))
    two = Energy(**dict(zip(names, values[6:], strict=True)))
    assert (one + two).total == pytest.approx(sum(values))


def test_split_path_has_the_totals_of_the_whole(mill: Machine, even_stock: Stocks) -> None:
    """Pieces of one block that goes straight on are one move."""
    whole = lines([(0, 0, 0), (60, 30, 0)], speed=20.0)
    cut = lines([(0, 0, 0), (13, 6.5, 0), (40, 20, 0), (60, 30, 0)], speed=20.0)
    cut = replace(cut, block=np.zeros(3, dtype=np.int64))
    spindle = standing(0.0, 50.0)
    one, other = (
        added(Total(), moving(mill, path, stock=even_stock(), spindle=spindle), mill)
        for path in (whole, cut)
    )
    assert other.duration == pytest.approx(one.duration)
    assert axes(other.energy) == pytest.approx(axes(one.energy), rel=1e-9)
    assert other.energy.total == pytest.approx(one.energy.total, rel=1e-9)
    assert other.volume == pytest.approx(one.volume, rel=1e-9)


def ran(name: str, control: ControlModel, *, cell: float | None = None) -> tuple[Total, float]:
    """Totals of an example, and what its map lost."""
    program = Program.load(PARTS / f"{name}.stpnc")
    items = list(generate(program))
    paths = [item for item in items if isinstance(item, ToolPath)]
    is_turning = any(path.is_turning for path in paths)
    machine = load_machine("lathe22" if is_turning else "vmc15")
    setups = {step.id: step.setup for step in program.workingsteps}
    maps: dict[object, MillingStock | TurningStock] = {}

    def clamped(workingstep: str) -> StockMap | None:
        setup = setups.get(workingstep)
        raw = None if setup is None else stock_of(program, setup)
        if raw is None:
            return None
        if setup not in maps:
            is_lathe = machine.kind is MachineKind.LATHE
            maps[setup] = TurningStock(raw) if is_lathe else MillingStock(raw, cell=cell)
        return maps[setup]

    material = load_material("c45")
    tools = {
        number: loaded_tool(program, ref, number, material)
        for ref, number in tool_numbers(paths).items()
    }
    setup = MachineSetup(machine=machine, control=control, tools=tools, stock=clamped)
    blocks = enumerate(blocks_of(program, items, name=name), 1)
    total = Total()
    for episode in VirtualMachine(setup).run(interpret(blocks, machine)):
        total = added(total, episode, machine)
    lost = 0.0
    for key, left in maps.items():
        if isinstance(left, MillingStock):
            lost += left.volume
        else:
            raw = stock_of(program, key)  # type: ignore[arg-type]
            assert raw is not None
            assert raw.radius is not None
            lost += pi * raw.radius**2 * (raw.high[2] - raw.low[2]) - left.volume
    return total, lost


@pytest.mark.parametrize(
    ("name", "cell", "tolerance"),
    [
        ("paper000", None, 1e-3),
        ("paper002", None, 1e-3),
        # Exact arcs beside a map whose cells do not fit the narrow slot.
        ("paper003_case1", None, 1e-2),
        ("shaft", None, 1e-3),
        # Sections are exact: the map's own error of 0.3 % needs finer cells.
        ("bracket", 0.2, 5e-4),
    ],
)
def test_removal_rate_adds_up_to_what_the_map_lost(
    name: str, cell: float | None, tolerance: float
) -> None:
    total, lost = ran(name, ExactStop(), cell=cell)
    assert total.volume == pytest.approx(lost, rel=tolerance)
    assert total.energy.total > total.cutting_energy > 0.0


def test_smoothed_path_removes_a_little_less() -> None:
    """The filter cuts corners short, and with them the way of the tool."""
    total, lost = ran("shaft", FixedTimeFilter(first=0.05, second=0.02))
    assert total.volume == pytest.approx(lost, rel=1e-2)
    assert total.volume <= lost * (1.0 + 1e-3)
