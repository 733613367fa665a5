"""NC code of a run with the setup that its file or the code itself tells."""

from dataclasses import dataclass, replace
from pathlib import Path

from service.files import read_bytes
from service.programs.reading import one_of
from service.simulation.code_setup import GivenSetup, code_setup
from service.simulation.code_simulation import CodeRequest
from service.simulation.setup_file import setup_of
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect


@dataclass(frozen=True, slots=True, kw_only=True)
class SetUpCode:
    """NC code, and the names of material and machine that go with it."""

    code: CodeRequest
    material: str
    machine: str


def code_of_run(
    request: CodeRequest, *, material: str, machine: str, named: Path | None
) -> SetUpCode:
    """Complete NC code as ``optimise`` does; what the user gives stays.

    Without a material nothing can be cut, and without a setup file and with tools and stock
    there is nothing to find: the code then is not read here.

    Raises
    ------
    StepNcError
        When the setup file or the code is not valid.
    """
    file = setup_of(request.code, named)
    as_it_is = SetUpCode(code=request, material=material, machine=machine)
    is_whole = request.tools is not None and bool(request.stock)
    is_canonical = request.dialect.lower() == Dialect.CANONICAL.value
    if ((is_whole or not material) and file is None) or is_canonical:
        return as_it_is
    dialect = one_of(Dialect, request.dialect.lower(), "dialect") if request.dialect else None
    program = read_program(
        read_bytes(request.code),
        dialect=dialect,
        most_repeats=request.most_repeats,
        keeps_state=request.keeps_state,
    )
    given = GivenSetup(
        file=request.code,
        tools=request.tools,
        unit=request.tools_unit,
        stock=request.stock,
        material=material,
        machine=machine,
        file_of_setup=file,
    )
    setup = code_setup(program, given)
    findings = setup.findings
    if setup.missing:
        lacks = "; ".join(setup.missing)
        missing = Finding(severity=Severity.WARNING, message=f"the setup lacks: {lacks}")
        findings = (*findings, missing)
    has_tools = bool(setup.library.tools) and bool(setup.material)
    return SetUpCode(
        code=replace(
            request,
            library=setup.library if has_tools else None,
            stock=setup.stock if has_tools else request.stock,
            is_stock_guessed=setup.is_stock_guessed,
            findings=findings,
        ),
        material=setup.material,
        machine=machine or (setup.machine if file is not None else ""),
    )
