"""Conversion of a program between ISO 14649 and AP238, for the command ``convert --to``."""

from enum import StrEnum
from pathlib import Path

from service.files import read_bytes, require_place, write_atomically
from stepnc_model.ap238.export import to_ap238
from stepnc_model.ap238.view import AimView, is_aim
from stepnc_model.errors import Finding, StepNcError
from stepnc_model.part21.reader import Part21File


class Standard(StrEnum):
    """Standard by which a program is written."""

    ISO14649 = "iso14649"
    AP238 = "ap238"


def convert_to(path: Path, *, standard: Standard, output: Path) -> tuple[Finding, ...]:
    """Write a program by the other standard; return what could not be said in it.

    Parameters
    ----------
    path : Path
        Program of ISO 14649, with feeds and speeds in the units of that standard, or of AP238.
    standard : Standard
    output : Path

    Raises
    ------
    StepNcError
        If the program is written by that standard already, or cannot be read or written.
    """
    require_place(output, apart_from=path)
    file = Part21File.from_bytes(read_bytes(path), name=path.name)
    if is_aim(file) == (standard is Standard.AP238):
        raise StepNcError(f"{path}: is a program of standard '{standard.value}' already")
    if standard is Standard.AP238:
        exported = to_ap238(file)
        write_atomically(output, exported.data)
        return exported.findings
    view = AimView.of(file)
    data, left_out = view.with_bodies()
    write_atomically(output, data)
    return (*view.remarks, *left_out)
