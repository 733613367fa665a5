"""What is told of slow tests is told of tests that there are."""

from pathlib import Path

from tests.distribution import LONGEST
from tests.slow import SLOW

TESTS = Path(__file__).parents[1]


def test_slow_places_exist() -> None:
    assert [place for place in SLOW if not (TESTS / place).exists()] == []


def test_groups_that_begin_first_exist() -> None:
    assert [group for group in LONGEST if not (TESTS.parent / group).exists()] == []


def test_slow_places_are_in_order_and_named_once() -> None:
    assert list(SLOW) == sorted(set(SLOW))
