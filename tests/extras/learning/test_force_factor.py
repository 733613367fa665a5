"""The factor on k_c and the idle power of a machine, as least squares have them."""

import numpy as np
import pytest

from extras.learning.models import force_factor_of
from extras.learning.table import Features, LearningTable

FEATURES = Features(numbers=("feed_mm_s",), names={})


def runs(count: int, *, noise: float, rng: np.random.Generator) -> LearningTable:
    cutting = rng.uniform(500.0, 1500.0, count)
    physics = 800.0 + cutting
    measured = physics + 60.0 + 0.15 * cutting + noise * rng.standard_normal(count)
    return LearningTable(
        features=FEATURES,
        values=cutting[:, None],
        target=measured,
        physics=physics,
        cutting=cutting,
    )


def test_factor_and_offset_are_found_exactly_from_pieces() -> None:
    rng = np.random.default_rng(1)
    found = force_factor_of([runs(each, noise=0.0, rng=rng) for each in (1, 20, 9)])
    assert found is not None
    assert (found.factor, found.offset) == pytest.approx((1.15, 60.0))
    assert found.runs == 30
    predicted = found.predict(np.array([1800.0]), np.array([1000.0]))
    assert predicted.tolist() == pytest.approx([2010.0])


def test_the_errors_are_those_of_repeated_fits() -> None:
    rng = np.random.default_rng(2)
    found = [force_factor_of([runs(40, noise=20.0, rng=rng)]) for _ in range(400)]
    kept = [each for each in found if each is not None]
    for name in ("factor", "offset"):
        spread = np.std([getattr(each, name) for each in kept])
        told = np.mean([getattr(each, f"{name}_error") for each in kept])
        assert told == pytest.approx(spread, rel=0.15)


def test_without_a_cut_that_varies_there_is_no_factor() -> None:
    table = runs(30, noise=1.0, rng=np.random.default_rng(3))
    same = LearningTable(
        features=FEATURES,
        values=table.values,
        target=table.target,
        physics=table.physics,
        cutting=np.full(30, 1000.0),
    )
    none = LearningTable(
        features=FEATURES, values=table.values, target=table.target, physics=table.physics
    )
    assert force_factor_of([same]) is None
    assert force_factor_of([none]) is None
    assert force_factor_of([]) is None
