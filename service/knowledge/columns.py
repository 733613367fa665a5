"""Columns of outcomes and corrections for files and other programs: those of the database.

Units are canonical (mm, s, N), so that an import restores exactly what was stored. Keys never
change, because other programs read them.
"""

from collections.abc import Callable
from datetime import datetime

from kbe.factor import FactorInterval, interval
from kbe.queries import StoredCorrection
from kbe.rows import CORRECTION, OUTCOME, AttributeColumn
from service.rendering.columns import Cell, Column
from stepnc_model.outcome import LearnedCorrection, ProcessOutcome

OUTCOME_COLUMNS: tuple[Column[ProcessOutcome], ...] = tuple(
    Column(key=leaf.name, kind=leaf.kind, value=read) for leaf, read in OUTCOME.readers
)


def _stored(
    leaf: AttributeColumn, read: Callable[[LearnedCorrection], Cell]
) -> Column[StoredCorrection]:
    return Column(key=leaf.name, kind=leaf.kind, value=lambda entry: read(entry.correction))


def _factor(key: str, of: Callable[[FactorInterval], float]) -> Column[StoredCorrection]:
    return Column(key=key, value=lambda entry: of(interval(entry.correction)))


CORRECTION_COLUMNS: tuple[Column[StoredCorrection], ...] = (
    *(_stored(leaf, read) for leaf, read in CORRECTION.readers),
    Column(key="id", kind=int, value=lambda entry: entry.id),
    _factor("factor", lambda found: found.centre),
    _factor("factor_low", lambda found: found.low),
    _factor("factor_high", lambda found: found.high),
    Column(key="standing", kind=str, value=lambda entry: entry.standing.value),
    Column(key="decided_by", kind=str, value=lambda entry: entry.decided_by),
    Column(key="decided_at", kind=datetime, value=lambda entry: entry.decided_at),
)
"""Columns of the database, the 90 % interval of the factor and the latest decision."""
