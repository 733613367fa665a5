"""Result of ``dataset``: where the rows are; the rows themselves are files."""

from dataclasses import dataclass
from pathlib import Path

from extras.learning.dataset_run import DatasetResult
from service.rendering.view import Fact, ResultView
from service.verbs.result import Result


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetReport(Result):
    """Result of ``dataset``."""

    made: DatasetResult
    programs: Path | None
    """Folder of the programs of all rows; None: they were not asked for."""

    def view(self) -> ResultView:
        """Return the facts for programs; people were told what was written."""
        made, programs = self.made, self.programs
        return ResultView([
            Fact(key="folder", value=str(made.folder)),
            Fact(key="rows", value=made.rows),
            Fact(key="made", value=made.made),
            Fact(key="seconds", value=made.seconds),
            Fact(key="csv", value=None if made.csv is None else str(made.csv)),
            Fact(key="programs", value=None if programs is None else str(programs)),
        ])
