"""Times of blocks, against lengths over feeds worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from simulator.library import load_machine
from simulator.machine.block_times import BlockTimes, LossCause, block_times
from simulator.machine.interpreter import interpret
from simulator.machine.virtual import MachineSetup, VirtualMachine
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import axis_limits
from stepnc_model.post.blocks import Block, Linear, Pause, ProgramEnd, Rapid, Rate, ToolChange

MACHINE = replace(load_machine("vmc15"), block_time=0.01)


def times(blocks: list[Block], control: ControlModelName) -> BlockTimes:
    limits = axis_limits(MACHINE)
    setup = MachineSetup(machine=MACHINE, control=control_model(control, limits))
    acts = interpret(enumerate(blocks, start=1), MACHINE)
    return block_times(VirtualMachine(setup).run(acts), limits)


def straight(count: int, spacing: float, feed: float) -> list[Block]:
    rate = Rate(value=feed)
    points = [Linear(end=(spacing * (row + 1), 0.0, 0.0), rate=rate) for row in range(count)]
    return [Rapid(end=(0.0, 0.0, 0.0)), *points, ProgramEnd()]


def feeds(found: BlockTimes) -> slice:
    rows = np.flatnonzero(found.is_rapid == 0)
    return slice(int(rows[0]), int(rows[-1]) + 1)


@pytest.mark.parametrize("control", [ControlModelName.FIR, ControlModelName.JUNCTION])
def test_short_blocks_take_the_block_time(control: ControlModelName) -> None:
    found = times(straight(500, 0.1, 50.0), control)
    rows = feeds(found)
    assert found.programmed[rows].sum() == pytest.approx(500 * 0.1 / 50.0)
    assert found.by_rate[rows].sum() == pytest.approx(500 * 0.01)
    assert found.predicted[rows].sum() == pytest.approx(500 * 0.01, rel=0.01)
    assert (found.cause[rows][10:-10] == LossCause.BLOCK_RATE).all()
    assert found.reached[rows] == pytest.approx(0.2)
    assert found.line[rows][0] == 2


def test_long_blocks_lose_by_acceleration_alone() -> None:
    """One move of 10 mm from rest to rest adds v/a."""
    found = times(straight(1, 10.0, 50.0), ControlModelName.EXACT_STOP)
    rows = feeds(found)
    assert found.lost[rows][0] == pytest.approx(50.0 / 4000.0)
    assert found.cause[rows][0] == LossCause.MOTION
    assert found.reached[rows][0] == 1.0


def test_a_feed_above_that_of_the_axes_is_told() -> None:
    found = times(straight(1, 2000.0, 1000.0), ControlModelName.JUNCTION)
    rows = feeds(found)
    assert found.by_axes[rows][0] == pytest.approx(2000.0 / (20_000.0 / 60.0))
    assert found.cause[rows][0] == LossCause.AXES


def test_waits_are_as_long_as_programmed() -> None:
    blocks = [ToolChange(number=3), Pause(seconds=2.0), *straight(2, 5.0, 20.0)]
    found = times(blocks, ControlModelName.FIR)
    waits = found.is_rapid < 0
    assert found.programmed[waits].tolist() == [MACHINE.tool_change, 2.0]
    assert (found.lost[waits] == 0.0).all()
    assert found.tool.tolist()[-1] == 3


def test_radius_of_a_path_follows_from_its_corners() -> None:
    angles = np.linspace(0.0, 1.0, 101)
    rate = Rate(value=20.0)
    circle: list[Block] = [
        Linear(end=(30.0 * np.cos(a), 30.0 * np.sin(a), 0.0), rate=rate) for a in angles[1:]
    ]
    blocks = [Rapid(end=(30.0, 0.0, 0.0)), *circle, ProgramEnd()]
    found = times(blocks, ControlModelName.FIR)
    assert found.radius[feeds(found)][:-1] == pytest.approx(30.0, rel=1e-4)


def test_a_program_without_moves_takes_no_time() -> None:
    assert len(times([ProgramEnd()], ControlModelName.FIR)) == 0
