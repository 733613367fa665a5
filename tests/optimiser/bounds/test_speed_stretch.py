"""Bounds as powers of the speed on stretches of it."""

from dataclasses import replace
from itertools import pairwise
from math import sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.bounds.limits import segment_at
from optimiser.bounds.speed_stretch import STEP, powers_of_speed, segment_within, stretch_ends
from simulator.library import load_machine
from simulator.physics.holding import clamping_force, usable_speed
from simulator.physics.spindle import available_power, idle_power
from simulator.spec import ToolKind
from simulator.work_holding import Chuck
from tests.optimiser.sample_cuts import PAPER, TURNED, conditions

CHUCK = Chuck(clamping_force=60_000.0, friction=0.2, source="", jaw_mass=3.0, jaw_radius=80.0)
LATHE = replace(conditions(ToolKind.TURNING), machine=load_machine("lathe22"), holding=CHUCK)
LOW, HIGH = 4.0, usable_speed(CHUCK)
ENDS = stretch_ends(TURNED, LATHE, LOW, HIGH)


def test_one_speed_has_a_number() -> None:
    assert powers_of_speed(lambda speed: 7.0 * speed, 3.0, 3.0) == (21.0, 0.0)


def test_a_power_is_a_power() -> None:
    found = powers_of_speed(lambda speed: 5.0 * speed**-0.7, 2.0, 9.0)
    assert found == pytest.approx((5.0, -0.7))


def test_stretches_join_and_are_short() -> None:
    assert (ENDS[0], ENDS[-1]) == (LOW, HIGH)
    assert all(1.0 < fast / slow <= STEP * (1.0 + 1e-9) for slow, fast in pairwise(ENDS))


@given(share=st.floats(0.0, 1.0))
def test_powers_lie_below_what_a_chuck_holds_and_near_it(share: float) -> None:
    speed = LOW * (HIGH / LOW) ** share
    slow, fast = next(
        pair for pair in pairwise(ENDS) if pair[0] <= speed <= pair[1] * (1 + 1e-12)
    )
    bound, exponent = powers_of_speed(lambda n: clamping_force(CHUCK, n), slow, fast)
    exact = clamping_force(CHUCK, speed)
    assert 0.93 * exact <= bound * speed**exponent <= exact * (1.0 + 1e-9)


@given(share=st.floats(0.0, 1.0))
def test_what_idling_leaves_is_never_told_too_high(share: float) -> None:
    speed = LOW * (HIGH / LOW) ** share
    slow, fast = next(
        pair for pair in pairwise(ENDS) if pair[0] <= speed <= pair[1] * (1 + 1e-12)
    )
    spindle = LATHE.machine.spindle
    left = available_power(spindle, speed) - float(idle_power(spindle, speed))
    told = segment_within(TURNED, LATHE, slow, fast).power(speed)
    assert 0.97 * left <= told <= left * (1.0 + 1e-9)


def test_machines_of_papers_keep_the_stretches_of_their_curve() -> None:
    assert segment_within(TURNED, PAPER, 10.0, 10.0) == segment_at(PAPER, 10.0)
    knee = PAPER.machine.spindle.curve[0].speed
    assert stretch_ends(TURNED, PAPER, 5.0, 50.0) == (5.0, knee, 50.0)


def test_a_spindle_that_only_idles_leaves_a_watt() -> None:
    spindle = replace(LATHE.machine.spindle, idle_power=1e6)
    at = replace(LATHE, machine=replace(LATHE.machine, spindle=spindle))
    assert segment_within(TURNED, at, 10.0, 10.0).power(10.0) == 1.0


def test_the_force_of_a_chuck_ends_stretches() -> None:
    limit = usable_speed(CHUCK) / sqrt(0.9)
    assert any(speed == pytest.approx(limit * sqrt(0.5)) for speed in ENDS)
