"""Outcomes and corrections that ``kbe write`` stored in a program."""

from service.programs.reading import read_program
from service.progress import Tell, silent
from service.requests.fields import Request
from service.verbs.kbe.read.request import RecordedFiles
from service.verbs.kbe.read.result import RecordedResult
from stepnc_model.editing.outcome_record import read_outcomes


def run(_request: Request, files: RecordedFiles, *, tell: Tell = silent) -> RecordedResult:
    """Read the outcomes and corrections stored in a program.

    Raises
    ------
    StepNcError
        When the file cannot be read as a program.
    """
    found = read_outcomes(read_program(files.file, units="iso"))
    return RecordedResult(outcomes=found.outcomes, corrections=found.corrections)
