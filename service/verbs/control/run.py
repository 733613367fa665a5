"""Run of a program under force control, or evaluation of a recorded run."""

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from pkgutil import resolve_name

from service.control.record import control_recorded
from service.inputs.numbers import numbers_in
from service.progress import Tell, silent
from service.requests.runs import ControlRequest
from service.simulation.run_files import placed_run
from service.verbs.control.request import ControlFiles
from service.verbs.control.result import ControlResult
from stepnc_model.errors import StepNcError

LINUXCNC = "extras.linuxcnc.drive_setup:drive_of"
"""Function of the extra that drives a LinuxCNC."""


def run(request: ControlRequest, files: ControlFiles, *, tell: Tell = silent) -> ControlResult:
    """Run a program under control, and record its outcomes if a knowledge base is named.

    Raises
    ------
    StepNcError
        When a file, a name, a number or an output is not valid.
    """
    if files.band:
        low, high = numbers_in(files.band, "override band", counts=(2,))
        request = replace(request, override_low_percent=low, override_high_percent=high)
    placed = placed_run(files, request)
    places = replace(
        placed.files,
        recorded=_recorded(files, tell),
        loads=files.loads,
        is_teaching=files.teach,
        cut_log=files.cut_log,
    )
    with ExitStack() as stack:
        if files.linuxcnc:
            found_drive = resolve_name(LINUXCNC)(files, placed.request, stack, tell)
            places = replace(places, drive=found_drive.drive)
            placed = replace(placed, request=found_drive.request)
        found = control_recorded(
            placed.request, places, knowledge=files.kb, by=files.by, tell=tell
        )
    return ControlResult(run=found)


def _recorded(files: ControlFiles, tell: Tell) -> Path | None:
    """Return the file of the recorded run; the next run of an agent is recorded first."""
    if files.recorded is None:
        return None
    if "://" not in files.recorded:
        return Path(files.recorded)
    from service.recording.request import RecordingRequest  # noqa: PLC0415
    from service.recording.run import record  # noqa: PLC0415 (the client of agents)

    if files.file is None:
        raise StepNcError("--recorded needs a STEP-NC program: it is compared with its plan")
    file = Path(f"{files.file.stem}.recorded.parquet")
    tell(f"{files.recorded}: waiting for the next run of the program")
    record(files.recorded, file, RecordingRequest(is_next_run=True), tell=tell)
    tell(f"recorded: {file}")
    return file
