"""Place of the advised program: another file than the input, unless it is asked for."""

from pathlib import Path

from service.files import beside, is_same, require_place, require_places
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import StepNcError, WriteError


def output_of(files: AdviceFiles, suffix: str) -> Path:
    """Return the path of the advised program.

    Parameters
    ----------
    files : AdviceFiles
    suffix : str
        End of its name where none is given.

    Raises
    ------
    StepNcError
        When an output would take the place of another file.
    """
    if files.in_place:
        if files.output is not None:
            raise StepNcError("--in-place and --output exclude each other")
        output = files.file
    else:
        output = files.output or beside(files.file, suffix)
        if is_same(files.file, output):
            message = "is the input file; use --in-place to overwrite it"
            raise WriteError(message, path=str(output))
        if not files.dry_run:
            require_place(output, apart_from=files.file)
    require_places([files.report, files.feeds_csv], apart_from=[files.file, output])
    return output
