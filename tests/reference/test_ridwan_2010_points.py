"""Ridwan, Xu and Liu 2010, "Optimal results" and Fig. 9: points 1 to 10 by the real loop.

The case of Table 2 (0.29 kW, efficiency 0.9, 35 m/min, at most 0.5 mm/r) and the finish of
Table 1 (0.1 mm/rev, 1.5 mm), Ø18 of Fig. 11, with one tooth, for which feeds by tooth and by
revolution are the same. Depths and powers beside Table 2's are ours: the figure cannot be
read. Steel is Table 2's 1000 N/mm² up to point 4, then St37 (Table 1), ISCAR's 1350 N/mm² and
0.21; aluminium is AL6061, ISCAR's 800 N/mm² and 0.25.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from statistics import fmean
from typing import Any

import pytest

from service.trial.inputs import Inputs, changed
from service.trial.run import TrialRun

DIAMETER = 18.0
VELOCITY = 35.0 / 0.06
"""mm/s"""
TURNS = 35.0 / 0.06 / (pi * DIAMETER)
"""rev/s"""
EFFICIENCY = 0.9
GREATEST_FEED = 0.5
FINISH = 0.1
"""mm/rev, Table 1"""
LAWS = {"paper002": (1000.0, 0.0), "st37": (1350.0, 0.21), "al6061": (800.0, 0.25)}
NOISE = 0.01
"""of the loop: 3 % of a sample's force, the mean of a revolution's less"""

START = Inputs(
    material="paper002",
    tool_diameter_mm=DIAMETER,
    teeth=1,
    cutting_speed_m_min=35.0,
    feed_per_tooth_mm=GREATEST_FEED,
    axial_depth_mm=4.0,
    motor_power_kw=0.29,
)
CHANGES: dict[str, dict[str, Any]] = {
    "1": {},
    "2": {"axial_depth_mm": 3.0},
    "3": {"motor_power_kw": 0.2},
    "4": {"motor_power_kw": 0.29},
    "5": {"material": "st37"},
    "6": {"material": "al6061"},
    "7": {"mode": "QC", "feed_per_tooth_mm": FINISH, "axial_depth_mm": 1.5},
    "8": {"material": "st37"},
    "9": {"axial_depth_mm": 3.0},
    "10": {"motor_power_kw": 0.58},
    "10'": {"motor_power_kw": 0.1},
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """What the simulator's plots show at a point."""

    inputs: Inputs
    force: float
    power: float
    """of the drive, W"""
    removal_rate: float
    feed: float
    """mm/rev"""
    is_overloaded: bool


def points() -> Iterator[tuple[str, Point]]:
    run = TrialRun(START)
    for name, changes in CHANGES.items():
        run.change(changed(run.inputs, **changes))
        assert run.advance(run.time + 12.0)
        rows = [row for row in run.taken().moments if row.time > run.time - 4.0]
        yield (
            name,
            Point(
                inputs=run.inputs,
                force=fmean(row.force_true for row in rows),
                power=fmean(row.spindle_power_true for row in rows),
                removal_rate=fmean(row.removal_rate for row in rows),
                feed=fmean(row.feed_actual for row in rows) / TURNS,
                is_overloaded=run.status().is_overloaded,
            ),
        )


@pytest.fixture(scope="module")
def at() -> dict[str, Point]:
    return dict(points())


def force_of(feed: float, inputs: Inputs) -> float:
    """Eq. (4) of a full slot, k_s by Kienzle at h_m of eq. (1)."""
    k_c11, m_c = LAWS[inputs.material]
    return float(k_c11 * (2.0 * feed / pi) ** -m_c * inputs.axial_depth_mm * feed / pi)


def feed_at(force: float, inputs: Inputs) -> float:
    """Feed whose force is that."""
    _, m_c = LAWS[inputs.material]
    return float(0.1 * (force / force_of(0.1, inputs)) ** (1.0 / (1.0 - m_c)))


@pytest.mark.parametrize("name", CHANGES)
def test_every_point_is_that_of_the_equations(at: dict[str, Point], name: str) -> None:
    """Eqs. (4) to (6): the feed that was asked for, or the one that the motor can."""
    point, inputs = at[name], at[name].inputs
    bound = 1e6 * inputs.motor_power_kw * EFFICIENCY / VELOCITY
    asked = inputs.feed_per_tooth_mm
    feed = min(asked, feed_at(bound, inputs))
    force = force_of(feed, inputs)
    assert point.feed == pytest.approx(feed, rel=NOISE)
    assert point.force == pytest.approx(force, rel=NOISE)
    assert point.power == pytest.approx(force * VELOCITY / (1000.0 * EFFICIENCY), rel=NOISE)
    assert point.removal_rate == pytest.approx(
        feed * TURNS * DIAMETER * inputs.axial_depth_mm, rel=NOISE
    )
    # "In the graph, the warning is always kept in Safe Limit."
    assert not point.is_overloaded


def test_1_to_2_a_smaller_depth_raises_the_chip_load_at_the_same_force(
    at: dict[str, Point],
) -> None:
    assert at["2"].feed == pytest.approx(4.0 / 3.0 * at["1"].feed, rel=NOISE)
    assert at["2"].force == pytest.approx(at["1"].force, rel=NOISE)
    assert at["2"].force == pytest.approx(447.4, rel=NOISE)


def test_3_to_4_print_says_that_a_stronger_motor_lowers_all_three(at: dict[str, Point]) -> None:
    """They rise in proportion to it, eqs. (4) to (6)."""
    for name in ("force", "feed", "removal_rate"):
        ratio = getattr(at["4"], name) / getattr(at["3"], name)
        assert ratio == pytest.approx(0.29 / 0.2, rel=2.0 * NOISE)


def test_5_to_6_aluminium_raises_chip_load_and_removal_at_the_same_force(
    at: dict[str, Point],
) -> None:
    assert at["6"].force == pytest.approx(at["5"].force, rel=NOISE)
    for name in ("feed", "removal_rate"):
        assert getattr(at["6"], name) == pytest.approx(1.8 * getattr(at["5"], name), rel=0.02)


def test_table_2_s_steel_is_softer_than_aluminium_by_kienzle() -> None:
    """1000 N/mm² for steel: with it the feed would fall from 5 to 6."""
    aluminium = 800.0 * (2.0 * 0.4685 / pi) ** -0.25
    assert aluminium == pytest.approx(1083.0, abs=0.5)


def test_7_to_8_steel_keeps_the_feed_and_the_removal(at: dict[str, Point]) -> None:
    """Print: the force increases slightly; it goes with k_c, here by half."""
    assert at["8"].feed == pytest.approx(at["7"].feed, rel=1e-3)
    assert at["8"].removal_rate == pytest.approx(at["7"].removal_rate, rel=1e-3)
    chip = 2.0 * FINISH / pi
    ratio = 1350.0 * chip**-0.21 / (800.0 * chip**-0.25)
    assert ratio == pytest.approx(1.51, abs=0.005)
    assert at["8"].force == pytest.approx(ratio * at["7"].force, rel=NOISE)


def test_8_to_9_print_keeps_the_removal_rate_of_a_cut_twice_as_deep(
    at: dict[str, Point],
) -> None:
    """Its own eqs. (4) and (5) make power in proportion to it, and the force has doubled."""
    assert at["9"].feed == pytest.approx(at["8"].feed, rel=1e-3)
    assert at["9"].force == pytest.approx(2.0 * at["8"].force, rel=NOISE)
    assert at["9"].removal_rate == pytest.approx(2.0 * at["8"].removal_rate, rel=1e-3)


def test_9_to_10_a_motor_that_suffices_changes_nothing(at: dict[str, Point]) -> None:
    for name in ("force", "feed", "removal_rate"):
        assert getattr(at["10"], name) == pytest.approx(getattr(at["9"], name), rel=NOISE)


def test_9_to_10_a_motor_that_does_not_suffice_binds_the_finish_too(
    at: dict[str, Point],
) -> None:
    """In print no change of the motor's power influences a finish."""
    assert at["9"].power > 100.0
    assert at["10'"].power == pytest.approx(100.0, rel=NOISE)
    assert at["10'"].feed < 0.65 * FINISH
