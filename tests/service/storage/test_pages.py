"""Pages of a list: nothing is shown twice, nothing is left out, whatever is added meanwhile."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.errors import Unreadable
from service.ids import LENGTH, LETTERS
from service.storage.pages import Page, PageCursor, page_of
from tests.every_case import every_case

Ids = st.sets(st.text(LETTERS, min_size=LENGTH, max_size=LENGTH), max_size=40)


def page(known: list[str], place: PageCursor) -> Page[str]:
    """As the database answers: newest first below the cursor, one more than asked for."""
    found = sorted((id for id in known if id < place.before), reverse=True)
    found = found[: place.limit + 1]
    return page_of(found, found, limit=place.limit)


@given(Ids, Ids, st.integers(1, 12))
def test_walking_shows_each_once_though_newer_ones_are_added(
    first: set[str], added: set[str], limit: int
) -> None:
    known, newer = [f"0{id[1:]}" for id in first], [f"z{id[1:]}" for id in added]
    wanted, cursor = sorted(set(known), reverse=True), None
    shown: list[str] = []
    known = list(set(known))
    while True:
        found = page(known, PageCursor(limit=limit, cursor=cursor))
        assert len(found.items) <= limit
        shown += found.items
        cursor = found.cursor
        if cursor is None:
            break
        assert len(found.items) == limit
        # Ids sort by time: what is added meanwhile sorts above all that was there.
        known += newer
    assert [id for id in shown if id in wanted] == wanted
    assert len(shown) == len(set(shown))


def test_the_last_page_has_no_cursor() -> None:
    assert page_of(["b", "a"], ["b", "a"], limit=2) == Page(items=("b", "a"), cursor=None)
    assert page_of(["b", "a"], ["b", "a"], limit=1) == Page(items=("b",), cursor="b")
    assert page_of([], [], limit=1) == Page(items=(), cursor=None)


@every_case("cursor", ["", "x", "0" * 27, "' OR 1=1 --", f"{'0' * 26}\n"])
def test_a_cursor_that_no_page_gave_is_refused(cursor: str) -> None:
    with pytest.raises(Unreadable, match="cursor"):
        PageCursor(cursor=cursor)
