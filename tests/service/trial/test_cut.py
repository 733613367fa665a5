"""The cut of a trial is that of the physics, and its bound that of the motor."""

from math import pi

import numpy as np
import pytest

from service.trial.inputs import (
    AIR,
    ENDLESS,
    ENTRY,
    Inputs,
    MillingType,
    changed,
    course_of,
    engagement_of,
    force_bound,
    predicted,
    preview_of,
    step_of,
    trial_cut,
)
from simulator.physics.milling import mean_force

INPUTS = Inputs()
PAPER = Inputs(
    material="paper002",
    tool_diameter_mm=18.0,
    teeth=1,
    cutting_speed_m_min=35.0,
    feed_per_tooth_mm=0.5,
    axial_depth_mm=3.0,
    motor_power_kw=0.29,
)
"""Ridwan, Xu, Liu 2010, Table 2 and Fig. 11, with the one tooth that gives its Table 1"""


def test_the_paper_s_case_has_the_paper_s_numbers() -> None:
    """447.4 N by 0.29 kW; 0.3095 kW at a chip load of 0.5 mm."""
    trial = trial_cut(PAPER)
    assert force_bound(trial, 290.0) == pytest.approx(447.429, rel=1e-6)
    assert predicted(trial, 0.5).power == pytest.approx(309.5, abs=0.05)
    assert predicted(trial, 0.5).specific_cutting_force == pytest.approx(1000.0)
    assert predicted(trial, 0.4685).power == pytest.approx(290.0, abs=0.05)


def test_by_default_two_millimetres_are_bounded_by_the_chip_load() -> None:
    trial = trial_cut(INPUTS)
    assert 4500.0 < predicted(trial, INPUTS.feed_per_tooth_mm).power < 7500.0
    deeper = trial_cut(changed(INPUTS, axial_depth_mm=4.0))
    assert predicted(deeper, INPUTS.feed_per_tooth_mm).power > 1.2 * 7500.0


def test_power_and_removal_are_of_one_energy() -> None:
    now = predicted(trial_cut(INPUTS), 0.15)
    assert now.specific_cutting_force is not None
    # P·η = k_c·Q, whatever the engagement.
    work = now.specific_cutting_force * now.removal_rate / 1000.0
    assert now.power * INPUTS.efficiency == pytest.approx(work)


def test_a_feed_that_stands_cuts_nothing() -> None:
    now = predicted(trial_cut(INPUTS), 0.0)
    assert (now.force, now.power, now.specific_cutting_force) == (0.0, 0.0, None)


@pytest.mark.parametrize(
    ("kind", "entry", "exit_"),
    [
        (MillingType.FULL, 0.0, pi),
        (MillingType.UP, 0.0, pi / 2.0),
        (MillingType.DOWN, pi / 2.0, pi),
        (MillingType.SYMMETRIC, pi / 3.0, 2.0 * pi / 3.0),
    ],
)
def test_milling_types_engage_as_in_figure_6(
    kind: MillingType, entry: float, exit_: float
) -> None:
    arc = engagement_of(changed(INPUTS, milling_type=kind.value, radial_width_mm=25.0))
    assert (arc.entry_angle, arc.exit_angle) == pytest.approx((entry, exit_), abs=1e-12)


@pytest.mark.parametrize("kind", MillingType)
@pytest.mark.parametrize("width", [0.5, 10.0, 50.0])
def test_the_course_leads_into_a_cut_without_end(kind: MillingType, width: float) -> None:
    inputs = changed(INPUTS, milling_type=kind.value, radial_width_mm=width)
    trial = trial_cut(inputs)
    course = course_of(trial)
    assert course.force[0] == 0.0
    assert (np.diff(course.force) >= 0.0).all()
    assert course.duration == ENDLESS
    assert course.until[-2] == pytest.approx((AIR + ENTRY) / trial.spindle_speed)
    assert course.force[-1] == pytest.approx(mean_force(trial.kienzle, trial.cut), rel=1e-6)
    now = predicted(trial, inputs.feed_per_tooth_mm)
    assert course.removal_rate[-1] == pytest.approx(now.removal_rate, rel=1e-6)
    assert course.feed[-1] == pytest.approx(trial.feed, rel=1e-6)
    assert (course.peak > 0.0).all()
    # The last cell of the way in is almost the cut itself.
    assert course.force[-2] > 0.85 * course.force[-1] or width < 1.0


def test_the_loop_keeps_motor_power_chip_load_and_chip_thickness() -> None:
    trial = trial_cut(INPUTS)
    step = step_of(trial, INPUTS)
    (bound,) = step.reference.bounds
    # 7.5 kW · 0.9 at 220 m/min.
    assert bound.force == pytest.approx(7500.0 * 0.9 / (220.0 / 60.0))
    assert step.reference.ceiling == 1.0
    # 0.01 mm, the least mean chip of an insert, over that at the chip load.
    assert step.reference.floor == pytest.approx(0.01 / (0.2 * 2.0 / pi))
    assert step.exponent == pytest.approx(0.78)
    # 1500·h_m^−0.22 at 0.1273 mm is 2360.5 N/mm²; eq. (4) with 2 mm, 0.8 mm a revolution.
    force = 2360.54 * 2.0 * 0.8 * 2.0 / (2.0 * pi)
    assert preview_of(course_of(trial)).mean(5.0, 6.0) == pytest.approx(force, rel=1e-5)


def test_a_chip_load_below_the_least_chip_leaves_nothing_to_choose() -> None:
    thin = changed(INPUTS, feed_per_tooth_mm=0.01)
    assert step_of(trial_cut(thin), thin).reference.floor == 1.0


def test_a_material_of_no_group_has_no_least_chip() -> None:
    assert step_of(trial_cut(PAPER), PAPER).reference.floor == 0.0


def test_the_edge_angle_thins_the_chip() -> None:
    flat = trial_cut(changed(INPUTS, cutting_edge_angle_deg=45.0))
    steep = trial_cut(INPUTS)
    assert predicted(flat, 0.2).chip_thickness == pytest.approx(
        predicted(steep, 0.2).chip_thickness / 2.0**0.5
    )
    assert predicted(flat, 0.2).force > predicted(steep, 0.2).force
