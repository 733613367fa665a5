from dataclasses import replace

import numpy as np
import pytest

from controller.reference import ForceBound, Reference
from controller.signals.preview import Preview
from controller.states.equivalent_force import equivalent, weighed
from controller.states.loop_settings import LoopSettings, LoopStep
from optimiser.solver.problem import LimitName
from tests.controller.shown import turn

POWER = ForceBound(name=LimitName.MOTOR_POWER, words="motor power", force=1000.0)
BENDING = ForceBound(
    name=LimitName.TOOL_DEFLECTION, words="tool deflection", force=400.0, peak=800.0
)
STEP = LoopStep(reference=Reference(workingstep="x", bounds=(BENDING, POWER)))
PLAIN = Preview(
    until=np.arange(1.0, 5.0),
    force=np.array([100.0, 100.0, 100.0, 100.0]),
    # As the plan has it, a slot, a sliver; the last belongs to another workingstep.
    peak=np.array([2.0, 1.0, 8.0, 8.0]),
    workingstep=np.array([1, 1, 1, 2]),
)


def test_forces_that_use_the_same_share_of_their_bounds_count_alike() -> None:
    found = equivalent(PLAIN, [STEP], LoopSettings())
    # 100 N of 400 N; of 800 N, as the slot has no peaks; of 100 N.
    assert found.force.tolist() == [100.0, 50.0, 400.0, 100.0]
    shares = found.force[:3] / 400.0
    assert shares.tolist() == [100.0 / 400.0, 100.0 / 800.0, 100.0 / 100.0]


def test_what_bends_a_wall_counts_by_its_own_force() -> None:
    """At the plan's place 100 N of 400 N; a thin wall takes twice the share of its mean."""
    at_wall = replace(BENDING, peak=0.0, wall=200.0)
    step = LoopStep(reference=Reference(workingstep="x", bounds=(at_wall, POWER)))
    plain = replace(PLAIN, wall=np.array([0.5, 0.0, 1.0, 1.0]))
    found = equivalent(plain, [step], LoopSettings())
    # In the slot only the motor's power counts: 100 N of 1000 N.
    assert found.force.tolist() == [100.0, 40.0, 200.0, 100.0]
    without = equivalent(PLAIN, [step], LoopSettings())
    assert without.force.tolist() == [40.0, 40.0, 40.0, 100.0]


def test_less_motor_power_bounds_the_slot() -> None:
    found = equivalent(PLAIN, [STEP], LoopSettings(power_factor=0.5))
    assert found.force[1] == pytest.approx(400.0 * 100.0 / 500.0)
    bound = STEP.reference.bound(power_factor=0.3)
    assert bound is not None
    least = equivalent(PLAIN, [STEP], LoopSettings(power_factor=0.3))
    # 300 N is the bound that forces are told in: of power, but for the sliver's 100 N.
    assert bound.force == 300.0
    assert least.force[:3] == pytest.approx([100.0, 100.0, 300.0])


def test_a_set_point_of_the_users_own_is_a_plain_force() -> None:
    assert equivalent(PLAIN, [STEP], LoopSettings(set_point=500.0)) is PLAIN


def test_without_bounds_forces_count_as_they_are() -> None:
    free = replace(STEP, reference=Reference(workingstep="x"))
    assert equivalent(PLAIN, [free], LoopSettings()).force.tolist() == PLAIN.force.tolist()


def test_a_reading_is_weighed_with_what_is_cut() -> None:
    found = equivalent(PLAIN, [STEP], LoopSettings())
    assert found.weight_between(0.0, 1.0) == pytest.approx(1.0)
    assert found.weight_between(0.5, 1.5) == pytest.approx(0.75)
    (shown,) = turn(np.array([[100.0, 200.0]]))
    assert weighed(shown, 0.5).force.tolist() == [50.0, 100.0]
    assert weighed(shown, 1.0) is shown


def test_a_sliver_without_force_does_not_count() -> None:
    sliver = replace(PLAIN, force=np.array([100.0, 1e-3, 1e-3, 0.0]))
    found = equivalent(sliver, [STEP], LoopSettings())
    assert found.weight_between(0.5, 2.5) == pytest.approx(1.0, rel=1e-3)
    assert found.weight_between(3.5, 3.6) == 1.0
