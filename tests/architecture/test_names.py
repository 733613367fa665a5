"""A class name stands for one thing in the whole product."""

from benchmarks.house import ALLOWED, PRODUCT, ROOT, House, entries, unreached

HOUSE = House(ROOT, PRODUCT)


def test_a_class_name_exists_once() -> None:
    assert [name for name, count in HOUSE.classes().items() if count > 1] == []


def test_what_may_be_unreached_is_unreached() -> None:
    """The list of exceptions holds no name that is gone or has found a caller."""
    found = unreached(HOUSE, HOUSE.reached(entries(ROOT)))
    assert set(ALLOWED) <= set(map(".".join, found))
