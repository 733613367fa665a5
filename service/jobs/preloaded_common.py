"""Modules that every job needs and imports late, loaded once in the fork server.

Drivers of databases that are not installed are left out.
"""

from contextlib import suppress
from importlib import import_module

for name in (
    "pydantic.dataclasses",
    "pydantic.type_adapter",
    "service.jobs.child",
    "service.storage.server_database",
    "sqlalchemy.dialects.postgresql.psycopg",
    "sqlalchemy.dialects.sqlite.pysqlite",
):
    with suppress(ImportError):
        import_module(name)
