"""Recording of what an agent tells."""

from extras.agent.verbs.record.request import RecordingFiles
from extras.agent.verbs.record.result import RecordingResult
from service.progress import Tell, silent
from service.recording.request import RecordingRequest
from service.recording.run import record


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
