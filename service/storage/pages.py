"""A list in pages: newest first, from a cursor on, which is an id and survives new entries."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from service.errors import Unreadable
from service.ids import is_id

T = TypeVar("T")

USUAL, MOST = 50, 500
"""entries of a page"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Page(Generic[T]):
    """Some entries, and where the next page begins; None: there is none."""

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
        """Ids of the page sort below this."""
        return self.cursor or "~"


def page_of(found: Sequence[T], ids: Sequence[str], *, limit: int) -> Page[T]:
    """A page of entries of which one more than the limit was looked for."""
    has_more = len(found) > limit
    return Page(items=tuple(found[:limit]), cursor=ids[limit - 1] if has_more else None)
