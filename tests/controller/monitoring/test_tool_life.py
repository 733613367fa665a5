"""Flank wear by the force, and what is not wear."""

from math import exp, log, nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.monitoring.tool_life import (
    Ratios,
    ToolLife,
    WearMonitorSettings,
    compared_anew,
    lived,
    new_tool,
)
from controller.signals.ports import Floats
from simulator.physics.flank import CUTTING, NORMAL
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.tool_life import LIFE_CRITERION

LAND_SHARE = 1.85
"""1/mm, what flank wear adds to the ratio: as in steel at a chip of about 0.1 mm"""

LEARNING = WearMonitorSettings().learning
PERIOD = 0.02
"""s"""


def lifetime(
    ratios: Floats,
    life: ToolLife | None = None,
    *,
    share: Floats | float = LAND_SHARE,
    normal: Floats | None = None,
) -> list[ToolLife]:
    """The tool after each of the revolutions with these measured over expected forces."""
    now, found = life or new_tool(), []
    shares = np.broadcast_to(np.asarray(share, dtype=np.float64), ratios.shape)
    normals = np.full(ratios.shape, nan) if normal is None else normal
    for ratio, each, across in zip(ratios, shares, normals, strict=True):
        at = Ratios(
            log_ratio=log(ratio), land_share=float(each), period=PERIOD, normal=float(across)
        )
        now = lived(now, at)
        found.append(now)
    return found


def worn(
    flank: Floats | float, *, work: Floats | float = 1.0, share: Floats | float = LAND_SHARE
) -> Floats:
    """Ratio at some flank wear, in work that takes a factor of the expected force."""
    return np.asarray(work + share * np.asarray(flank))


def noisy(ratios: Floats, seed: int, deviation: float = 0.03) -> Floats:
    """The ratios with the noise of single revolutions."""
    found: Floats = ratios * np.exp(
        np.random.default_rng(seed).normal(0.0, deviation, len(ratios))
    )
    return found


def test_where_nobody_knows_what_wear_adds_none_is_told() -> None:
    life = lifetime(np.full(300, 1.5), new_tool(0.1), share=0.0)[-1]
    assert life.flank_wear == pytest.approx(0.1, abs=1e-9)


@settings(max_examples=20)
@given(ratio=st.floats(0.6, 2.9), flank=st.floats(0.0, 0.25))
def test_what_the_catalogue_has_wrong_is_no_wear(ratio: float, flank: float) -> None:
    """At three times the catalogue, the rest of the learning is told as a change of 10 %."""
    life = lifetime(worn(flank, work=ratio) * np.ones(4 * LEARNING), new_tool(flank))[-1]
    assert life.flank_wear == pytest.approx(flank, abs=0.01)
    assert life.changes == ()


def test_new_tool_is_what_it_is_said_to_be() -> None:
    assert (new_tool().flank_wear, new_tool().hardness) == (0.0, 1.0)
    assert new_tool(0.1).flank_wear == pytest.approx(0.1)
    with pytest.raises(ValueError, match=r"flank wear -0\.1 mm"):
        new_tool(-0.1)


@pytest.mark.parametrize(("rate", "seed"), [(0.1, 0), (0.15, 1), (0.15, 2), (0.5, 3)])
def test_wear_of_any_rate_is_followed_and_is_no_hardness(rate: float, seed: int) -> None:
    """mm/min, to the end of the life; 0.15 was taken for harder work."""
    count = round(0.33 / (rate / 60.0) / PERIOD)
    truth = np.linspace(0.0, 0.33, count)
    lives = lifetime(noisy(worn(truth, work=1.15), seed))
    found = np.array([life.flank_wear for life in lives])
    assert np.abs(found - truth)[LEARNING:].max() < 0.05
    worn_out = next(row for row, life in enumerate(lives) if life.is_worn_out)
    assert truth[worn_out] == pytest.approx(LIFE_CRITERION, abs=0.03)
    assert lives[-1].changes == ()


@pytest.mark.parametrize(("factor", "seed"), [(1.3, 0), (1.2, 1), (1.2, 2), (0.87, 3)])
def test_harder_or_softer_work_is_no_wear(factor: float, seed: int) -> None:
    """While the tool wears too: each is told for what it is."""
    count, at = 6000, 3000
    jump = np.where(np.arange(count) < at, 1.0, factor)
    truth = np.linspace(0.0, 0.12, count)
    lives = lifetime(noisy(worn(truth, work=jump), seed))
    seen = next(row for row, life in enumerate(lives) if life.changes)
    assert at <= seen <= at + 15
    assert len(lives[-1].changes) == 1
    assert lives[-1].changes[0] == pytest.approx(log(factor), abs=0.08)
    assert lives[at + 20].flank_wear == pytest.approx(0.06, abs=0.02)
    assert lives[-1].flank_wear == pytest.approx(0.12, abs=0.03)
    assert lives[-1].hardness == pytest.approx(factor, rel=0.06)


@pytest.mark.parametrize("seed", range(5))
def test_hard_work_from_the_start_is_never_wear(seed: int) -> None:
    life = lifetime(noisy(np.full(3000, 1.2), seed, 0.05))[-1]
    assert life.flank_wear < 0.05
    assert not life.is_worn_out
    assert life.changes == ()


def test_wear_is_seen_in_the_part_of_the_force_that_does_not_fall_with_the_feed() -> None:
    """A worn tool of which nothing was known: at one feed it might be harder work."""
    slow = 0.3**-0.75
    share = np.where(np.arange(2000) % 400 < 200, LAND_SHARE, slow * LAND_SHARE)
    unsure = new_tool(0.0)
    free = lifetime(noisy(worn(0.0) * np.ones(100), 0), unsure)[-1]
    grown = np.linspace(0.0, 0.2, 2000)
    life = lifetime(noisy(worn(grown, work=1.1, share=share), 1), free, share=share)[-1]
    assert life.flank_wear == pytest.approx(0.2, abs=0.02)
    assert life.hardness == pytest.approx(1.1, abs=0.05)
    assert "does not fall with the feed" in life.basis
    assert "does not fall with the feed" not in free.basis


@pytest.mark.parametrize("flank", [0.0, 0.15])
def test_normal_force_tells_a_chipped_edge_from_harder_work(flank: float) -> None:
    """A sudden rise by three tenths, of which only the normal force shows the cause."""
    count, at = 1200, 600
    after = np.arange(count) >= at
    jump = np.where(after, flank, 0.0)
    work = np.where(after, 1.3 - LAND_SHARE * flank, 1.0)
    force = worn(jump, work=work)
    across = work * RADIAL_SHARE + jump * LAND_SHARE * NORMAL / CUTTING
    life = lifetime(noisy(force, 3, 0.01), normal=noisy(across, 4, 0.01))[-1]
    assert len(life.changes) == 1
    assert life.flank_wear == pytest.approx(flank, abs=0.03)
    assert life.hardness == pytest.approx(work[-1], abs=0.06)
    assert "normal" in life.basis


@pytest.mark.parametrize("deviation", [0.03, 0.08, 0.2])
def test_noise_is_no_change(deviation: float) -> None:
    noise = np.random.default_rng(4).normal(0.1, deviation, 5000)
    life = lifetime(np.exp(noise))[-1]
    assert life.changes == ()
    assert not life.is_worn_out


def test_another_cut_of_the_tool_leaves_the_wear() -> None:
    before = lifetime(worn(np.linspace(0.0, 0.15, 3000)))[-1]
    other = compared_anew(before)
    assert other.flank_wear == pytest.approx(before.flank_wear)
    # The plan errs by a tenth in the other cut.
    after = lifetime(np.full(500, 1.1 + LAND_SHARE * 0.15), other)[-1]
    assert after.flank_wear == pytest.approx(0.15, abs=0.03)
    assert after.changes == ()


def test_ratio_that_falls_below_that_of_a_sharp_tool_is_no_wear() -> None:
    life = lifetime(np.concatenate((np.full(LEARNING, 1.0), np.full(300, 0.97))))[-1]
    assert life.flank_wear < 0.005


def test_share_of_the_land_is_what_it_adds() -> None:
    life = lifetime(worn(np.linspace(0.0, 0.2, 4000)))[-1]
    assert life.share(LAND_SHARE) == pytest.approx(0.37 / 1.37, abs=0.03)
    assert exp(0.0) == pytest.approx(life.hardness, abs=0.05)


@pytest.mark.parametrize("name", ["memory", "learning", "allowance", "decision"])
def test_watchfulness_is_positive(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} 0 must be greater"):
        WearMonitorSettings(**{name: 0})


WRONG = {
    "entry": np.linspace(3.2, 1.5, 25),
    "exit": np.concatenate((np.full(300, 1.3), np.linspace(1.3, 0.4, 25))),
}
"""Ratios where a recording dates an entry or an exit wrongly."""


@pytest.mark.parametrize("where", WRONG)
def test_what_is_dated_wrongly_is_no_noise_and_is_left_behind(where: str) -> None:
    ratios = np.concatenate((WRONG[where], np.full(60, 1.3)))
    life = lifetime(noisy(ratios, 5, 0.005))[-1]
    assert life.hardness == pytest.approx(1.3, rel=0.05)
    assert life.flank_wear < 0.01


@settings(max_examples=100)
@given(
    readings=st.lists(
        st.tuples(st.floats(0.05, 20.0), st.floats(0.1, 20.0), st.floats(0.0, 5.0)),
        min_size=1,
        max_size=60,
    )
)
def test_no_readings_make_work_or_wear_negative(
    readings: list[tuple[float, float, float]],
) -> None:
    ratios, shares, normal = np.array(readings).T
    for life in lifetime(ratios, share=shares, normal=normal):
        assert life.hardness > 0.0
        assert life.belief.mean[1:].min() >= 0.0
        assert np.isfinite(life.belief.covariance).all()


def test_the_factor_that_is_recorded_is_without_the_wear() -> None:
    flank = np.linspace(0.0, 0.2, 4000)
    life = lifetime(noisy(worn(flank), 3))[-1]
    assert life.is_wear_sure
    whole = log(float(worn(0.2)))
    assert life.sharp(whole, LAND_SHARE) == pytest.approx(0.0, abs=0.05)
    assert new_tool().sharp(whole, LAND_SHARE) == whole


def test_a_wear_that_an_error_of_the_plan_may_be_is_not_sure() -> None:
    """The force of 0.012 mm is two per cent: less than a plan knows, whatever the noise."""
    shares = np.where(np.arange(6000) % 40 < 20, 1.0, 3.0)
    life = lifetime(1.0 + 0.012 * shares, share=shares)[-1]
    noise = float(np.sqrt(life.belief.covariance[2, 2]))
    assert 3.0 * noise < life.flank_wear < 0.02
    assert not life.is_wear_sure
