"""Upgrade of a store to the schema of this program, in one transaction.

Two programs that open a new store at the same time both succeed: the second waits, and finds
the tables already made.
"""

import time
from pathlib import Path

from sqlalchemy import Connection, MetaData, Table, Text, inspect, select, text
from sqlalchemy.engine import Engine
from sqlalchemy.schema import Column

from kbe.connection import PATIENCE, reading, writing
from kbe.errors import StoreBusy, StoreDamaged, StoreTooNew, StoreUnavailable
from kbe.faults import translated
from kbe.schema import VERSION, VERSION_TABLE
from kbe.store_location import StoreLocation

MIGRATIONS = Path(__file__).parent / "migrations"

LOCK = 0x53544E43
"""Number of the database lock for schema changes; the letters STNC."""

_version = Table(VERSION_TABLE, MetaData(), Column("version_num", Text()))


def migrate(engine: Engine, place: StoreLocation, *, is_new_allowed: bool) -> None:
    """Create or upgrade the tables of a store.

    Raises
    ------
    StoreTooNew
        When a newer program made the store.
    StoreUnavailable
        When the database is not a knowledge base, or new although that is not allowed.
    """
    with reading(engine, place) as connection:
        found = _found(connection, place, is_new_allowed=is_new_allowed)
    if found == VERSION:
        return
    if place.file and not found:
        _write_ahead(engine, place)
    with writing(engine, place) as connection:
        if not place.file:
            connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": LOCK})
            _require_unicode(connection, place)
        # Another program may have upgraded it in the meantime.
        if _found(connection, place, is_new_allowed=is_new_allowed) != VERSION:
            _upgrade(connection)


def _found(connection: Connection, place: StoreLocation, *, is_new_allowed: bool) -> str:
    """Version of the schema found; empty if there are no tables yet."""
    tables = inspect(connection).get_table_names()
    if VERSION_TABLE in tables:
        found = connection.execute(select(_version.c.version_num)).scalars().all()
        if found and max(found) > VERSION:
            raise StoreTooNew(place.shown, found=max(found), known=VERSION)
        if len(found) > 1 or not set(found) <= _known_versions():
            versions = ", ".join(map(str, found))
            raise StoreDamaged(place.shown, reason=f"unknown schema version {versions}")
        return found[0] if found else ""
    if tables:
        reason = f"is not a knowledge base (table {tables[0]}); name another file or database"
        raise StoreUnavailable(place.shown, reason=reason)
    if not is_new_allowed:
        raise StoreUnavailable(place.shown, reason="is empty; check the name")
    return ""


def _known_versions() -> set[str]:
    return {path.name[: len(VERSION)] for path in (MIGRATIONS / "versions").glob("[0-9]*.py")}


def _write_ahead(engine: Engine, place: StoreLocation) -> None:
    """Switch an SQLite file to write-ahead logging, retrying while others lock it."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            with translated(place):
                _set_write_ahead(engine)
                break
        except StoreBusy:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.01)


def _set_write_ahead(engine: Engine) -> None:
    """Set the journal mode outside a transaction, as SQLite requires."""
    raw = engine.raw_connection()
    try:
        raw.cursor().execute("PRAGMA journal_mode = WAL")
    finally:
        raw.close()


def _require_unicode(connection: Connection, place: StoreLocation) -> None:
    """Require a database encoding that can store all names."""
    encoding = connection.execute(text("SHOW server_encoding")).scalar_one()
    if encoding != "UTF8":
        reason = f"has the encoding {encoding}; create a database with ENCODING 'UTF8'"
        raise StoreUnavailable(place.shown, reason=reason)


def _upgrade(connection: Connection) -> None:
    """Run the missing migrations in ``migrations/versions``."""
    # Slow to import, and rarely needed.
    from alembic import command  # noqa: PLC0415
    from alembic.config import Config  # noqa: PLC0415

    config = Config(attributes={"connection": connection})
    # A percent sign is special in Alembic's settings.
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    command.upgrade(config, "head")
