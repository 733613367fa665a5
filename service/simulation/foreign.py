"""NC code of any origin on the virtual machine: what is understood runs, the rest is listed."""

from dataclasses import replace

from service.chosen import load_material_named
from service.files import read_bytes
from service.reading import one_of
from service.simulation.called_tools import called_tool_findings, with_called_tools
from service.simulation.code_paths import CodePaths
from service.simulation.setup import CodeRequest, PreparedRun
from simulator.library import load_machine
from simulator.tool_files.read import read_tools
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect


def from_foreign_code(request: CodeRequest, *, machine: str, material: str) -> PreparedRun:
    """Prepare NC code of any origin.

    Moves that are not understood are left out: they remove nothing, and a warning lists them.

    Raises
    ------
    StepNcError
        When a file or a name is invalid.
    """
    if request.tools is None or not (request.stock and machine and material):
        raise StepNcError(
            "NC code of any origin names no tools, stock, machine and material: add --tools, "
            "--stock, --machine and --material"
        )
    dialect = one_of(Dialect, request.dialect.lower(), "dialect") if request.dialect else None
    library = read_tools(request.tools, unit=request.tools_unit)
    program = read_program(read_bytes(request.code), dialect=dialect)
    code = CodePaths(
        with_called_tools(program, library),
        load_machine(machine),
        load_material_named(material),
        name=request.code.name,
        tools=library.by_number,
        stock=request.stock,
    )
    frame = Finding(
        severity=Severity.NOTE,
        message=f"read as code of {program.dialect.value}; the stock stands in {code.frame}",
    )
    return replace(
        code.prepared(0.0),
        findings=(
            frame,
            *program.findings,
            *library.findings,
            *called_tool_findings(program, library),
            *code.left_out,
        ),
    )
