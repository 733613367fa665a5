"""API keys of the service: owners and roles. Only hashes of the keys are stored.

A key has 256 random bits and cannot be guessed, so a plain fast hash is enough.
"""

import hashlib
import hmac
import secrets
import time
from dataclasses import dataclass
from enum import StrEnum

from service.errors import NotFound
from service.ids import is_id, new_id
from service.storage.connection import StoredRow
from service.storage.folder import DataFolder

PREFIX = "stepnc"


class Role(StrEnum):
    """Role of an API key; every key may read."""

    VIEWER = "viewer"
    """May read everything."""
    PLANNER = "planner"
    """May change programs, advice, simulations, reviews, corrections and the library."""
    OPERATOR = "operator"
    """May start controlled runs and trial cuts, and change them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """API key without its secret."""

    id: str
    name: str
    """Name of the owner."""
    roles: frozenset[Role]
    created: float
    """Time of creation, in s since 1970."""
    revoked: float | None

    def opens(self, role: Role) -> bool:
        """True if the key has a role; every key has the role viewer."""
        return role is Role.VIEWER or role in self.roles


def create(data_folder: DataFolder, *, name: str, roles: frozenset[Role]) -> str:
    """Create a key and return it; this is the only time that it is shown."""
    id, secret = new_id(), secrets.token_hex(32)
    words = ",".join(sorted({*roles, Role.VIEWER}))
    with data_folder.database.writing() as connection:
        connection.execute(
            "INSERT INTO keys VALUES (?, ?, ?, ?, ?, NULL)",
            (id, _hash(secret), name, words, time.time()),
        )
    return f"{PREFIX}_{id}_{secret}"


def known(data_folder: DataFolder, word: str) -> Key | None:
    """Return the key that a word represents; None if it is unknown or revoked."""
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
    """Return all keys, oldest first."""
    with data_folder.database.reading() as connection:
        rows = connection.execute("SELECT * FROM keys ORDER BY id").fetchall()
    return tuple(_key(row) for row in rows)


def revoke(data_folder: DataFolder, id: str) -> None:
    """Revoke a key; it stays in the list.

    Raises
    ------
    NotFound
        When the key does not exist, or was revoked before.
    """
    with data_folder.database.writing() as connection:
        gone = connection.execute(
            "UPDATE keys SET revoked = ? WHERE id = ? AND revoked IS NULL", (time.time(), id)
        ).rowcount
    if not gone:
        raise NotFound("key", id)


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode(errors="replace")).hexdigest()


def _key(row: StoredRow) -> Key:
    return Key(
        id=row["id"],
        name=row["name"],
        roles=frozenset(Role(word) for word in row["roles"].split(",")),
        created=row["created"],
        revoked=row["revoked"],
    )
