"""Power laws: exact where the rows follow one, and the same from pieces as from all rows."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest

from extras.learning.models import fitted_law, logarithms
from extras.learning.table import Features, Floats, LearningTable

FEATURES = Features(numbers=("feed_mm_s", "flank_wear_mm"), names={"machine": ("a", "b", "c")})


def rows(count: int, *, noise: float = 0.0) -> LearningTable:
    rng = np.random.default_rng(2)
    feed, wear = rng.uniform(30.0, 90.0, count), rng.uniform(0.0, 0.3, count)
    machine = rng.integers(0, 3, count)
    factor = np.array([1.0, 2.0, 0.5])[machine]
    power = 5.0 * feed**0.7 * np.exp(1.2 * wear) * factor
    return LearningTable(
        features=FEATURES,
        values=np.stack((feed, wear, machine), axis=1),
        target=power * np.exp(noise * rng.standard_normal(count)),
        physics=None,
    )


def in_pieces(table: LearningTable) -> Iterator[LearningTable]:
    for first, last in pairwise((0, 1, 50, 51, len(table))):
        part = slice(first, last)
        yield LearningTable(
            features=FEATURES,
            values=table.values[part],
            target=table.target[part],
            physics=None,
        )


def test_a_power_law_is_found_exactly() -> None:
    law = fitted_law(FEATURES, in_pieces(rows(80)))
    assert law.constant == pytest.approx(np.log(5.0))
    assert law.coefficients == pytest.approx((0.7, 1.2, np.log(2.0), np.log(0.5)))
    one: Floats = np.array([[60.0, 0.0, 1.0]])
    assert law.predict(one).tolist() == pytest.approx([10.0 * 60.0**0.7])


def test_pieces_give_the_least_squares_of_all_rows() -> None:
    table = rows(300, noise=0.2)
    law = fitted_law(FEATURES, in_pieces(table))
    design = np.column_stack((np.ones(300), logarithms(FEATURES, table.values)))
    expected, *_ = np.linalg.lstsq(design, np.log(table.target), rcond=None)
    assert (law.constant, *law.coefficients) == pytest.approx(expected.tolist())


def test_columns_that_say_the_same_are_no_fault() -> None:
    table = rows(40)
    same = np.column_stack((table.values[:, 0], table.values[:, 0]))
    features = Features(numbers=("feed_mm_s", "depth_mm"), names={})
    twice = LearningTable(
        features=features, values=same, target=same[:, 0] ** 0.6, physics=None
    )
    assert fitted_law(features, [twice]).coefficients == pytest.approx((0.3, 0.3))
