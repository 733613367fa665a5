"""Offsets of teeth are learnt from forces that another model makes."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.monitoring.offsets import OUTLIER, Offsets, judged, misfits, unknown
from controller.signals.ports import Floats
from controller.signals.tooth_shares import ToothShares, shares_of
from tests.controller.cutter import EXPONENT, FEED_PER_TOOTH, Cutter, noisy, shown


def shares(cutter: Cutter, forces: Floats, *, feed: float = FEED_PER_TOOTH) -> ToothShares:
    revolution = shown(forces, feed=feed)
    return shares_of(revolution, cutter.expected, exponent=EXPONENT, change=0.0)


def learnt(cutter: Cutter, *, count: int = 20, seed: int = 1) -> Offsets:
    random = np.random.default_rng(seed)
    offsets = unknown(cutter.teeth)
    for _ in range(count):
        offsets = judged(offsets, shares(cutter, noisy(cutter.forces(), random))).offsets
    return offsets


@pytest.mark.parametrize("teeth", [2, 3, 4, 6])
@pytest.mark.parametrize("eccentricity", [0.0, 0.01, 0.02])
def test_an_eccentricity_is_found_to_three_micrometres(teeth: int, eccentricity: float) -> None:
    """As differences between teeth: chips know no others."""
    cutter = Cutter(teeth=teeth, eccentricity=eccentricity)
    truth = eccentricity * np.cos(2.0 * pi / teeth * np.arange(teeth))
    error = learnt(cutter).mean - truth
    assert np.ptp(error) < 0.003


@given(seed=st.integers(0, 2**32 - 1), eccentricity=st.floats(0.0, 0.03))
def test_what_is_learnt_is_known_better_and_stays_a_distribution(
    seed: int, eccentricity: float
) -> None:
    cutter = Cutter(eccentricity=eccentricity)
    offsets = learnt(cutter, count=3, seed=seed)
    values, before = np.linalg.eigvalsh(offsets.covariance), unknown(4).covariance
    assert values.min() >= -1e-12
    assert np.trace(offsets.covariance) < np.trace(before)


def test_a_lost_tooth_fits_its_own_loss_alone() -> None:
    cutter = Cutter(eccentricity=0.01)
    offsets = learnt(cutter)
    for lost in range(4):
        broken = misfits(offsets, shares(cutter, cutter.forces(broken=lost)))
        assert broken.argmin() == 1 + lost
        assert broken[1 + lost] < OUTLIER * 4 < broken[0]
    whole = misfits(offsets, shares(cutter, cutter.forces()))
    assert whole.argmin() == 0


def test_offsets_hold_at_another_feed() -> None:
    cutter = Cutter(eccentricity=0.01)
    feed = 0.5 * FEED_PER_TOOTH
    found = judged(learnt(cutter), shares(cutter, cutter.forces(feed), feed=feed))
    assert found.misfit < 4.0


def test_what_no_offsets_explain_teaches_nothing() -> None:
    """Two teeth that take all are none that runout makes."""
    offsets = learnt(Cutter())
    forces = np.array([900.0, 900.0, 0.0, 0.0])[:, None] * np.ones(8)
    found = judged(offsets, shares(Cutter(), forces))
    assert found.misfit > OUTLIER * 4
    assert found.offsets is offsets
