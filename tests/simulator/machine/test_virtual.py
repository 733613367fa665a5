"""A machine that runs a program."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from math import pi

import numpy as np
import pytest

from simulator.errors import OutOfTravel, ProgramFault, UnknownTool
from simulator.machine.cutting import CuttingEdge
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode, Execution, Samples, joined
from simulator.machine.sensing import Sampler, sensed
from simulator.machine.travel import Zero
from simulator.machine.virtual import LoadedTool, MachineSetup, Shape, StockMap, VirtualMachine
from simulator.motion.control import ExactStop
from simulator.motion.linuxcnc_planner import LinuxCncPlanner
from simulator.physics.tool_life import LIFE_CRITERION
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.removal.engage import MillingStock
from simulator.spec import Kienzle, Machine, Taylor
from stepnc_model.post import blocks as nc
from stepnc_model.programs.program import Stock
from tests.oracles.motion import move_time

FEED = nc.Rate(value=20.0)
HOME = nc.Rapid(end=(0.0, 0.0, 50.0))
DOWN = nc.Rapid(end=(0.0, 0.0, 0.0))
CUT = nc.Linear(end=(100.0, 0.0, 0.0), rate=FEED)
ON, OFF = nc.SpindleOn(speed=50.0), nc.SpindleOff()
FLOOD = nc.Coolant(kinds=frozenset({nc.CoolantKind.FLOOD}))

MILL = Cutter(diameter=10.0)

Stocks = Callable[[], StockMap]


def tool(
    number: int, shape: Shape | None = MILL, *, taylor: Taylor | None = None
) -> LoadedTool:
    edge = CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=2000.0, m_c=0.0))
    return LoadedTool(number=number, id=f"TOOL {number}", shape=shape, edge=edge, taylor=taylor)


@dataclass(frozen=True)
class Ran:
    virtual: VirtualMachine
    episodes: list[Episode]

    @property
    def time(self) -> float:
        return self.episodes[-1].end

    @property
    def messages(self) -> list[str]:
        return [finding.message for finding in self.virtual.findings]

    def at(self, machine: Machine, *times: float) -> Samples:
        parts = [
            sensed(
                next(e for e in self.episodes if e.begin <= t < e.end), machine, np.array([t])
            )
            for t in times
        ]
        return joined(parts)


def run(
    machine: Machine,
    *blocks: nc.Block,
    tools: Mapping[int, LoadedTool] | None = None,
    stock: StockMap | None = None,
    zero: Zero | None = None,
) -> Ran:
    setup = MachineSetup(
        machine=machine, control=ExactStop(), tools=tools, stock=lambda _: stock, zero=zero
    )
    virtual = VirtualMachine(setup)
    return Ran(virtual, list(virtual.run(interpret(enumerate(blocks, 1), machine))))


def test_program_without_moves_ends(mill: Machine) -> None:
    assert run(mill).time == 0.0
    found = run(mill, ON, nc.Pause(seconds=2.0), nc.ProgramEnd())
    # 2 s of dwell, in which the spindle reaches 50 rev/s, and 1 s to stop it.
    assert found.time == pytest.approx(3.0)
    assert found.episodes[-1].state.execution is Execution.PROGRAM_COMPLETED
    assert found.episodes[-1].position.tolist() == [0.0, 0.0, 0.0]


def test_machine_stands_where_the_first_move_begins(mill: Machine) -> None:
    found = run(mill, nc.ToolChange(number=1), nc.Retract(z=60.0), HOME, DOWN)
    assert found.episodes[0].position.tolist() == [0.0, 0.0, 60.0]
    assert found.time == pytest.approx(
        3.0
        + move_time(10.0, speed=400.0, acceleration=2000.0)
        + move_time(50.0, speed=400.0, acceleration=2000.0)
    )


def test_episodes_follow_without_a_gap(mill: Machine) -> None:
    found = run(mill, HOME, ON, DOWN, CUT, nc.Pause(seconds=1.0), HOME, OFF, nc.ProgramEnd())
    begins = [episode.begin for episode in found.episodes]
    assert begins == [0.0, *(episode.end for episode in found.episodes[:-1])]


def test_rapid_goes_while_the_spindle_speeds_up_and_the_feed_waits(mill: Machine) -> None:
    found = run(mill, HOME, ON, DOWN, CUT)
    rapid, wait, cut, end = found.episodes
    down = move_time(50.0, speed=400.0, acceleration=2000.0)
    assert rapid.end == pytest.approx(down)
    assert wait.state.execution is Execution.WAIT
    assert wait.end == pytest.approx(1.0)
    assert cut.end == end.begin == pytest.approx(1.0 + 100.0 / 20.0 + 20.0 / 2000.0)


def test_states_by_time(mill: Machine) -> None:
    found = run(
        mill,
        nc.Comment(text="", workingstep="ONE"),
        nc.ToolChange(number=4),
        ON,
        FLOOD,
        HOME,
        DOWN,
        CUT,
        nc.Comment(text="", workingstep="TWO"),
        nc.Coolant(),
        nc.SpindleOn(speed=25.0, sense=nc.SpindleDirection.COUNTERCLOCKWISE),
        nc.Linear(end=(0.0, 0.0, 0.0), rate=FEED),
        nc.ProgramEnd(),
    )
    assert found.virtual.workingsteps == ["ONE", "TWO"]
    ends = [episode.end for episode in found.episodes]
    during = [0.5 * (e.begin + e.end) for e in found.episodes if e.end > e.begin]
    samples = found.at(mill, *during)
    # Tool change, rapid down, wait, cut; reversal, cut, stop.
    assert samples.tool.tolist() == [0, 4, 4, 4, 4, 4, 4]
    assert samples.workingstep.tolist() == [1, 1, 1, 1, 2, 2, 2]
    assert samples.coolant.tolist() == [0, 1, 1, 1, 0, 0, 0]
    assert samples.coolant_power.tolist() == [0, 200, 200, 200, 0, 0, 0]
    assert samples.base_power.tolist() == [300.0] * 7
    assert samples.line.tolist() == [2, 6, 7, 7, 11, 11, 12]
    assert samples.spindle_programmed.tolist() == [0, 50, 50, 50, -25, -25, 0]
    assert samples.execution.tolist() == [
        Execution.WAIT,
        Execution.ACTIVE,
        Execution.WAIT,
        Execution.ACTIVE,
        Execution.WAIT,
        Execution.ACTIVE,
        Execution.WAIT,
    ]
    assert ends[0] == 3.0
    assert ends[4] - ends[3] == pytest.approx(75.0 / 50.0)


def test_program_stop_shows_as_stopped(mill: Machine) -> None:
    found = run(mill, HOME, ON, DOWN, CUT, OFF, nc.ProgramStopBlock(), nc.ProgramEnd())
    stopped = [e for e in found.episodes if e.state.execution is Execution.PROGRAM_STOPPED]
    assert [e.end - e.begin for e in stopped] == [pytest.approx(1.0)]


def test_tool_change_waits_for_the_spindle_and_the_same_tool_takes_no_time(
    mill: Machine,
) -> None:
    change = nc.ToolChange(number=1)
    found = run(
        mill, change, change, ON, HOME, nc.Pause(seconds=1.0), OFF, nc.ToolChange(number=2)
    )
    assert found.time == pytest.approx(3.0 + 1.0 + 1.0 + 3.0)


def test_unknown_tool_names_the_line_and_what_is_known(mill: Machine) -> None:
    with pytest.raises(UnknownTool, match=r"line 2: tool T9 .*known: T1, T3") as caught:
        run(mill, HOME, nc.ToolChange(number=9), tools={3: tool(3), 1: tool(1)})
    assert (caught.value.number, caught.value.line) == (9, 2)


def test_tool_zero_empties_the_spindle_and_a_feed_without_a_tool_is_said(
    mill: Machine, even_stock: Stocks
) -> None:
    empty = nc.ToolChange(number=0)
    blocks = (empty, nc.ToolChange(number=1), empty, HOME, DOWN, ON, CUT)
    found = run(mill, *blocks, tools={1: tool(1)}, stock=even_stock())
    assert found.messages == ["feed move without a tool: no material is removed"]
    assert [finding.line for finding in found.virtual.findings] == [7]
    samples = found.at(mill, 1.0, 4.0, found.time - 2.0)
    assert samples.tool.tolist() == [0, 1, 0]
    assert samples.cutting_power.tolist() == [0.0] * 3


def test_off_travel_names_axis_position_and_line(mill: Machine) -> None:
    with pytest.raises(OutOfTravel) as caught:
        run(mill, HOME, DOWN, CUT, zero=(450.0, 0.0, 0.0))
    assert (caught.value.axis, caught.value.position, caught.value.line) == ("X", 100.0, 3)
    assert run(mill, HOME, DOWN, CUT, zero=None).time > 0.0


def test_axis_that_the_machine_has_not(lathe: Machine) -> None:
    with pytest.raises(ProgramFault, match="line 2: move along Y"):
        run(lathe, HOME, nc.Rapid(end=(0.0, 10.0, 50.0)))


def test_turning_tool_on_a_mill(mill: Machine, even_stock: Stocks) -> None:
    with pytest.raises(ProgramFault, match="line 4: T1 TOOL 1 is a turning tool"):
        run(
            mill,
            nc.ToolChange(number=1),
            ON,
            HOME,
            DOWN,
            CUT,
            tools={1: tool(1, Insert())},
            stock=even_stock(),
        )


def test_spindle_faster_than_the_machine_is_clamped_and_said_once(mill: Machine) -> None:
    fast = nc.SpindleOn(speed=500.0)
    found = run(mill, HOME, fast, DOWN, CUT, OFF, fast, nc.Pause(seconds=8.0))
    assert found.messages == ["spindle speed 30000 rpm exceeds 12000 rpm: 12000 rpm used"]
    assert [finding.line for finding in found.virtual.findings] == [2]
    cut = next(e for e in found.episodes if e.course is not None and e.state.line == 5)
    assert cut.begin == pytest.approx(200.0 / 50.0)
    assert found.at(mill, cut.begin + 1.0).spindle_speed.tolist() == [200.0]


def cutting(mill: Machine, even_stock: Stocks, *blocks: nc.Block, loaded: LoadedTool) -> Ran:
    return run(
        mill,
        nc.ToolChange(number=loaded.number),
        *blocks,
        tools={loaded.number: loaded},
        stock=even_stock(),
    )


def test_force_of_a_cut(mill: Machine, even_stock: Stocks) -> None:
    """20 mm² at 20 mm/s and 2000 N/mm²: 800 W; over π·10 mm·50 rev/s: 509.3 N."""
    found = cutting(mill, even_stock, ON, HOME, DOWN, CUT, loaded=tool(1))
    samples = found.at(mill, found.time - 2.0)
    assert samples.cutting_power[0] == pytest.approx(800.0)
    assert samples.cutting_force[0] == pytest.approx(509.296, rel=1e-6)
    assert samples.removal_rate[0] == pytest.approx(400.0)
    assert samples.spindle_power[0] == pytest.approx(1000.0 + 100.0 + 100.0 + 25.0)
    assert (samples.axial_depth[0], samples.radial_width[0]) == (2.0, 10.0)
    assert not found.messages


def test_cutting_with_a_standing_spindle_is_said(mill: Machine, even_stock: Stocks) -> None:
    found = cutting(mill, even_stock, HOME, DOWN, CUT, CUT, loaded=tool(1))
    assert found.messages == ["cut with a stopped spindle: its force is not modelled"]
    assert [finding.line for finding in found.virtual.findings] == [4]
    samples = found.at(mill, found.time - 2.0)
    assert samples.cutting_power.tolist() == samples.cutting_force.tolist() == [0.0]


def test_threads_cut_nothing_and_say_so(mill: Machine, even_stock: Stocks) -> None:
    found = cutting(mill, even_stock, ON, HOME, DOWN, CUT, loaded=tool(1, None))
    assert found.messages == ["TOOL 1: threading is not modelled: no material is removed"]
    assert found.at(mill, found.time - 2.0).cutting_power.tolist() == [0.0]


def test_without_a_tool_or_a_stock_all_is_air(mill: Machine, even_stock: Stocks) -> None:
    for found in (
        run(mill, ON, HOME, DOWN, CUT, stock=even_stock()),
        run(mill, nc.ToolChange(number=1), ON, HOME, DOWN, CUT, tools={1: tool(1)}),
        run(mill, nc.ToolChange(number=1), ON, HOME, DOWN, CUT, stock=even_stock()),
    ):
        assert found.at(mill, found.time - 2.0).cutting_power.tolist() == [0.0]


@pytest.mark.parametrize("sense", list(nc.SpindleDirection))
def test_stock_is_told_how_the_spindle_turns(
    mill: Machine, even_stock: Stocks, sense: nc.SpindleDirection
) -> None:
    stock = even_stock()
    turn = replace(ON, sense=sense)
    run(mill, nc.ToolChange(number=1), turn, HOME, DOWN, CUT, tools={1: tool(1)}, stock=stock)
    assert getattr(stock, "senses") == [sense is nc.SpindleDirection.CLOCKWISE] * 2  # noqa: B009


def test_wear_grows_with_cutting_time_and_raises_the_force(
    mill: Machine, even_stock: Stocks
) -> None:
    """Ø10 at 50 rev/s is 1570.8 mm/s; with C there and n = 0.5 the edge lives one minute."""
    taylor = Taylor(exponent=0.5, constant=pi * 10.0 * 50.0)
    back = nc.Linear(end=(0.0, 0.0, 0.0), rate=FEED)
    pause = nc.Pause(seconds=1.0)
    found = cutting(
        mill, even_stock, ON, HOME, DOWN, CUT, pause, back, loaded=tool(1, taylor=taylor)
    )
    cuts = [e for e in found.episodes if e.course and e.course.cutting_seconds > 0.0]
    first, second = (e.course for e in cuts)
    assert first is not None
    assert second is not None
    assert first.wear.per_second == pytest.approx(LIFE_CRITERION / 60.0)
    assert second.wear.flank == pytest.approx(LIFE_CRITERION / 60.0 * first.cutting_seconds)
    assert first.cutting_seconds == pytest.approx(100.0 / 20.0 + 20.0 / 2000.0)
    early, late = cuts[0].begin + 1.0, cuts[0].begin + 4.0
    force = found.at(mill, early, late).cutting_force
    flank = LIFE_CRITERION / 60.0 * np.array([1.0, 4.0])
    # Two teeth on half a turn, 2 mm deep: 2 mm of edge rub at all times.
    np.testing.assert_allclose(force, 509.296 + 490.0 * 2.0 * flank, rtol=1e-6)


def test_worn_tool_is_said(mill: Machine, even_stock: Stocks) -> None:
    taylor = Taylor(exponent=0.5, constant=pi * 10.0 * 50.0 / 5.0)
    found = cutting(mill, even_stock, ON, HOME, DOWN, CUT, loaded=tool(1, taylor=taylor))
    assert found.messages == ["T1 TOOL 1: flank wear exceeds 0.3 mm"]


def test_spindle_follows_the_radius_and_its_programmed_speed_too(lathe: Machine) -> None:
    found = run(
        lathe,
        nc.Rapid(end=(50.0, 0.0, 5.0)),
        nc.SurfaceSpeed(speed=3000.0),
        nc.Rapid(end=(50.0, 0.0, 0.0)),
        nc.Linear(
            end=(20.0, 0.0, 0.0), rate=nc.Rate(value=0.5, mode=nc.RateMode.PER_REVOLUTION)
        ),
    )
    cut = found.episodes[-2]
    samples = sensed(cut, lathe, np.linspace(cut.begin, cut.end, 200))
    speed = 3000.0 / (2.0 * pi * samples.position[:, 0])
    np.testing.assert_allclose(samples.spindle_programmed, speed, rtol=0.021)
    late = samples.time > cut.begin + 0.2
    np.testing.assert_allclose(samples.spindle_speed[late], speed[late], rtol=0.021)
    assert samples.spindle_speed[0] == pytest.approx(3000.0 / (100.0 * pi))


@pytest.mark.parametrize("rate", [1.0, 250.0])
def test_same_program_twice_gives_the_same_bytes(
    mill: Machine, even_stock: Stocks, rate: float
) -> None:
    def bytes_of() -> list[bytes]:
        taylor = Taylor(exponent=0.3, constant=2000.0)
        blocks = (ON, FLOOD, HOME, DOWN, CUT, HOME, nc.ProgramEnd())
        found = cutting(mill, even_stock, *blocks, loaded=tool(1, taylor=taylor))
        sampler = Sampler(mill, rate=rate)
        samples = joined([part for e in found.episodes for part in sampler.samples(e)])
        return [getattr(samples, each.name).tobytes() for each in fields(Samples)]

    assert bytes_of() == bytes_of()


def test_what_met_the_stock_is_told_at_the_end(mill: Machine) -> None:
    """A rapid through a box, and a holder that runs into it."""
    box = MillingStock(Stock(low=(0.0, 0.0, -20.0), high=(40.0, 40.0, 0.0)), cell=0.5)
    shape = Cutter(diameter=10.0, holder=Holder(diameter=30.0, overhang=8.0))
    found = run(
        mill,
        nc.ToolChange(number=1),
        ON,
        nc.Rapid(end=(-20.0, 20.0, -12.0)),
        nc.Rapid(end=(10.0, 20.0, -12.0)),
        nc.Linear(end=(30.0, 20.0, -12.0), rate=nc.Rate(value=20.0)),
        tools={1: tool(1, shape)},
        stock=box,
    )
    assert any("a rapid move cuts" in text for text in found.messages)
    assert any("the holder is 4 mm deep" in text for text in found.messages)


def test_linuxcnc_rounds_corners_as_far_as_the_program_lets_it(mill: Machine) -> None:
    def nearest(tolerance: float) -> float:
        blocks: list[nc.Block] = [
            nc.PathControl(tolerance=tolerance),
            nc.Rapid(end=(0.0, 0.0, 0.0)),
            nc.Linear(end=(9.0, 0.0, 0.0), rate=nc.Rate(value=50.0)),
            nc.Linear(end=(9.0, 9.0, 0.0), rate=nc.Rate(value=50.0)),
        ]
        setup = MachineSetup(machine=mill, control=LinuxCncPlanner())
        run = VirtualMachine(setup).run(interpret(enumerate(blocks, 1), mill))
        (course,) = [episode.course for episode in run if episode.course is not None]
        places = course.motion.at(np.linspace(0.0, course.motion.duration, 9999)).position
        return float(np.linalg.norm(places - np.array([9.0, 0.0, 0.0]), axis=1).min())

    assert [nearest(each) for each in (0.01, 0.1)] == pytest.approx([0.01, 0.1], rel=0.01)
    assert nearest(0.0) == pytest.approx(0.0, abs=1e-3)
