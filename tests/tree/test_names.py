"""A class name stands for one thing in the whole product."""

from benchmarks.house import ALLOWED, ROOT, entries, unreached
from tests.tree.sources import house


def test_a_class_name_exists_once() -> None:
    assert [name for name, count in house().classes().items() if count > 1] == []


def test_what_may_be_unreached_is_unreached() -> None:
    """The list of exceptions holds no name that is gone or has found a caller."""
    found = unreached(house(), house().reached(entries(ROOT)))
    assert set(ALLOWED) - set(map(".".join, found)) == set()
