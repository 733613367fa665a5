"""Chucks as VDI 3106 reckons them, by what makers of chucks print.

Röhm, KFD-N operating manual, 29.04.2004, p. 13, eq. (4) to (9); Schunk, ROTA 2B operating
manual 03.00, p. 25, and ROTA NCX 03.00, p. 25; Forkardt, 3QLC-LM operating manual, 04/2014,
p. 28; Kitagawa, QB300 instruction manual, p. 18; Optimum, TH4610D manual, p. 151 (DIN 6386).
"""

from dataclasses import replace
from math import inf, pi, sqrt

import pytest

from simulator.physics.holding import (
    GripSize,
    clamping_force,
    greatest_moment,
    greatest_torque,
    permitted_speed,
    slipping_torque,
    usable_speed,
)
from simulator.work_holding import (
    Chuck,
)
from stepnc_model.units import rev_s_from_rpm, rpm_from_rev_s

SCHUNK = Chuck(
    clamping_force=17_723.0,
    friction=0.2,
    source="ROTA 2B, p. 25",
    jaws=3,
    # Σ M_c = 2.668 kg·m of all three jaws.
    jaw_mass=2.668 / 3.0,
    jaw_radius=1_000.0,
    safety_factor=1.5,
    clamping_safety_factor=1.5,
)
"""the worked example: 17 723 N at rest for a machining force of 3000 N"""

NO_LOSS = replace(SCHUNK, clamping_force=30_000.0, jaw_mass=0.0, clamping_safety_factor=1.0)


def test_schunk_rota_2b_holds_3000_n_at_500_rpm() -> None:
    """17 723 N = 1.5·(1.5·3000 N + F_c); F_c = Σ M_c·(π·n/30)² = 7315 N is that of 500 rpm.

    The page prints 1495 rpm for its formula, which the numbers beside it do not give.
    """
    assert rpm_from_rev_s(permitted_speed(SCHUNK, 3_000.0)) == pytest.approx(500.0, rel=1e-4)
    left = clamping_force(SCHUNK, rev_s_from_rpm(500.0))
    assert left == pytest.approx(1.5 * 3_000.0, rel=1e-3)


def test_top_jaws_of_schunk_have_half_a_kilogram_metre() -> None:
    """ROTA NCX, p. 25: 5.33 kg at 0.107 m; eq. (5) gives 9006 N of one jaw at 1200 rpm."""
    jaw = replace(NO_LOSS, jaws=1, jaw_mass=5.33, jaw_radius=107.0)
    speed = rev_s_from_rpm(1_200.0)
    lost = clamping_force(jaw, 0.0) - clamping_force(jaw, speed)
    assert lost == pytest.approx(5.33 * 0.107 * (pi * 1_200.0 / 30.0) ** 2)


def test_at_the_reference_speed_a_third_of_the_force_is_left() -> None:
    """DIN 6386, and Kitagawa's greatest speed: a third of the static force remains."""
    reference = rev_s_from_rpm(3_200.0)
    chuck = replace(NO_LOSS, lost_force=20_000.0, lost_at=reference)
    assert clamping_force(chuck, reference) == pytest.approx(10_000.0)
    assert clamping_force(chuck, 0.5 * reference) == pytest.approx(25_000.0)


def test_two_losses_add() -> None:
    chuck = replace(NO_LOSS, jaw_mass=1.0, jaw_radius=50.0, lost_force=1_000.0, lost_at=10.0)
    jaws = 3.0 * 1.0 * 0.05 * (2.0 * pi * 10.0) ** 2
    assert clamping_force(chuck, 10.0) == pytest.approx(30_000.0 - 1_000.0 - jaws)


def test_a_chuck_without_loss_turns_as_fast_as_it_likes() -> None:
    assert permitted_speed(NO_LOSS) == inf
    assert permitted_speed(NO_LOSS, 30_000.0) == 0.0
    assert clamping_force(NO_LOSS, 1e3) == 30_000.0
    assert clamping_force(SCHUNK, 1e3) == 0.0


def test_a_tenth_of_the_force_is_left_at_the_usable_speed() -> None:
    rest = clamping_force(SCHUNK, 0.0)
    assert clamping_force(SCHUNK, usable_speed(SCHUNK)) == pytest.approx(0.1 * rest)


def test_torque_is_friction_on_the_grip_over_the_safety_factor() -> None:
    """Röhm, norm RN-1391: F_spz = F_s·S_z/µ_sp · d_z/d_sp."""
    grip = GripSize(diameter=60.0, length=30.0)
    torque = greatest_torque(NO_LOSS, grip, 0.0)
    machining_force, machining_diameter = 2_000.0, 90.0
    asked = machining_force * 1.5 / 0.2 * machining_diameter / 60.0
    assert 0.5 * machining_diameter * machining_force * 30_000.0 / asked == pytest.approx(
        torque
    )


def test_axial_force_slips_with_the_torque() -> None:
    """Röhm, norm RN-1391, p. 51: the resultant of both enters the formula."""
    grip = GripSize(diameter=60.0, length=30.0)
    assert slipping_torque(90_000.0, 4_000.0, grip) == pytest.approx(150_000.0)


def test_three_jaws_of_no_length_tilt_by_forkardts_overhang() -> None:
    """X = 0.75·D·(µ_sp·F_sp/3)/P."""
    grip = GripSize(diameter=80.0, length=1e-9)
    chuck = replace(NO_LOSS, safety_factor=1.0)
    force = 1_500.0
    overhang = 0.75 * 80.0 * 0.2 * 30_000.0 / 3.0 / force
    assert greatest_moment(chuck, grip, 0.0) == pytest.approx(force * overhang)


@pytest.mark.parametrize(
    ("jaws", "arm", "across"),
    [(2, 1.0, 0.0), (3, 0.75, sqrt(3.0)), (4, 1.0, 2.0), (6, 1.0, 2.0 * sqrt(3.0))],
)
def test_the_grip_s_length_holds_by_jaws_across_the_weakest_direction(
    jaws: int, arm: float, across: float
) -> None:
    chuck = replace(NO_LOSS, jaws=jaws, safety_factor=1.0)
    grip = GripSize(diameter=80.0, length=60.0)
    expected = 30_000.0 / jaws * (0.2 * 80.0 * arm + 10.0 * across)
    assert greatest_moment(chuck, grip, 0.0) == pytest.approx(expected)


def test_a_grip_without_length_is_refused() -> None:
    with pytest.raises(ValueError, match="grip length 0 mm"):
        GripSize(diameter=80.0, length=0.0)
