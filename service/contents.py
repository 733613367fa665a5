"""Check of a STEP-NC file: its contents and its errors, for the command ``check``."""

from dataclasses import dataclass
from pathlib import Path

from service.files import read_bytes
from service.paths.remarks import all_findings, program_remarks
from service.paths.toolpaths import Paths, paths_of
from service.reading import (
    Tell,
    given_data,
    program_in,
    read_stock,
    require_no_other_stock,
    silent,
)
from service.requests.given import ProgramRequest
from service.uses import Use, UseName, uses_of
from stepnc_model.errors import Finding, SchemaError, Severity, StepNcError
from stepnc_model.given import completed
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program


@dataclass(frozen=True, slots=True, kw_only=True)
class Contents:
    """Contents and findings of a checked STEP-NC file."""

    name: str
    schemas: tuple[str, ...]
    instances: int
    program: Program | None
    findings: tuple[Finding, ...]
    uses: tuple[Use, ...] = ()
    """Uses of the program; none where it could not be read."""
    remarks: tuple[Finding, ...] = ()
    """Those of the findings that every command tells."""

    @property
    def is_usable(self) -> bool:
        """Whether feeds can be advised or NC code written, with a material if need be."""
        wanted = {UseName.CODE, UseName.ADVICE}
        return any(
            use.is_possible or use.is_possible_with_material
            for use in self.uses
            if use.name in wanted
        )

    @property
    def is_of_use(self) -> bool:
        """Whether the program can be used for anything."""
        return any(use.is_possible or use.is_possible_with_material for use in self.uses)


def check(
    path: Path, request: ProgramRequest | None = None, *, name: str = "", tell: Tell = silent
) -> Contents:
    """Read a STEP-NC file and check it; return its contents and findings.

    Parameters
    ----------
    path : Path
    request : ProgramRequest, optional
        What is given about the program beyond its file.
    name : str
        Name of the program; empty: the name of its file.
    tell : callable
        Receives messages.

    Raises
    ------
    StepNcError
        When the file is not one of Part 21, or something that is given is not valid.
    """
    given = request or ProgramRequest()
    called = name or path.name
    file = Part21File.from_bytes(read_bytes(path), name=called)
    raw = read_stock(given.stock)
    try:
        program = program_in(file, units=given.units, name=called, stock=raw, tell=tell)
    except SchemaError as error:
        fault = Finding(
            severity=Severity.ERROR,
            message=str(error),
        )
        return Contents(
            name=called,
            schemas=file.schemas,
            instances=len(file),
            program=None,
            findings=(*file.findings, fault),
        )
    require_no_other_stock(program)
    program = completed(program, given_data(given)).program
    made = _paths(program)
    found = program_remarks(program) if isinstance(made, StepNcError) else made.remarks
    return Contents(
        name=called,
        schemas=file.schemas,
        instances=len(file),
        program=program,
        findings=(*all_findings(program), *found),
        uses=uses_of(program, made),
        remarks=found,
    )


def _paths(program: Program) -> Paths | StepNcError:
    """Return the tool paths of a program, or the reason why they cannot be made."""
    try:
        return paths_of(program)
    except StepNcError as error:
        return error
