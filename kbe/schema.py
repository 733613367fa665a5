"""Tables of the knowledge base, generated from the dataclasses that they store.

Three tables, and no row of them is ever changed: triggers of the database refuse it (they are
in :mod:`kbe.migrations`). A correction is a proposal; decisions of people about it are rows of
``decision``. In force for a context is the correction that was accepted last and not withdrawn
since.

Numbers are in the units of the project; the names of the columns carry them because other
programs read the tables too.
"""

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import (
    BigInteger,
    Boolean,
    CheckConstraint,
    Column,
    DateTime,
    Dialect,
    Double,
    ForeignKey,
    Index,
    Integer,
    MetaData,
    Table,
    Text,
)
from sqlalchemy.types import TypeDecorator, TypeEngine

from kbe.rows import CORRECTION, EVALUATED, IDENTITY, OUTCOME, AttributeColumn

VERSION = "0002"
"""Version of the schema: the newest file of ``migrations/versions``."""

VERSION_TABLE = "stepnc_kbe_version"


class UtcTime(TypeDecorator[datetime]):
    """Column type of times with zone, which SQLite stores as text in UTC."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:  # noqa: D102
        return None if value is None else value.astimezone(UTC)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:  # noqa: D102
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


# SQLite numbers rows itself only in INTEGER columns, which have 64 bits there.
ID = BigInteger().with_variant(Integer(), "sqlite")

TYPES: dict[type, TypeEngine[Any]] = {
    str: Text(),
    float: Double(),
    int: BigInteger(),
    bool: Boolean(),
    datetime: UtcTime(),
}


def _column(leaf: AttributeColumn) -> "Column[Any]":
    """Database column of an attribute."""
    return Column(leaf.name, TYPES[leaf.kind], nullable=leaf.is_optional)


metadata = MetaData()

GROUP = ("machine", "material", "tool", "feature_kind")
"""Columns by which outcomes are grouped for evaluation."""

outcome = Table(
    "outcome",
    metadata,
    Column("id", ID, primary_key=True),
    *(_column(leaf) for leaf in OUTCOME.leaves),
    *(Column(f"{name}_deviation", Double()) for name in EVALUATED),
    Index("outcome_by_time", "recorded_at"),
    Index("outcome_by_program", "program", "recorded_at"),
    Index("outcome_by_run", "run"),
    Index("outcome_identity", *IDENTITY, unique=True),
    # A covering index for evaluations, in the order in which they group.
    Index(
        "outcome_by_group",
        *GROUP,
        "recorded_at",
        *(f"{name}_deviation" for name in EVALUATED),
    ),
)

DECIDED = ("accepted_by", "accepted_at")
"""Attributes of a correction that are stored as decisions."""

correction = Table(
    "correction",
    metadata,
    Column("id", ID, primary_key=True),
    *(_column(leaf) for leaf in CORRECTION.leaves if leaf.name not in DECIDED),
    Index("correction_by_context", "machine", "material", "tool"),
)

decision = Table(
    "decision",
    metadata,
    Column("id", ID, primary_key=True),
    Column("correction_id", ID, ForeignKey("correction.id"), nullable=False),
    Column("kind", Text(), nullable=False),
    Column("decided_by", Text(), nullable=False),
    Column("decided_at", UtcTime(), nullable=False),
    CheckConstraint("kind IN ('accepted', 'withdrawn')", name="decision_kind"),
    Index("decision_by_correction", "correction_id", "id"),
)

TABLES = (outcome, correction, decision)
"""All tables, in an order in which rows can be copied."""
