"""Translation of database errors into errors of the project that say what to do.

References
----------
.. [1] SQLite, "Result and Error Codes", https://sqlite.org/rescode.html: the low byte is the
   primary code.
.. [2] PostgreSQL, "Appendix A. PostgreSQL Error Codes": the first two letters are the class.
"""

import errno
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import DBAPIError
from sqlalchemy.exc import TimeoutError as NoFreeConnection

from kbe.errors import (
    KnowledgeError,
    StoreBusy,
    StoreDamaged,
    StoreFull,
    StoreReadOnly,
    StoreUnavailable,
)
from kbe.store_location import StoreLocation

SHARED_MEMORY = sqlite3.SQLITE_IOERR_SHMSIZE, sqlite3.SQLITE_IOERR_SHMOPEN
"""SQLite codes for a lack of room for the index of the write-ahead log."""


@contextmanager
def translated(place: StoreLocation) -> Iterator[None]:
    """Translate database errors into errors of the knowledge base.

    Raises
    ------
    KnowledgeError
        Of the class that matches the database error.
    """
    try:
        yield
    except DBAPIError as error:
        raise fault(error.orig or error, place) from error
    except sqlite3.Error as error:
        raise fault(error, place) from error
    except NoFreeConnection as error:
        raise StoreBusy(place.shown) from error
    except OSError as error:
        if error.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}:
            raise StoreFull(place.shown) from error
        reason = f"{error.strerror or error}; check the disk and the rights"
        raise StoreUnavailable(place.shown, reason=reason) from error


def fault(error: BaseException, place: StoreLocation) -> KnowledgeError:
    """Convert a database error into an error of the knowledge base."""
    if isinstance(error, sqlite3.Error):
        return _sqlite_fault(error, place)
    return _postgresql_fault(error, place)


def _sqlite_fault(error: sqlite3.Error, place: StoreLocation) -> KnowledgeError:
    """Convert an SQLite error by its result code, [1]_."""
    code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR)
    shown = place.shown
    match code & 0xFF:
        case sqlite3.SQLITE_CORRUPT | sqlite3.SQLITE_NOTADB:
            return StoreDamaged(shown, reason=str(error))
        case sqlite3.SQLITE_FULL:
            return StoreFull(shown)
        case sqlite3.SQLITE_BUSY | sqlite3.SQLITE_LOCKED | sqlite3.SQLITE_PROTOCOL:
            return StoreBusy(shown)
        case sqlite3.SQLITE_READONLY | sqlite3.SQLITE_PERM:
            return StoreReadOnly(shown)
        case sqlite3.SQLITE_CANTOPEN:
            return StoreUnavailable(
                shown,
                reason="cannot be opened; allow this user to write the file and its folder",
            )
        case sqlite3.SQLITE_IOERR:
            return _disk_fault(code, place)
    return KnowledgeError(f"{error} (SQLite {code}); please report this", place=shown)


def _disk_fault(code: int, place: StoreLocation) -> KnowledgeError:
    """Convert a disk error: failed writes are mostly quota or size limits, others hardware."""
    if code in {sqlite3.SQLITE_IOERR_WRITE, *SHARED_MEMORY}:
        return StoreFull(place.shown)
    reason = f"the disk reports a fault (SQLite {code}); check it, and keep a backup elsewhere"
    return StoreUnavailable(place.shown, reason=reason)


def _postgresql_fault(error: BaseException, place: StoreLocation) -> KnowledgeError:
    """Convert a PostgreSQL error by the class of its code, [2]_; no code: no answer."""
    state = getattr(error, "sqlstate", None) or ""
    shown, said = place.shown, _first_line(error, place)
    if state == "53100":
        return StoreFull(shown)
    if state in {"25006", "42501"}:
        return StoreReadOnly(shown)
    match state[:2]:
        case "XX":
            return StoreDamaged(shown, reason=said)
        case "40" | "55":
            return StoreBusy(shown)
        case "" | "08" | "28" | "3D" | "3F" | "53" | "57" | "58":
            return StoreUnavailable(
                shown,
                reason=f"cannot connect to the server ({said}); "
                "check that it runs, the address, the user, its rights and the password",
            )
    return KnowledgeError(f"{said} (PostgreSQL {state}); please report this", place=shown)


def _first_line(error: BaseException, place: StoreLocation) -> str:
    """First line of a server message, with any password removed."""
    line = next(iter(str(error).splitlines()), type(error).__name__)
    secrets = [place.url.password, *place.url.normalized_query.get("password", ())]
    for secret in filter(None, map(str, secrets)):
        line = line.replace(secret, "***")
    return line
