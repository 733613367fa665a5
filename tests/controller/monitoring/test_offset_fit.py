"""The compiled fit of tooth offsets against the same fit in plain numpy."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.monitoring import offset_fit
from controller.monitoring.offsets import PLAIN, SCALE, unknown
from controller.signals.tooth_shares import ToothShares
from simulator.physics.tooth_means import LOST, Arcs, Floats, periods
from tests.controller import plain_offsets


def shares(teeth: int, seed: int, lost: int | None) -> ToothShares:
    """Shares of a cutter with runout, with noise, and perhaps with a lost tooth."""
    random = np.random.default_rng(seed)
    even = np.ones(teeth)
    entry = random.uniform(0.0, 2.0)
    arcs = Arcs(
        entry_angle=entry * even,
        exit_angle=min(entry + random.uniform(0.4, 3.0), pi) * even,
        lag=random.uniform(0.0, 0.5) * even,
    )
    at = periods(arcs, feed_per_tooth=0.08 * even, exponent=0.75, delay=0.02)
    offsets = random.normal(0.0, 0.01, teeth)
    if lost is not None:
        offsets[lost % teeth] = LOST
    force = random.uniform(300.0, 320.0, teeth) * plain_offsets.means(at, offsets[None])[0]
    taken = force / force.mean() + random.normal(0.0, 0.01, teeth)
    errors = random.normal(0.0, 0.01, (teeth, teeth))
    noise = errors @ errors.T + 0.015**2 * np.eye(teeth)
    return ToothShares(taken=taken, noise=noise, expected=310.0 * even, periods=at)


@settings(max_examples=40)
@given(
    teeth=st.integers(2, 8),
    seed=st.integers(0, 10_000),
    truth=st.sampled_from([None, 0, 1]),
    assumed=st.sampled_from([None, 0, 1]),
)
def test_the_fit_is_that_of_plain_numpy(
    teeth: int, seed: int, truth: int | None, assumed: int | None
) -> None:
    seen, prior = shares(teeth, seed, truth), unknown(teeth)
    settings_ = {"lost": assumed, "scale": SCALE, "plain": PLAIN * teeth}
    found = offset_fit.fitted(seen, prior.mean, prior.covariance, **settings_)  # type: ignore[arg-type]
    mean, covariance, misfit, determinant = plain_offsets.fitted(
        seen,
        prior.mean,
        prior.covariance,
        **settings_,  # type: ignore[arg-type]
    )
    assert found.misfit == pytest.approx(misfit, rel=1e-5, abs=1e-6)
    assert found.log_determinant == pytest.approx(determinant, rel=1e-5, abs=1e-5)
    np.testing.assert_allclose(found.mean, mean, atol=1e-7)
    np.testing.assert_allclose(found.covariance, covariance, atol=1e-9)


@settings(max_examples=40)
@given(teeth=st.integers(2, 8), seed=st.integers(0, 10_000))
def test_misfits_and_shares_are_those_of_plain_numpy(teeth: int, seed: int) -> None:
    seen = shares(teeth, seed, None)
    mean: Floats = np.random.default_rng(seed).normal(0.0, 0.01, teeth)
    np.testing.assert_allclose(
        seen.of(mean[None]), plain_offsets.shares_of(seen, mean[None]), rtol=1e-9, atol=1e-12
    )
    np.testing.assert_allclose(
        offset_fit.misfits(seen, mean, scale=SCALE),
        plain_offsets.misfits(seen, mean, scale=SCALE),
        rtol=1e-7,
    )


def test_a_singular_covariance_is_refused() -> None:
    seen, prior = shares(3, 1, None), unknown(3)
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        offset_fit.fitted(
            seen, prior.mean, np.zeros((3, 3)), lost=None, scale=SCALE, plain=PLAIN
        )
