"""Idempotency keys: a repeated request returns what the first one created.

The id of what a request created is stored with its key in the same transaction, so that a
client may repeat a request after a broken connection and get the same answer.
"""

import time
from dataclasses import dataclass

from service.errors import Conflict
from service.storage.connection import Connection

KEPT = 24 * 3600.0
"""Time after which a key may be used again, in s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IdempotencyKey:
    """Idempotency key of a request: its owner, the key and a fingerprint."""

    owner: str
    """Id of the API key, which another key of the same name does not share; else a name."""
    key: str
    fingerprint: str
    """Hash of method, path and body."""


def made_before(connection: Connection, idempotency: IdempotencyKey | None) -> str | None:
    """Return the id of what the same request created before; None if it is new.

    Raises
    ------
    Conflict
        When the key was used for another request, or what it created was deleted.
    """
    if idempotency is None:
        return None
    # The same request may arrive at two hosts at once.
    connection.lock(f"request {idempotency.owner} {idempotency.key}")
    row = connection.execute(
        "SELECT fingerprint, made FROM requests WHERE owner = ? AND key = ? AND created >= ?",
        (idempotency.owner, idempotency.key, time.time() - KEPT),
    ).fetchone()
    if row is None:
        return None
    if row["fingerprint"] != idempotency.fingerprint:
        raise Conflict(f"Idempotency-Key '{idempotency.key}' was used for another request")
    made = str(row["made"])
    if not _is_there(connection, made):
        raise Conflict(
            f"Idempotency-Key '{idempotency.key}': what this request created was deleted"
        )
    return made


def _is_there(connection: Connection, made: str) -> bool:
    query = (
        "SELECT 1 FROM programs WHERE id = ? UNION ALL SELECT 1 FROM jobs WHERE id = ? "
        "UNION ALL SELECT 1 FROM files WHERE id = ?"
    )
    return connection.execute(query, (made, made, made)).fetchone() is not None


def remember(connection: Connection, idempotency: IdempotencyKey | None, made: str) -> None:
    """Store what a request created, within the transaction that created it."""
    if idempotency is not None:
        # Two transactions that delete the same rows in another order would block each other.
        connection.execute(
            "DELETE FROM requests WHERE (owner, key) IN (SELECT owner, key FROM requests "
            f"WHERE created < ?{connection.skip_locked})",
            (time.time() - KEPT,),
        )
        connection.execute(
            "INSERT INTO requests VALUES (?, ?, ?, ?, ?)",
            (idempotency.owner, idempotency.key, idempotency.fingerprint, made, time.time()),
        )
