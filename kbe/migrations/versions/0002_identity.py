"""Give outcomes an identity, so that one that is recorded again is not counted again.

This file never changes: later schema changes get files of their own. Outcomes that earlier
versions stored twice stay, as nothing is ever deleted: they are numbered in the order in which
they were added.
"""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"

NUMBER = """
UPDATE outcome SET sequence = numbered.place FROM (
    SELECT id, ROW_NUMBER() OVER (
        PARTITION BY run, machine, program, workingstep ORDER BY id
    ) - 1 AS place FROM outcome
) AS numbered WHERE numbered.id = outcome.id AND numbered.place > 0
"""

NO_UPDATE = """
CREATE TRIGGER outcome_no_update BEFORE UPDATE ON outcome
BEGIN SELECT RAISE(ABORT, 'rows of outcome are never changed'); END
"""

NO_REPEAT = """
CREATE TRIGGER outcome_no_repeat BEFORE INSERT ON outcome
WHEN NOT EXISTS (SELECT 1 FROM outcome WHERE id = NEW.id) AND EXISTS (
    SELECT 1 FROM outcome WHERE run = NEW.run AND machine = NEW.machine
    AND program = NEW.program AND workingstep = NEW.workingstep AND sequence = NEW.sequence
)
BEGIN SELECT RAISE(IGNORE); END
"""
"""Without it, INSERT OR REPLACE would delete the row that has the same identity."""


def upgrade() -> None:
    """Number the outcomes of each workingstep of a run, and make the number part of a key."""
    is_sqlite = op.get_bind().dialect.name == "sqlite"
    column = sa.Column("sequence", sa.BigInteger(), nullable=False, server_default="0")
    op.add_column("outcome", column)
    if is_sqlite:
        op.execute("DROP TRIGGER outcome_no_update")
    else:
        op.execute("ALTER TABLE outcome DISABLE TRIGGER outcome_no_change")
    op.execute(NUMBER)
    if is_sqlite:
        op.execute(NO_UPDATE)
    else:
        op.execute("ALTER TABLE outcome ENABLE TRIGGER outcome_no_change")
    identity = ["run", "machine", "program", "workingstep", "sequence"]
    op.create_index("outcome_identity", "outcome", identity, unique=True)
    if is_sqlite:
        op.execute(NO_REPEAT)
