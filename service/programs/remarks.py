"""Warnings about a program, the same for every command that reads it."""

from service.progress import Tell
from stepnc_model.errors import Finding, Severity
from stepnc_model.programs.plausibility import implausible, unit_findings
from stepnc_model.programs.program import Program
from stepnc_model.programs.tolerance import tolerance_findings
from stepnc_model.toolpath.generate import PathOf, generate, workingstep_path
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.toolpath.remarks import remarks


def program_remarks(
    program: Program, path_of: PathOf = workingstep_path
) -> tuple[Finding, ...]:
    """Warnings about a program and the tool paths that can be made for it."""
    paths = generate(program, lambda _executable, _error: None, path_of=path_of)
    return remarks(program, (path for path in paths if isinstance(path, ToolPath)))


def all_findings(program: Program) -> tuple[Finding, ...]:
    """All findings of a program itself; tolerances only if its references are valid."""
    findings = program.findings()
    is_sound = not any(finding.severity is Severity.ERROR for finding in findings)
    numbers = implausible(program) + unit_findings(program)
    return findings + numbers + (tolerance_findings(program) if is_sound else ())


def tell_check(program: Program, reported: tuple[Finding, ...], tell: Tell) -> None:
    """Tell the warnings and errors that ``check`` gives besides those told already.

    NC code runs without the file, so nobody asks ``check`` about it any more.
    """
    for finding in all_findings(program):
        if finding.severity is not Severity.NOTE and finding not in reported:
            tell(str(finding))


def tell_remarks(findings: tuple[Finding, ...], tell: Tell) -> None:
    """Tell each warning once."""
    for finding in findings:
        tell(str(finding))
