"""Flank wear by the force, and what is not wear."""

from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.ports import Floats
from controller.tool_life import (
    ToolLife,
    WearMonitorSettings,
    compared_anew,
    lived,
    new_tool,
)
from simulator.physics.tool_life import LIFE_CRITERION

LAND_SHARE = 1.85
"""1/mm, what flank wear adds to the ratio: as in steel at a chip of about 0.1 mm"""

LEARNING = WearMonitorSettings().learning
MEMORY = WearMonitorSettings().memory


def lifetime(ratios: Floats, life: ToolLife | None = None) -> list[ToolLife]:
    """The tool after each of the revolutions with these measured over expected forces."""
    now, found = life or new_tool(), []
    for ratio in np.log(ratios).tolist():
        now = lived(now, ratio, land_share=LAND_SHARE)
        found.append(now)
    return found


def wearing(count: int, until: float) -> Floats:
    """Ratio in each revolution while VB grows in a straight line, of work as expected."""
    return worn(np.linspace(0.0, until, count))


def worn(flank: Floats | float, *, work: Floats | float = 1.0) -> Floats:
    """Ratio at some flank wear, in work that takes a factor of the expected force."""
    return np.asarray(work + LAND_SHARE * np.asarray(flank))


@given(vb=st.floats(0.0, 0.3), work=st.floats(0.5, 2.0), share=st.floats(0.5, 8.0))
def test_wear_is_what_the_ratio_gains_over_what_a_millimetre_adds(
    vb: float, work: float, share: float
) -> None:
    """Whatever the work is like, and however thin the chips are."""
    by = WearMonitorSettings(allowance=1e3)
    life = new_tool()
    for _ in range(LEARNING):
        life = lived(life, log(work), land_share=share, by=by)
    for _ in range(10 * MEMORY):
        life = lived(life, log(work + share * vb), land_share=share, by=by)
    assert life.flank_wear == pytest.approx(vb, abs=1e-3)


def test_force_below_that_of_a_sharp_tool_is_no_wear() -> None:
    life = lifetime(np.concatenate((np.full(LEARNING, 1.0), np.full(MEMORY, 0.97))))[-1]
    assert life.flank_wear == 0.0


def test_where_nobody_knows_what_wear_adds_none_is_told() -> None:
    life = new_tool(0.1)
    for _ in range(MEMORY):
        life = lived(life, log(1.5), land_share=0.0)
    assert life.flank_wear == 0.1


@given(ratio=st.floats(0.6, 3.0), flank=st.floats(0.0, 0.25))
def test_what_the_catalogue_has_wrong_is_no_wear(ratio: float, flank: float) -> None:
    life = lifetime(np.full(2 * LEARNING, ratio), new_tool(flank))[-1]
    assert life.flank_wear == pytest.approx(flank, abs=1e-9)
    assert life.ratio == pytest.approx(ratio)
    assert life.changes == ()


def test_new_tool_is_what_it_is_said_to_be() -> None:
    assert new_tool().flank_wear == 0.0
    assert new_tool(0.1).flank_wear == pytest.approx(0.1)
    with pytest.raises(ValueError, match=r"flank wear -0\.1 mm"):
        new_tool(-0.1)


@pytest.mark.parametrize("seed", range(2))
def test_slow_wear_is_followed_to_the_end_of_the_life(seed: int) -> None:
    """0.35 mm in 20000 revolutions, 7 min at 3000 rpm; 3 % noise."""
    noise = np.random.default_rng(seed).normal(0.0, 0.03, 20_000)
    truth = np.linspace(0.0, 0.35, 20_000)
    lives = lifetime(worn(truth, work=1.15) * np.exp(noise))
    found = np.array([life.flank_wear for life in lives])
    assert np.abs(found - truth)[LEARNING:].max() < 0.03
    worn_out = next(row for row, life in enumerate(lives) if life.is_worn_out)
    assert truth[worn_out] == pytest.approx(LIFE_CRITERION, abs=0.025)
    assert lives[-1].changes == ()


def test_mean_lags_behind_a_ramp_by_slope_times_memory() -> None:
    """The closed form of an exponential mean with part a: slope · (1 − a) / a."""
    slope = 1e-4
    life = lifetime(np.exp(slope * np.arange(3000)))[-1]
    assert slope * 2999 - life.log_ratio == pytest.approx(slope * (MEMORY - 1), rel=1e-3)
    assert life.changes == ()


@pytest.mark.parametrize("factor", [1.3, 1.15, 0.87, 0.75])
@pytest.mark.parametrize("seed", range(3))
def test_harder_or_softer_work_is_no_wear(factor: float, seed: int) -> None:
    count, at = 6000, 3000
    noise = np.random.default_rng(seed).normal(0.0, 0.03, count)
    jump = np.where(np.arange(count) < at, 1.0, factor)
    truth = np.linspace(0.0, 0.12, count)
    lives = lifetime(worn(truth, work=jump) * np.exp(noise))
    seen = next(row for row, life in enumerate(lives) if life.changes)
    assert at <= seen <= at + 12
    assert len(lives[-1].changes) == 1
    assert lives[-1].changes[0] == pytest.approx(log(factor), abs=0.08)
    # Just then, and to the end.
    assert lives[at + 20].flank_wear == pytest.approx(0.06, abs=0.02)
    assert lives[-1].flank_wear == pytest.approx(0.12, abs=0.025)
    assert lives[-1].ratio == pytest.approx(factor + LAND_SHARE * 0.12, rel=0.02)


@pytest.mark.parametrize("factor", [0.7, 0.9, 1.1, 1.5])
def test_change_of_the_work_is_no_wear_at_all_without_noise(factor: float) -> None:
    before = lifetime(np.full(2 * MEMORY, 1.2), new_tool(0.1))[-1]
    after = lifetime(np.full(2 * MEMORY, 1.2 * factor), before)[-1]
    assert len(after.changes) == 1
    assert after.flank_wear == pytest.approx(0.1, abs=1e-9)
    assert after.ratio == pytest.approx(1.2 * factor)


def test_change_is_seen_after_as_many_revolutions_as_the_sum_takes() -> None:
    """Without noise, away from the learning: n·(δ − allowance) > decision, the mean moving."""
    by = WearMonitorSettings()
    for factor in (1.1, 1.3):
        ratios = np.where(np.arange(400) < 300, 1.0, factor)
        seen = next(row for row, life in enumerate(lifetime(ratios)) if life.changes)
        least = by.decision / (log(factor) - by.allowance)
        assert least <= seen - 299 <= 1.5 * least + 1.0


@pytest.mark.parametrize("deviation", [0.03, 0.08, 0.2])
def test_noise_is_no_change(deviation: float) -> None:
    noise = np.random.default_rng(4).normal(0.1, deviation, 10_000)
    assert lifetime(np.exp(noise))[-1].changes == ()


def test_change_that_is_known_of_leaves_the_wear() -> None:
    before = lifetime(wearing(3000, 0.15))[-1]
    other = compared_anew(before)
    assert other.flank_wear == pytest.approx(before.flank_wear)
    after = lifetime(np.full(200, 2.0), other)[-1]
    assert after.flank_wear == pytest.approx(before.flank_wear, abs=1e-9)
    assert after.ratio == pytest.approx(2.0)
    assert after.changes == ()


def test_wear_goes_on_from_where_it_was() -> None:
    """Within what the mean lags behind so quick a wear, once at the change and once now."""
    before = lifetime(wearing(4000, 0.2))[-1]
    rest = worn(np.linspace(0.2, 0.35, 4000), work=0.8)
    after = lifetime(rest, compared_anew(before))[-1]
    lag = (0.2 / 4000 + 0.15 / 4000) * MEMORY
    assert 0.35 - 1.5 * lag < after.flank_wear < 0.35
    assert after.is_worn_out


def test_ratio_is_one_before_anything_was_measured() -> None:
    assert new_tool().ratio == 1.0
    assert exp(lived(new_tool(), log(1.2), land_share=LAND_SHARE).log_ratio) == pytest.approx(
        1.2
    )


@pytest.mark.parametrize("name", ["memory", "learning", "allowance", "decision"])
def test_watchfulness_is_positive(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} 0 must be greater"):
        WearMonitorSettings(**{name: 0})
