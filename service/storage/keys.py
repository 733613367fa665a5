"""Keys that open the service: who has one, what it opens. Only their hashes are kept.

A key is 256 random bits: nobody tries them out, so a plain hash is enough and quick.
"""

import hashlib
import hmac
import secrets
import sqlite3
import time
from dataclasses import dataclass
from enum import StrEnum

from service.errors import NotFound
from service.ids import is_id, new_id
from service.storage.folder import DataFolder

PREFIX = "stepnc"


class Role(StrEnum):
    """Role of a key; every key may read."""

    VIEWER = "viewer"
    """looks at everything"""
    PLANNER = "planner"
    """programs, advice, simulations, reviews, corrections, machines and materials"""
    OPERATOR = "operator"
    """runs under control, and what is asked of them"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """One key, without its secret."""

    id: str
    name: str
    """whose"""
    roles: frozenset[Role]
    created: float
    """Created, s since 1970"""
    revoked: float | None

    def opens(self, role: Role) -> bool:
        """Whether the key has a role, or a higher one."""
        return role is Role.VIEWER or role in self.roles


def create(data_folder: DataFolder, *, name: str, roles: frozenset[Role]) -> str:
    """A new key; it is told this once."""
    id, secret = new_id(), secrets.token_hex(32)
    words = ",".join(sorted({*roles, Role.VIEWER}))
    with data_folder.database.writing() as connection:
        connection.execute(
            "INSERT INTO keys VALUES (?, ?, ?, ?, ?, NULL)",
            (id, _hash(secret), name, words, time.time()),
        )
    return f"{PREFIX}_{id}_{secret}"


def known(data_folder: DataFolder, word: str) -> Key | None:
    """The key that a word is; None: it is none, or was revoked."""
    prefix, _, rest = word.partition("_")
    id, _, secret = rest.partition("_")
    if prefix != PREFIX or not is_id(id):
        return None
    with data_folder.database.reading() as connection:
        row = connection.execute("SELECT * FROM keys WHERE id = ?", (id,)).fetchone()
    if row is None or row["revoked"] is not None:
        return None
    return _key(row) if hmac.compare_digest(row["hash"], _hash(secret)) else None


def listed(data_folder: DataFolder) -> tuple[Key, ...]:
    """All keys, oldest first."""
    with data_folder.database.reading() as connection:
        rows = connection.execute("SELECT * FROM keys ORDER BY id").fetchall()
    return tuple(_key(row) for row in rows)


def revoke(data_folder: DataFolder, id: str) -> None:
    """Make a key useless; it stays in the list.

    Raises
    ------
    NotFound
        When there is none, or it was revoked before.
    """
    with data_folder.database.writing() as connection:
        gone = connection.execute(
            "UPDATE keys SET revoked = ? WHERE id = ? AND revoked IS NULL", (time.time(), id)
        ).rowcount
    if not gone:
        raise NotFound("key", id)


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode(errors="replace")).hexdigest()


def _key(row: sqlite3.Row) -> Key:
    return Key(
        id=row["id"],
        name=row["name"],
        roles=frozenset(Role(word) for word in row["roles"].split(",")),
        created=row["created"],
        revoked=row["revoked"],
    )
