"""What is told of slow tests is told of tests that there are."""

from pathlib import Path

import pytest

from tests.slow import SLOW

TESTS = Path(__file__).parents[1]


@pytest.mark.parametrize("place", SLOW)
def test_a_slow_place_exists(place: str) -> None:
    assert (TESTS / place).exists()


def test_slow_places_are_in_order_and_named_once() -> None:
    assert list(SLOW) == sorted(set(SLOW))
