"""The tables are those of the nouns, and what is in them stays."""

from collections.abc import Callable

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import text
from sqlalchemy.exc import DBAPIError

from kbe.schema import VERSION_TABLE, metadata
from kbe.store import Store
from stepnc_model.outcome import LearnedCorrection, ProcessOutcome

OutcomeMaker = Callable[..., list[ProcessOutcome]]


def test_migrations_make_what_the_nouns_declare(store: Store) -> None:
    with store.engine.connect() as connection:
        options = {"version_table": VERSION_TABLE, "compare_type": True}
        context = MigrationContext.configure(connection, opts=options)
        assert compare_metadata(context, metadata) == []


@pytest.fixture
def full(store: Store, outcomes: OutcomeMaker, proposal: LearnedCorrection) -> Store:
    store.add(outcomes(2))
    correction = store.propose(proposal)
    store.accept(correction, by="Ann", at=proposal.proposed_at)
    return store


CHANGES = [
    change
    for table, column in (("outcome", "tool"), ("correction", "tool"), ("decision", "kind"))
    for change in (
        f"UPDATE {table} SET {column} = 'x'",
        f"UPDATE {table} SET id = id + 100",
        f"DELETE FROM {table}",
        f"DELETE FROM {table} WHERE id = 1",
    )
]

SQLITE_CHANGES = [
    "INSERT OR REPLACE INTO decision VALUES (1, 1, 'withdrawn', 'Eve', '2026-01-01')",
    "REPLACE INTO outcome SELECT * FROM outcome WHERE id = 1",
    "UPDATE OR REPLACE outcome SET id = 1 WHERE id = 2",
]

POSTGRESQL_CHANGES = [
    "TRUNCATE outcome",
    "TRUNCATE correction CASCADE",
    "INSERT INTO decision VALUES (1, 1, 'withdrawn', 'Eve', now()) "
    "ON CONFLICT (id) DO UPDATE SET kind = 'withdrawn'",
]


def test_nothing_is_changed_or_deleted_whatever_sql_says(full: Store) -> None:
    before = (list(full.outcomes()), full.corrections())
    special = SQLITE_CHANGES if full.place.file else POSTGRESQL_CHANGES
    for change in CHANGES + special:
        with (
            pytest.raises(DBAPIError, match=r"are never (changed|deleted|replaced)"),
            full.engine.execution_options(will_write=True).begin() as connection,
        ):
            connection.execute(text(change))
    assert (list(full.outcomes()), full.corrections()) == before


def test_decision_needs_its_correction_and_a_known_kind(full: Store) -> None:
    for values in ("99, 'accepted'", "1, 'perhaps'"):
        with (
            pytest.raises(DBAPIError, match=r"(?i)foreign key|check"),
            full.engine.execution_options(will_write=True).begin() as connection,
        ):
            connection.execute(
                text(
                    "INSERT INTO decision (correction_id, kind, decided_by, decided_at) "
                    f"VALUES ({values}, 'Eve', '2026-01-01')"
                )
            )
