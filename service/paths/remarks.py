"""Warnings about a program, the same for every command that reads it."""

from service.reading import Tell
from stepnc_model.errors import Finding
from stepnc_model.program import Program
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.toolpath.remarks import remarks


def program_remarks(program: Program) -> tuple[Finding, ...]:
    """Warnings about a program and the tool paths that can be made for it."""
    paths = generate(program, lambda _executable, _error: None)
    return remarks(program, (path for path in paths if isinstance(path, ToolPath)))


def tell_remarks(found: tuple[Finding, ...], tell: Tell) -> None:
    """Tell each warning once."""
    for finding in found:
        tell(str(finding))
