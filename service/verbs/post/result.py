"""Result of ``post``: where the NC code is, and what was left out of it."""

from dataclasses import dataclass
from pathlib import Path

from service.errors import BAD_INPUT, OK
from service.programs.toolpaths import Paths
from service.rendering.columns import finding_record
from service.rendering.view import Fact, ResultView, TextLine
from service.verbs.result import Result
from stepnc_model.plurals import counted
from stepnc_model.post.dialect import Dialect


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PostResult(Result):
    """NC code that was written."""

    paths: Paths
    control: Dialect
    written: Path
    lines: int

    @property
    def exit_code(self) -> int:
        """Exit code of the command line; bad input if a workingstep was left out."""
        return BAD_INPUT if self.paths.faults else OK

    def view(self) -> ResultView:
        """Return the file that was written; of the paths, what was left out and assumed."""
        paths = self.paths
        return ResultView([
            Fact(key="program", value=paths.program.name),
            Fact(key="control", value=self.control.value),
            Fact(key="written", value=str(self.written)),
            Fact(key="lines", value=self.lines),
            Fact(key="left_out", value=[str(fault) for fault in paths.faults]),
            Fact(key="findings", value=[finding_record(each) for each in paths.findings]),
            TextLine(
                text=f"written: {self.written} ({counted(self.lines, 'line')})",
                is_reported=True,
            ),
        ])
