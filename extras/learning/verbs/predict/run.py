"""Prediction: the target of one part, or of the rows of a table."""

from dataclasses import fields

import pyarrow as pa

from extras.learning.model_file import load_model
from extras.learning.source import read_table
from extras.learning.verbs.predict.request import PredictFiles, PredictRequest
from extras.learning.verbs.predict.result import PredictResult
from service.progress import Tell, silent
from stepnc_model.errors import StepNcError


def run(request: PredictRequest, files: PredictFiles, *, tell: Tell = silent) -> PredictResult:
    """Predict the target of one part, or of each row of a table.

    Raises
    ------
    StepNcError
        When the model or the table is not usable, or settings lie outside the trained box.
    """
    path, table = files.model, files.table
    model = load_model(path)
    given = {
        field.name: value
        for field in fields(request)
        if (value := getattr(request, field.name)) is not None
    }
    if table is not None:
        if given:
            raise StepNcError("give a table or settings, not both")
        values = model.predicted(read_table(table), place=str(table))
        return PredictResult(model=model, values=values)
    wanted = (*model.features.columns, *([model.physics] if model.physics else []))
    missing = [name for name in wanted if name not in given]
    if missing:
        flags = ", ".join(f"--{name.replace('_', '-')}" for name in missing)
        raise StepNcError(f"{path}: the model needs {flags} too")
    row = pa.table({name: [value] for name, value in given.items()})
    return PredictResult(model=model, values=model.predicted(row, place=str(path)))
