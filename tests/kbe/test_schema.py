"""Tables and their types."""

from datetime import UTC, datetime, timedelta, timezone

import pytest
from sqlalchemy.dialects import sqlite

from kbe.rows import CORRECTION, OUTCOME
from kbe.schema import DECIDED, TABLES, UtcTime, correction, outcome


def test_every_attribute_has_its_column() -> None:
    assert {leaf.name for leaf in OUTCOME.leaves} < set(outcome.c.keys())
    assert {leaf.name for leaf in CORRECTION.leaves} - set(DECIDED) < set(correction.c.keys())


def test_optional_attributes_alone_may_be_absent() -> None:
    optional = {leaf.name for leaf in OUTCOME.leaves if leaf.is_optional}
    deviations = {name for name in set(outcome.c.keys()) if name.endswith("_deviation")}
    assert {name for name, column in outcome.c.items() if column.nullable} == (
        optional | deviations
    )


def test_tables_come_after_what_they_refer_to() -> None:
    for index, table in enumerate(TABLES):
        referred = {key.column.table for key in table.foreign_keys}
        assert referred <= set(TABLES[:index])


@pytest.mark.parametrize("hours", [-5, 0, 9])
def test_time_is_kept_in_utc(hours: int) -> None:
    """What other programs read in the file is UTC, whatever zone the outcome told."""
    local = datetime(2026, 3, 5, 12, 0, tzinfo=UTC).astimezone(timezone(timedelta(hours=hours)))
    stored = UtcTime().process_bind_param(local, sqlite.dialect())
    assert stored is not None
    assert stored.replace(tzinfo=None) == datetime(2026, 3, 5, 12, 0)
    assert (
        UtcTime().process_result_value(stored.replace(tzinfo=None), sqlite.dialect()) == local
    )
    assert UtcTime().process_bind_param(None, sqlite.dialect()) is None
    assert UtcTime().process_result_value(None, sqlite.dialect()) is None
