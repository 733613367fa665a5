"""Where the program's zero lies, and moves that leave the travel."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.errors import OutOfTravel, ProgramFault
from simulator.machine.travel import require_axes, require_travel, zero_of
from simulator.motion.segments import Segments, arc, chained, lines
from simulator.spec import Machine
from stepnc_model.programs.program import Stock

NOWHERE = (0.0, 0.0, 0.0)


def test_stock_lies_in_the_middle_of_a_mill(mill: Machine) -> None:
    stock = Stock(low=(0.0, -10.0, -20.0), high=(100.0, 30.0, 0.0), radius=None)
    assert zero_of(mill, stock) == (-50.0, -10.0, 10.0)


def test_bar_begins_where_the_travel_of_a_lathe_does(lathe: Machine) -> None:
    stock = Stock(low=(-30.0, -30.0, -80.0), high=(30.0, 30.0, 0.0), radius=30.0)
    assert zero_of(lathe, stock) == (0.0, 0.0, -420.0)


def test_endless_travel_has_no_middle(mill: Machine) -> None:
    endless = tuple(replace(axis, travel=(-inf, inf)) for axis in mill.axes)
    stock = Stock(low=(0.0, 0.0, 0.0), high=(100.0, 30.0, 10.0), radius=None)
    assert zero_of(replace(mill, axes=endless), stock) == NOWHERE


def test_move_off_the_travel_names_axis_position_and_line(mill: Machine) -> None:
    path = replace(lines([(0, 0, 0), (0, 400, 0), (0, 450.5, 0)]), block=np.array([11, 12]))
    with pytest.raises(OutOfTravel, match=r"line 12: Y = 450\.5 mm") as caught:
        require_travel(mill, path, (0.0, 100.0, 0.0))
    assert (caught.value.axis, caught.value.position, caught.value.line) == ("Y", 450.5, 12)
    assert "-600 to 400 mm" in str(caught.value)


def test_first_position_counts_too(mill: Machine) -> None:
    with pytest.raises(OutOfTravel, match="X = -501 mm"):
        require_travel(mill, lines([(-501, 0, 0), (0, 0, 0)]), NOWHERE)


def test_end_of_the_travel_may_be_reached(mill: Machine) -> None:
    require_travel(mill, lines([(0, 0, 0), (500.0 + 1e-9, 0, 0)]), NOWHERE)


@settings(max_examples=60)
@given(
    normal=st.integers(0, 2),
    begin=st.floats(-pi, pi),
    turn=st.floats(0.05, 9.0) | st.floats(-9.0, -0.05),
)
def test_arc_may_go_as_far_as_its_farthest_point(
    mill: Machine, normal: int, begin: float, turn: float
) -> None:
    """Against positions every half degree, up to 5·10⁻⁵ of the radius short."""
    first, second = (1, 2, 0)[normal], (2, 0, 1)[normal]
    start = [0.0, 0.0, 0.0]
    start[first], start[second] = 40.0 * np.cos(begin), 40.0 * np.sin(begin)
    path: Segments = arc(start, NOWHERE, turn, normal=normal, rise=3.0, speed=10.0)
    count = int(abs(turn) / 0.008) + 2
    station = np.linspace(0.0, path.length[0], count)
    farthest = path.position(np.zeros(count, dtype=np.int64), station).max(axis=0)
    for row, axis in enumerate(mill.axes):
        for room, fits in ((2e-3, True), (-2e-3, False)):
            travel = (-500.0, float(farthest[row]) + room)
            others = tuple(
                replace(axis, travel=travel) if each is axis else each for each in mill.axes
            )
            machine = replace(mill, axes=others)
            if fits:
                require_travel(machine, path, NOWHERE)
            else:
                with pytest.raises(OutOfTravel):
                    require_travel(machine, path, NOWHERE)


def test_axis_that_the_machine_has_not_names_the_line(lathe: Machine) -> None:
    path = chained([lines([(0, 0, 0), (5, 0, 0)]), lines([(5, 0, 0), (5, 2, 0)])])
    require_axes(lathe, path[:1])
    with pytest.raises(ProgramFault, match="line 1: move along Y"):
        require_axes(lathe, path)


def test_rounding_beside_the_axis_is_no_move(lathe: Machine) -> None:
    require_axes(lathe, lines([(0, 1e-7, 0), (5, 0, 0)]))
