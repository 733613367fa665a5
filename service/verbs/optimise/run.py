"""Optimise a program of any kind, or the programs of a folder."""

from service.inputs.program_kind import ProgramKind, kind_of_file
from service.progress import Tell, silent
from service.requests.advice import AdviceRequest
from service.requests.kind_options import require_served
from service.verbs.optimise.program import advise_program
from service.verbs.optimise.request import AdviceFiles
from service.verbs.optimise.result import OptimiseResult
from stepnc_model.errors import StepNcError


def run(request: AdviceRequest, files: AdviceFiles, *, tell: Tell = silent) -> OptimiseResult:
    """Optimise the feeds of a program and write them back in the form that was read.

    Raises
    ------
    StepNcError
        When a file, a name, a limit or an option is not valid; nothing is written.
    """
    if files.dry_run and files.output is not None:
        tell(f"--dry-run: {files.output} is not written")
    if files.file.is_dir():
        from service.verbs.optimise.folder import optimise_folder  # noqa: PLC0415 (executors)

        return optimise_folder(request, files, tell=tell)
    if files.cluster:
        raise StepNcError("--cluster runs the programs of a folder: name a folder")
    kind = kind_of_file(files.file)
    require_served(request, kind)
    require_served(files, kind)
    if kind is ProgramKind.NC_CODE:
        from service.verbs.optimise.code import optimise_code  # noqa: PLC0415 (numpy)

        return optimise_code(request, files, tell=tell)
    return advise_program(request, files, tell=tell)
