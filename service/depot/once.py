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
class Once:
    """Whose request, its key and what tells it from others."""

    owner: str
    key: str
    fingerprint: str
    """of method, path and body"""


def made_before(connection: sqlite3.Connection, once: Once | None) -> str | None:
    """Id of what the same request has made; None: it is new.

    Raises
    ------
    Conflict
        When the key came with another request.
    """
    if once is None:
        return None
    connection.execute("DELETE FROM requests WHERE created < ?", (time.time() - KEPT,))
    row = connection.execute(
        "SELECT fingerprint, made FROM requests WHERE owner = ? AND key = ?",
        (once.owner, once.key),
    ).fetchone()
    if row is None:
        return None
    if row["fingerprint"] != once.fingerprint:
        raise Conflict(f"Idempotency-Key '{once.key}' came with another request before")
    return str(row["made"])


def remember(connection: sqlite3.Connection, once: Once | None, made: str) -> None:
    """Keep what a request made, within the transaction that made it."""
    if once is not None:
        connection.execute(
            "INSERT INTO requests VALUES (?, ?, ?, ?, ?)",
            (once.owner, once.key, once.fingerprint, made, time.time()),
        )
