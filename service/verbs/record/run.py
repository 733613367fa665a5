"""Recording of what an agent tells."""

from service.progress import Tell, silent
from service.recording.run import record
from service.requests.recording import RecordingRequest
from service.verbs.record.request import RecordingFiles
from service.verbs.record.result import RecordingResult


def run(
    request: RecordingRequest, files: RecordingFiles, *, tell: Tell = silent
) -> RecordingResult:
    """Record until the time is over, the program is completed or the user interrupts.

    Raises
    ------
    StepNcError
        As :func:`service.recording.run.record`.
    """
    return RecordingResult(recording=record(files.url, files.output, request, tell=tell))
