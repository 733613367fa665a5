"""Create the tables of outcomes, corrections and decisions, with triggers against changes.

This file never changes: later schema changes get files of their own. There is no downgrade,
because it would delete rows; restore a backup instead.
"""

import sqlalchemy as sa
from alembic import op

from kbe.schema import ID, UtcTime

revision = "0001"
down_revision = None

KEPT = ("outcome", "correction", "decision")

SQLITE_TRIGGERS = """
CREATE TRIGGER {table}_no_update BEFORE UPDATE ON {table}
BEGIN SELECT RAISE(ABORT, 'rows of {table} are never changed'); END;
CREATE TRIGGER {table}_no_delete BEFORE DELETE ON {table}
BEGIN SELECT RAISE(ABORT, 'rows of {table} are never deleted'); END;
CREATE TRIGGER {table}_no_replace BEFORE INSERT ON {table}
WHEN EXISTS (SELECT 1 FROM {table} WHERE id = NEW.id)
BEGIN SELECT RAISE(ABORT, 'rows of {table} are never replaced'); END;
"""

POSTGRESQL_FUNCTION = """
CREATE FUNCTION refuse_change() RETURNS trigger LANGUAGE plpgsql AS
$$ BEGIN RAISE EXCEPTION 'rows of % are never changed', TG_TABLE_NAME; END $$
"""

POSTGRESQL_TRIGGERS = """
CREATE TRIGGER {table}_no_change BEFORE UPDATE OR DELETE ON {table}
FOR EACH ROW EXECUTE FUNCTION refuse_change();
CREATE TRIGGER {table}_no_truncate BEFORE TRUNCATE ON {table}
FOR EACH STATEMENT EXECUTE FUNCTION refuse_change();
"""


def upgrade() -> None:
    """Create tables, indexes and triggers."""
    _make_outcome()
    _make_correction()
    _make_decision()
    if op.get_bind().dialect.name == "sqlite":
        for table in KEPT:
            for trigger in SQLITE_TRIGGERS.format(table=table).split("END;"):
                if trigger.strip():
                    op.execute(f"{trigger} END")
        return
    op.execute(POSTGRESQL_FUNCTION)
    for table in KEPT:
        op.execute(POSTGRESQL_TRIGGERS.format(table=table))


def _make_outcome() -> None:
    """Create the table of outcomes, one row per workingstep of a run."""
    op.create_table(
        "outcome",
        sa.Column("id", ID, primary_key=True),
        sa.Column("machine", sa.Text(), nullable=False),
        sa.Column("material", sa.Text(), nullable=False),
        sa.Column("tool", sa.Text(), nullable=False),
        sa.Column("program", sa.Text(), nullable=False),
        sa.Column("workingstep", sa.Text(), nullable=False),
        sa.Column("feature_id", sa.Text(), nullable=False),
        sa.Column("feature_kind", sa.Text(), nullable=False),
        sa.Column("feature_length_mm", sa.Double()),
        sa.Column("feature_width_mm", sa.Double()),
        sa.Column("feature_total_depth_mm", sa.Double()),
        sa.Column("is_finishing", sa.Boolean(), nullable=False),
        sa.Column("mode", sa.Text(), nullable=False),
        sa.Column("k_c11_n_mm2", sa.Double()),
        sa.Column("cutting_speed_mm_s", sa.Double()),
        sa.Column("step_depth_predicted_mm", sa.Double()),
        sa.Column("step_depth_measured_mm", sa.Double()),
        sa.Column("feed_per_tooth_predicted_mm", sa.Double()),
        sa.Column("feed_per_tooth_measured_mm", sa.Double()),
        sa.Column("immersion", sa.Text()),
        sa.Column("strategy", sa.Text(), nullable=False),
        sa.Column("roughness_predicted_mm", sa.Double()),
        sa.Column("roughness_measured_mm", sa.Double()),
        sa.Column("time_predicted_s", sa.Double()),
        sa.Column("time_measured_s", sa.Double()),
        sa.Column("force_predicted_n", sa.Double()),
        sa.Column("force_measured_n", sa.Double()),
        sa.Column("feed_predicted_mm_s", sa.Double()),
        sa.Column("feed_measured_mm_s", sa.Double()),
        sa.Column("force_bound_n", sa.Double()),
        sa.Column("force_ratio_log_mean", sa.Double()),
        sa.Column("force_ratio_log_deviation", sa.Double()),
        sa.Column("force_ratio_readings", sa.BigInteger()),
        sa.Column("trace", sa.Text(), nullable=False),
        sa.Column("run", sa.Text(), nullable=False),
        sa.Column("recorded_at", UtcTime(), nullable=False),
        sa.Column("recorded_by", sa.Text(), nullable=False),
        sa.Column("roughness_deviation", sa.Double()),
        sa.Column("time_deviation", sa.Double()),
        sa.Column("force_deviation", sa.Double()),
        sa.Column("feed_deviation", sa.Double()),
    )
    op.create_index("outcome_by_time", "outcome", ["recorded_at"])
    op.create_index("outcome_by_program", "outcome", ["program", "recorded_at"])
    op.create_index("outcome_by_run", "outcome", ["run"])
    deviations = [f"{name}_deviation" for name in ("roughness", "time", "force", "feed")]
    op.create_index(
        "outcome_by_group",
        "outcome",
        ["machine", "material", "tool", "feature_kind", "recorded_at", *deviations],
    )


def _make_correction() -> None:
    """Create the table of corrections, one row per proposal."""
    op.create_table(
        "correction",
        sa.Column("id", ID, primary_key=True),
        sa.Column("machine", sa.Text(), nullable=False),
        sa.Column("material", sa.Text(), nullable=False),
        sa.Column("tool", sa.Text(), nullable=False),
        sa.Column("log_centre", sa.Double(), nullable=False),
        sa.Column("log_scale", sa.Double(), nullable=False),
        sa.Column("degrees", sa.Double(), nullable=False),
        sa.Column("outcomes", sa.BigInteger(), nullable=False),
        sa.Column("confidence", sa.Double(), nullable=False),
        sa.Column("proposed_at", UtcTime(), nullable=False),
    )
    op.create_index("correction_by_context", "correction", ["machine", "material", "tool"])


def _make_decision() -> None:
    """Create the table of decisions, one row per decision of a person."""
    op.create_table(
        "decision",
        sa.Column("id", ID, primary_key=True),
        sa.Column("correction_id", ID, sa.ForeignKey("correction.id"), nullable=False),
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("decided_by", sa.Text(), nullable=False),
        sa.Column("decided_at", UtcTime(), nullable=False),
        sa.CheckConstraint("kind IN ('accepted', 'withdrawn')", name="decision_kind"),
    )
    op.create_index("decision_by_correction", "decision", ["correction_id", "id"])
