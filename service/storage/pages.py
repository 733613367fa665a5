"""Pages of a list, newest first; a cursor is an id, so new entries do not disturb it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from service.errors import Unreadable
from service.ids import is_id

T = TypeVar("T")

USUAL, MOST = 50, 500
"""Default and largest number of entries per page."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Page(Generic[T]):
    """Page of a list, with the cursor of the next page; None on the last page."""

    items: tuple[T, ...]
    cursor: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PageCursor:
    """Limit and cursor of a page.

    Raises
    ------
    Unreadable
        When the cursor is unknown.
    """

    limit: int = USUAL
    cursor: str | None = None

    def __post_init__(self) -> None:
        if self.cursor is not None and not is_id(self.cursor):
            raise Unreadable("unknown page cursor")

    @property
    def before(self) -> str:
        """Upper bound (exclusive) of the ids on the page."""
        return self.cursor or "~"


def page_of(entries: Sequence[T], ids: Sequence[str], *, limit: int) -> Page[T]:
    """Build a page from entries of which one more than the limit was queried."""
    has_more = len(entries) > limit
    return Page(items=tuple(entries[:limit]), cursor=ids[limit - 1] if has_more else None)
