"""Predictions of measured cuts beside their measured values."""

from extras.calibration.verbs.calibrate.cuts import CutsResult, validated_cuts
from extras.calibration.verbs.validate.request import ValidateFiles, ValidateRequest
from service.progress import Tell, silent


def run(request: ValidateRequest, files: ValidateFiles, *, tell: Tell = silent) -> CutsResult:
    """Predict the cuts of a table; nothing is written.

    Raises
    ------
    StepNcError
        When a cell or a name is invalid, or the table holds nothing to predict.
    """
    del tell
    return validated_cuts(request, files.table)
