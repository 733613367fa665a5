"""Result of ``kbe export``: the file; its rows are in it alone."""

from dataclasses import dataclass
from pathlib import Path

from service.verbs.kbe.export.request import ExportedContent
from service.verbs.result import DoneResult


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportResult(DoneResult):
    """File that was written."""

    written: Path
    what: ExportedContent
    rows: int | None
    """Number of outcomes or corrections; None for a table."""

    @property
    def said(self) -> str:
        """Summary in one line."""
        count = "" if self.rows is None else f" ({self.rows} {self.what.value})"
        return f"written: {self.written}{count}"
