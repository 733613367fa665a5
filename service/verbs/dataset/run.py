"""Data set by a design of experiments."""

from service.dataset.folder import PROGRAMS
from service.dataset.run import DatasetFiles, make_dataset
from service.execution.pools import pools_of
from service.progress import Tell, silent
from service.verbs.dataset.request import DatasetPlaces, DatasetRequest
from service.verbs.dataset.result import DatasetReport
from stepnc_model.counted import counted


def run(request: DatasetRequest, files: DatasetPlaces, *, tell: Tell = silent) -> DatasetReport:
    """Make the rows of a design that are not there yet.

    Raises
    ------
    StepNcError
        As :func:`service.dataset.run.make_dataset`.
    """
    made = make_dataset(
        files.design,
        files.output,
        rows=request.rows,
        tell=tell,
        files=DatasetFiles(has_csv=request.has_csv, has_programs=request.has_programs),
        pools=pools_of(files.cluster),
    )
    tell(f"written: {made.folder} ({counted(made.rows, 'row')}, {made.made} of them new)")
    if made.csv is not None:
        tell(f"CSV: {made.csv}")
    programs = made.folder / PROGRAMS if request.has_programs else None
    if programs is not None:
        tell(f"programs: {programs}")
    return DatasetReport(made=made, programs=programs)
