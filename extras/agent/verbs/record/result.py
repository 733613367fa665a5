"""Result of ``record``: what the file has, and what was lost."""

from dataclasses import dataclass

from service.recording.run import Recording
from service.rendering.view import Fact, ResultView, TextLine
from service.verbs.result import Result
from stepnc_model.plurals import counted


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingResult(Result):
    """Result of ``record``."""

    recording: Recording

    def view(self) -> ResultView:
        """Return the size of the file, and the interruptions if there were any."""
        found = self.recording
        written = (
            f"{found.file}: {counted(found.rows, 'row')}, "
            f"{counted(len(found.columns), 'column')}, "
            f"{counted(found.observations, 'observation')}"
        )
        interrupted = (
            f"interrupted: {counted(found.faults, 'time')} without connection, "
            f"{counted(found.restarts, 'restart')} of the agent, "
            f"{counted(found.lost, 'observation')} lost"
        )
        has_gaps = found.lost or found.restarts or found.faults
        return ResultView([
            TextLine(text=written),
            Fact(key="file", value=str(found.file)),
            Fact(key="rows", value=found.rows),
            Fact(key="columns", value=[each.name for each in found.columns]),
            Fact(key="observations", value=found.observations),
            *([TextLine(text=interrupted)] if has_gaps else []),
            Fact(key="faults", value=found.faults),
            Fact(key="restarts", value=found.restarts),
            Fact(key="lost", value=found.lost),
        ])
