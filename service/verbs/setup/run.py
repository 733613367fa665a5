"""Draft of the setup of NC code."""

from service.files import read_bytes, require_place, write_atomically
from service.inputs.numbers import program_numbers_in
from service.inputs.program_kind import ProgramKind, kind_for
from service.programs.machine_choice import load_material_named
from service.progress import Tell, silent
from service.simulation.code_setup import GivenSetup, code_setup
from service.simulation.setup_draft import setup_draft
from service.simulation.setup_file import setup_place
from service.verbs.setup.request import SetupFiles, SetupRequest
from service.verbs.setup.result import SetupResult
from simulator.library import load_machine
from stepnc_model.errors import StepNcError
from stepnc_model.nc.program import read_program


def run(request: SetupRequest, files: SetupFiles, *, tell: Tell = silent) -> SetupResult:
    """Draft the setup of NC code and write it beside the program.

    Raises
    ------
    StepNcError
        When the file is no NC code, a name or a stock is not valid, or a setup file is there
        already and no other place is named: it may have been edited.
    """
    if kind_for(files.file, request.dialect or "") is not ProgramKind.NC_CODE:
        raise StepNcError(f"{files.file}: is no NC code: only such code needs a setup")
    output = files.output or setup_place(files.file)
    require_place(output, apart_from=files.file)
    if files.output is None and output.exists() and not files.dry_run:
        raise StepNcError(
            f"{output} is there already: name another place with --output, or delete it"
        )
    if request.material:
        load_material_named(request.material)
    if request.machine:
        load_machine(request.machine)
    program = read_program(
        read_bytes(files.file),
        dialect=request.dialect,
        most_repeats=files.most_repeats,
        keeps_state=program_numbers_in(files.keeps_state),
    )
    given = GivenSetup(
        file=files.file,
        tools=files.tools,
        unit=files.tools_unit,
        stock=files.stock,
        material=request.material,
        machine=request.machine,
    )
    setup = code_setup(program, given)
    draft = setup_draft(program, given, setup)
    if not files.dry_run:
        write_atomically(output, draft.text.encode())
        tell(f"written: {output}")
    return SetupResult(
        name=files.file.name,
        values=draft.rows,
        text=draft.text,
        written=None if files.dry_run else output,
        missing=setup.missing,
        command=setup.command,
        findings=(*program.findings, *setup.library.findings, *setup.findings),
    )
