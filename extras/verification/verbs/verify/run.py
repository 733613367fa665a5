"""Verification of logged positions with the files that people name."""

from dataclasses import replace
from pathlib import Path

from extras.verification.requests import VerificationRequest
from extras.verification.run import VerificationInputs, verify
from extras.verification.verbs.verify.request import VerificationFiles
from extras.verification.verbs.verify.result import VerificationResult
from service.files import require_places
from service.inputs.part_file import part_place
from service.outputs.run_file import require_suffix
from service.progress import Tell, silent
from stepnc_model.plurals import counted


def run(
    request: VerificationRequest, files: VerificationFiles, *, tell: Tell = silent
) -> VerificationResult:
    """Verify a log, and write the deviations of places if an output is named.

    Raises
    ------
    StepNcError
        As :func:`extras.verification.run.verify`; and when an output is not writable.
    """
    required: tuple[Path | None, str] = (None, "")
    if files.required:
        required = part_place(files.required)
    require_places([files.output, files.report])
    if files.output is not None:
        require_suffix(files.output)
    inputs = VerificationInputs(tools=files.tools, required=required[0], solid=required[1])
    found = verify(files.log, files.program, request, inputs=inputs, tell=tell)
    findings = (*files.log_findings, *found.findings)
    result = VerificationResult(verification=replace(found, findings=findings))
    if files.output is not None:
        tell(f"written: {files.output} ({counted(result.write_places(files.output), 'place')})")
    return result
