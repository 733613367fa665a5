"""What holds of every run of the virtual machine, whatever the program."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.library import load_machine
from simulator.machine.cutting import CuttingEdge
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode, Execution, Samples, joined
from simulator.machine.sensing import Sampler, sensed
from simulator.machine.totals import Total, added
from simulator.machine.virtual import LoadedTool, MachineSetup, VirtualMachine
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import axis_limits
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.spec import Kienzle
from stepnc_model.post import blocks as nc
from stepnc_model.programs.program import Stock

MACHINE = load_machine("vmc15")
LIMITS = axis_limits(MACHINE)
EDGE = CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=1500.0, m_c=0.25))
TOOLS = {
    number: LoadedTool(number=number, id=f"T{number}", shape=Cutter(diameter=6.0), edge=EDGE)
    for number in (1, 2)
}
STOCK = Stock(low=(0.0, 0.0, -10.0), high=(30.0, 20.0, 0.0))

COORDINATES = st.integers(-10, 40).map(float)
POINTS = st.tuples(COORDINATES, COORDINATES, st.sampled_from([-3.0, -1.0, 0.5, 10.0]))
RATES = st.sampled_from([
    nc.Rate(value=5.0),
    nc.Rate(value=60.0),
    nc.Rate(value=0.1, mode=nc.RateMode.PER_REVOLUTION),
])
BLOCKS = st.one_of(
    st.builds(nc.Rapid, end=POINTS),
    st.builds(nc.Linear, end=POINTS, rate=RATES),
    st.builds(
        nc.SpindleOn,
        speed=st.floats(5.0, 300.0),
        sense=st.sampled_from(list(nc.SpindleDirection)),
    ),
    st.builds(nc.Pause, seconds=st.floats(0.0, 2.0)),
    st.builds(nc.ToolChange, number=st.sampled_from([1, 2])),
    st.builds(nc.Retract, z=st.just(20.0)),
    st.just(nc.Coolant(kinds=frozenset({nc.CoolantKind.FLOOD}))),
    st.just(nc.Coolant()),
    st.just(nc.ProgramStopBlock()),
    st.builds(nc.Comment, text=st.just(""), workingstep=st.sampled_from(["A", "B"])),
)
PROGRAMS = st.lists(BLOCKS, max_size=12).map(lambda body: [nc.SpindleOn(speed=40.0), *body])
CONTROLS = st.sampled_from(list(ControlModelName))

Run = tuple[VirtualMachine, list[Episode], MillingStock]


def run(blocks: list[nc.Block], control: ControlModelName) -> Run:
    stock = MillingStock(STOCK, cell=0.5)
    setup = MachineSetup(
        machine=MACHINE,
        control=control_model(control, LIMITS),
        tools=TOOLS,
        stock=lambda _: stock,
    )
    virtual = VirtualMachine(setup)
    return virtual, list(virtual.run(interpret(enumerate(blocks, 1), MACHINE))), stock


def sampled(episodes: list[Episode], rate: float) -> Samples:
    sampler = Sampler(MACHINE, rate=rate)
    return joined([part for episode in episodes for part in sampler.samples(episode)])


@settings(max_examples=40, deadline=None)
@given(blocks=PROGRAMS, control=CONTROLS)
def test_a_run_is_whole(blocks: list[nc.Block], control: ControlModelName) -> None:
    virtual, episodes, _ = run(blocks, control)
    assert [e.begin for e in episodes] == [0.0, *(e.end for e in episodes[:-1])]
    assert episodes[-1].state.execution is Execution.PROGRAM_COMPLETED
    samples = sampled(episodes, 50.0)
    np.testing.assert_array_equal(samples.time, np.arange(len(samples)) / 50.0)
    for each in fields(Samples):
        assert np.isfinite(getattr(samples, each.name)).all(), each.name
    # Nothing moves faster than it can.
    assert np.abs(samples.spindle_speed).max() <= 200.0 * (1.0 + 1e-9)
    assert (np.abs(samples.velocity) <= LIMITS.rapid * (1.0 + 1e-9)).all()
    assert (np.diff(samples.workingstep) >= 0).all()
    assert samples.workingstep[-1] == len(virtual.workingsteps)
    # Cutting draws power, and what is not cut has none.
    air = samples.removal_rate == 0.0
    assert not samples.cutting_power[air].any()
    assert (samples.cutting_power[~air] > 0.0).all()
    # A spindle that brakes lends its own.
    steady = samples.spindle_speed == samples.spindle_programmed
    assert (samples.spindle_power >= samples.cutting_power)[steady].all()


@settings(max_examples=25, deadline=None)
@given(blocks=PROGRAMS, control=CONTROLS)
def test_position_is_continuous(blocks: list[nc.Block], control: ControlModelName) -> None:
    _, episodes, _ = run(blocks, control)
    last: Samples | None = None
    for episode in episodes:
        both = sensed(episode, MACHINE, np.array([episode.begin, episode.end]))
        if last is not None:
            np.testing.assert_allclose(both.position[0], last.position[-1], atol=1e-9)
            np.testing.assert_allclose(
                both.spindle_speed[0], last.spindle_speed[-1], rtol=0, atol=1e-6
            )
        np.testing.assert_allclose(both.velocity, 0.0, atol=1e-6)
        last = both


@settings(max_examples=20, deadline=None)
@given(blocks=PROGRAMS, control=CONTROLS)
def test_totals_are_those_of_dense_samples(
    blocks: list[nc.Block], control: ControlModelName
) -> None:
    _, episodes, _ = run(blocks, control)
    total = Total()
    for episode in episodes:
        total = added(total, episode, MACHINE)
    assert total.duration == pytest.approx(episodes[-1].end)
    rate = 5000.0
    samples = sampled(episodes, rate)
    energy = float(np.trapezoid(samples.total_power, samples.time))
    # Power jumps by some kW at most, a few times a block, and each is seen up to 0.2 ms late.
    slack = 2e-4 * 20_000.0 * (len(blocks) + 3)
    assert total.energy.total == pytest.approx(energy, rel=2e-3, abs=slack)
    # The last sample may come after the end.
    seen = samples.spindle_power[:-1].max(initial=0.0)
    # A rapid that cuts may have its peak between two stations.
    assert total.power.value >= seen * (1.0 - 5e-4) - 1e-6
    parts = total.energy
    assert parts.total == pytest.approx(
        parts.x_axis + parts.y_axis + parts.z_axis + parts.spindle + parts.coolant + parts.base
    )


@settings(max_examples=15, deadline=None)
@given(blocks=PROGRAMS)
def test_exact_stop_removes_what_the_map_loses(blocks: list[nc.Block]) -> None:
    """Unless the spindle stands, of which nothing is known."""
    virtual, episodes, stock = run(blocks, ControlModelName.EXACT_STOP)
    total = Total()
    for episode in episodes:
        total = added(total, episode, MACHINE)
    told = any("stands" in finding.message for finding in virtual.findings)
    if not told:
        # Cells of 0.5 mm under a tool of 6 mm.
        assert total.volume == pytest.approx(stock.volume, rel=0.1, abs=30.0)


@settings(max_examples=10, deadline=None)
@given(blocks=PROGRAMS, control=CONTROLS, rate=st.sampled_from([1.0, 40.0]))
def test_same_program_same_bytes(
    blocks: list[nc.Block], control: ControlModelName, rate: float
) -> None:
    one, other = (sampled(run(blocks, control)[1], rate) for _ in range(2))
    for each in fields(Samples):
        assert getattr(one, each.name).tobytes() == getattr(other, each.name).tobytes()
