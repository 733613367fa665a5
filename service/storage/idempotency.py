"""A request that comes again makes nothing again: the ``Idempotency-Key`` of a client.

What a request made is kept beside its key in the transaction that made it, so that a client
whose line broke asks again and gets the same.
"""

import sqlite3
import time
from dataclasses import dataclass

from service.errors import Conflict

KEPT = 24 * 3600.0
"""s after which a key is free again"""


@dataclass(frozen=True, slots=True, kw_only=True)
class IdempotencyKey:
    """Idempotency key of a request: its owner, the key and a fingerprint."""

    owner: str
    key: str
    fingerprint: str
    """of method, path and body"""


def made_before(
    connection: sqlite3.Connection, idempotency: IdempotencyKey | None
) -> str | None:
    """Id of what the same request has made; None: it is new.

    Raises
    ------
    Conflict
        When the key came with another request, or what it made was deleted.
    """
    if idempotency is None:
        return None
    row = connection.execute(
        "SELECT fingerprint, made FROM requests WHERE owner = ? AND key = ? AND created >= ?",
        (idempotency.owner, idempotency.key, time.time() - KEPT),
    ).fetchone()
    if row is None:
        return None
    if row["fingerprint"] != idempotency.fingerprint:
        raise Conflict(f"Idempotency-Key '{idempotency.key}' came with another request before")
    made = str(row["made"])
    if not _is_there(connection, made):
        raise Conflict(
            f"Idempotency-Key '{idempotency.key}': what this request made was deleted"
        )
    return made


def _is_there(connection: sqlite3.Connection, made: str) -> bool:
    query = (
        "SELECT EXISTS (SELECT 1 FROM programs WHERE id = ?1) "
        "OR EXISTS (SELECT 1 FROM jobs WHERE id = ?1)"
    )
    return bool(connection.execute(query, (made,)).fetchone()[0])


def remember(
    connection: sqlite3.Connection, idempotency: IdempotencyKey | None, made: str
) -> None:
    """Keep what a request made, within the transaction that made it."""
    if idempotency is not None:
        connection.execute("DELETE FROM requests WHERE created < ?", (time.time() - KEPT,))
        connection.execute(
            "INSERT INTO requests VALUES (?, ?, ?, ?, ?)",
            (idempotency.owner, idempotency.key, idempotency.fingerprint, made, time.time()),
        )
