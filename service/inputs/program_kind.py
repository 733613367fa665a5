r"""Kinds of programs, told apart by their content: STEP-NC or NC code.

A Part 21 file begins with ``ISO-10303-21;`` and consists of sections and instances. NC code has
lines of words, a letter and a number each, or the blocks of a Heidenhain control. Content that
is neither counts as STEP-NC, whose reader says what is wrong.
"""

import re
from enum import StrEnum
from pathlib import Path

from service.files import read_head
from stepnc_model.errors import StepNcError
from stepnc_model.nc.control_guess import COMMENTS, LOOKED_AT, recognise

PART21 = re.compile(
    rb"^\s*(?:(?:ISO-10303-21|HEADER|DATA|ENDSEC)\s*;|#[0-9]+\s*=\s*\(?[A-Z_][A-Z0-9_]*\s*\()",
    re.M | re.I,
)
"""Beginning of a Part 21 file, of one of its sections, or of an instance."""

BLOCK = re.compile(
    rb"^[ \t]*/?[ \t]*(?:N[0-9]+[ \t]*)?(?:[GMTSF][ \t]*[0-9]|[XYZ][ \t]*=?[ \t]*[-+.0-9])",
    re.M | re.I,
)
"""Block of NC code: it begins with a word, after its number if it has one."""


NO_TABLE = "--tools cannot be used with NC code here: its moves need no tools"
"""Reason why commands that only show or time NC code take no tool table."""


class ProgramKind(StrEnum):
    """Kind of a program."""

    STEP_NC = "step-nc"
    NC_CODE = "nc-code"

    @property
    def words(self) -> str:
        """Name of the kind in messages."""
        return "NC code" if self is ProgramKind.NC_CODE else "a STEP-NC program"


def kind_of_file(path: Path) -> ProgramKind:
    """Tell the kind of a program by the beginning of its file.

    Raises
    ------
    StepNcError
        When the file cannot be read.
    """
    return kind_of(read_head(path, LOOKED_AT))


def require_step_nc(path: Path, why: str) -> None:
    """Refuse NC code where only a STEP-NC program will do.

    Raises
    ------
    StepNcError
        With the reason, or when the file cannot be read.
    """
    if kind_of_file(path) is ProgramKind.NC_CODE:
        raise StepNcError(f"{path}: is NC code: {why}")


def kind_for(path: Path, control: str) -> ProgramKind:
    """Tell the kind of a program by its content; with a control, what is neither is NC code.

    Raises
    ------
    StepNcError
        When the file cannot be read.
    """
    head = read_head(path, LOOKED_AT)
    is_code = bool(control) and not PART21.search(head)
    return ProgramKind.NC_CODE if is_code else kind_of(head)


def kind_of(data: bytes) -> ProgramKind:
    r"""Tell the kind of a program by the beginning of its content.

    Examples
    --------
    >>> kind_of(b"%\nO1234 (PART)\nG21 G54\nT1 M6\n")
    <ProgramKind.NC_CODE: 'nc-code'>
    >>> kind_of(b"ISO-10303-21;\nHEADER;\n")
    <ProgramKind.STEP_NC: 'step-nc'>
    """
    head = data[:LOOKED_AT]
    if b"\0" in head or PART21.search(head):
        return ProgramKind.STEP_NC
    is_code = BLOCK.search(COMMENTS.sub(b" ", head)) or recognise(head).hints
    return ProgramKind.NC_CODE if is_code else ProgramKind.STEP_NC
