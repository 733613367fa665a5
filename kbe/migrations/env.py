"""Alembic environment that migrates a store over a given connection.

The transaction belongs to the caller (:mod:`kbe.connection`) for both databases: SQLite, too,
can roll back DDL.
"""

from alembic import context

from kbe.schema import VERSION_TABLE, metadata


def migrate() -> None:
    """Run the requested migrations."""
    context.configure(
        connection=context.config.attributes["connection"],
        target_metadata=metadata,
        version_table=VERSION_TABLE,
        transactional_ddl=True,
    )
    with context.begin_transaction():
        context.run_migrations()


# The configuration is missing when the file is imported for its documentation.
if hasattr(context, "config"):
    migrate()
