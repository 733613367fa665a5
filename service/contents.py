"""Check of a STEP-NC file: its contents and its errors, for the command ``check``."""

from dataclasses import dataclass
from pathlib import Path

from service.files import read_bytes
from service.reading import program_in
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.plausibility import implausible, unit_findings
from stepnc_model.program import Program
from stepnc_model.tolerance import tolerance_findings


@dataclass(frozen=True, slots=True, kw_only=True)
class Contents:
    """Contents and findings of a checked STEP-NC file."""

    name: str
    schemas: tuple[str, ...]
    instances: int
    program: Program | None
    findings: tuple[Finding, ...]

    @property
    def is_usable(self) -> bool:
        """Whether the program could be read and has no errors."""
        return self.program is not None and not any(
            finding.severity is Severity.ERROR for finding in self.findings
        )


def check(path: Path, *, units: str = "iso", name: str = "") -> Contents:
    """Read a STEP-NC file and check it; return its contents and findings."""
    called = name or path.name
    file = Part21File.from_bytes(read_bytes(path), name=called)
    try:
        program = program_in(file, units=units, name=called)
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
    return Contents(
        name=called,
        schemas=file.schemas,
        instances=len(file),
        program=program,
        findings=_all_findings(program),
    )


def _all_findings(program: Program) -> tuple[Finding, ...]:
    """Return all findings of a program; check its numbers only if its references are valid."""
    findings = program.findings()
    if any(finding.severity is Severity.ERROR for finding in findings):
        return findings
    return (
        findings + implausible(program) + unit_findings(program) + tolerance_findings(program)
    )
