"""Database calls of the storage, the same for SQLite and PostgreSQL.

Statements are written once, with ``?`` for values and names for columns. Both databases know
the function ``wall_clock()`` (s since 1970; a server's clock is the same for all hosts) and
``json_extract(text, '$.name')``.
"""

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from typing import Any, Protocol


class StoredRow(Protocol):
    """Row of an answer; values by column name."""

    def __getitem__(self, name: str, /) -> Any:
        """Return the value of a column."""
        ...

    def keys(self) -> Iterable[str]:
        """Return the column names."""
        ...


class StatementAnswer(Protocol):
    """Answer to a statement."""

    @property
    def rowcount(self) -> int:
        """Number of changed rows."""
        ...

    def fetchone(self) -> Any:
        """Return the next row; None after the last."""
        ...

    def fetchall(self) -> list[Any]:
        """Return all rows."""
        ...


class Connection(Protocol):
    """Connection to the database of the service."""

    @property
    def skip_locked(self) -> str:
        """End of a query for a row to change that no other transaction is changing."""
        ...

    def execute(self, statement: str, values: Sequence[Any] = (), /) -> StatementAnswer:
        """Execute a statement."""
        ...

    def lock(self, name: str) -> None:
        """Let no other transaction lock or share a name until this one has ended."""
        ...

    def share(self, name: str) -> None:
        """Let no other transaction lock a name until this one has ended."""
        ...


class Database(Protocol):
    """Database of the service."""

    @property
    def is_shared(self) -> bool:
        """True if several hosts may use the database at once."""
        ...

    def reading(self) -> AbstractContextManager[Connection]:
        """Provide a connection for queries."""
        ...

    def writing(self) -> AbstractContextManager[Connection]:
        """Provide a connection within a transaction, which is rolled back on error."""
        ...

    def close(self) -> None:
        """Close idle connections."""
        ...
