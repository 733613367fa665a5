"""Conversion of a program between ISO 14649 and AP238, or of its records between profiles."""

from service.files import read_bytes, require_place, write_atomically
from service.inputs.program_kind import require_step_nc
from service.programs.reading import read_program
from service.progress import Tell, silent
from service.verbs.convert.request import ConvertFiles, ConvertRequest, Standard
from service.verbs.convert.result import ConvertResult
from stepnc_model.ap238.export import to_ap238
from stepnc_model.ap238.view import AimView, is_aim
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.errors import Finding, StepNcError
from stepnc_model.part21.reader import Part21File


def run(request: ConvertRequest, files: ConvertFiles, *, tell: Tell = silent) -> ConvertResult:
    """Write a program in another form.

    Raises
    ------
    StepNcError
        When the file is NC code or written by that standard already, or cannot be read or
        written.
    """
    require_place(files.output, apart_from=files.file)
    require_step_nc(files.file, "neither standard describes its moves without features")
    findings: tuple[Finding, ...] = ()
    form = request.to or request.profile
    match form:
        case Standard():
            data, findings = _by_standard(files, form)
        case FileProfile():
            data = writeback.convert(read_program(files.file, units="iso"), form)
        case None:
            raise StepNcError("name a standard or a profile to convert to")
    write_atomically(files.output, data)
    found = ConvertResult(
        name=files.file.name,
        written=files.output,
        form=form,
        findings=findings,
    )
    for finding in findings:
        tell(str(finding))
    tell(found.said)
    return found


def _by_standard(files: ConvertFiles, standard: Standard) -> tuple[bytes, tuple[Finding, ...]]:
    """Program by another standard, and what cannot be said in it.

    A program of ISO 14649 has feeds and speeds in the units of that standard.
    """
    file = Part21File.from_bytes(read_bytes(files.file), name=files.file.name)
    if is_aim(file) == (standard is Standard.AP238):
        text = f"{files.file}: is a program of standard '{standard.value}' already"
        raise StepNcError(text)
    if standard is Standard.AP238:
        exported = to_ap238(file)
        return exported.data, exported.findings
    view = AimView.of(file)
    data, left_out = view.with_bodies()
    return data, (*view.remarks, *left_out)
