"""Export of outcomes and corrections as rows of a file, with the columns of the database.

Units are canonical (mm, s, N), so that an import restores exactly what was stored.
"""

from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime
from pathlib import Path

from kbe.factor import interval
from kbe.ledger import StoredCorrection
from kbe.rows import CORRECTION, OUTCOME
from kbe.schema import DECIDED
from kbe.selection import Selection
from service.flat_file import FileColumn, Format, Row, write_rows
from service.knowledge.place import require_apart
from service.knowledge.verbs import corrections, selected_outcomes
from stepnc_model.outcome import ProcessOutcome

OUTCOME_FIELDS = tuple(FileColumn(name=leaf.name, kind=leaf.kind) for leaf in OUTCOME.leaves)

CORRECTION_FIELDS = (
    FileColumn(name="id", kind=int),
    *(FileColumn(name=leaf.name, kind=leaf.kind) for leaf in CORRECTION.leaves
      if leaf.name not in DECIDED),
    FileColumn(name="factor", kind=float),
    FileColumn(name="factor_low", kind=float),
    FileColumn(name="factor_high", kind=float),
    FileColumn(name="standing", kind=str),
    FileColumn(name="decided_by", kind=str),
    FileColumn(name="decided_at", kind=datetime),
)  # fmt: skip


def export_outcomes(place: str, selection: Selection, *, file: Path, form: Format) -> int:
    """Write outcomes to a file, oldest first; return their number.

    Raises
    ------
    KnowledgeError, WriteError
        When the outcomes cannot be read or written.
    """
    require_apart(place, file)
    with selected_outcomes(place, selection) as found:
        return write_rows(file, OUTCOME_FIELDS, outcome_rows(found), form=form)


def export_corrections(place: str, *, file: Path, form: Format) -> int:
    """Write all corrections to a file; raises the same errors as :func:`export_outcomes`."""
    require_apart(place, file)
    return write_rows(file, CORRECTION_FIELDS, correction_rows(corrections(place)), form=form)


def outcome_rows(outcomes: Iterable[ProcessOutcome]) -> Iterator[Row]:
    """Yield outcomes as rows with the columns of the database."""
    return map(OUTCOME.row, outcomes)


def correction_rows(entries: Sequence[StoredCorrection]) -> Iterator[Row]:
    """Yield corrections as rows: database columns, 90 % interval and latest decision."""
    for entry in entries:
        found = interval(entry.correction)
        yield {
            **CORRECTION.row(entry.correction),
            "id": entry.id,
            "factor": found.centre,
            "factor_low": found.low,
            "factor_high": found.high,
            "standing": entry.standing.value,
            "decided_by": entry.decided_by,
            "decided_at": entry.decided_at,
        }
