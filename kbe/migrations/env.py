"""Alembic runs this file to migrate a store over the connection that it is given.

The transaction is the caller's (:mod:`kbe.migrate`), for both databases: SQLite, too, can undo
DDL.
"""

from alembic import context

from kbe.schema import VERSION_TABLE, metadata


def migrate() -> None:
    """Run the migrations that are asked for."""
    context.configure(
        connection=context.config.attributes["connection"],
        target_metadata=metadata,
        version_table=VERSION_TABLE,
        transactional_ddl=True,
    )
    with context.begin_transaction():
        context.run_migrations()


# Absent when the file is imported for its documentation.
if hasattr(context, "config"):
    migrate()
