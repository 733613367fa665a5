"""Data set by a design of experiments."""

from extras.learning.dataset_folder import PROGRAMS
from extras.learning.dataset_run import DatasetFiles, make_dataset
from extras.learning.verbs.dataset.request import DatasetPlaces, DatasetRequest
from extras.learning.verbs.dataset.result import DatasetReport
from service.execution.pools import pools_of
from service.progress import Tell, silent
from stepnc_model.plurals import counted


def run(request: DatasetRequest, files: DatasetPlaces, *, tell: Tell = silent) -> DatasetReport:
    """Make the rows of a design that are not there yet.

    Raises
    ------
    StepNcError
        As :func:`extras.learning.dataset_run.make_dataset`.
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
