"""Row of a tool table with its place in the file that it was read from."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from simulator.errors import LibraryError
from simulator.files.toml_file import converted
from simulator.spec import CuttingMaterial
from simulator.tool_files.file_unit import FileUnit
from simulator.tools.tool_table import ToolRow
from stepnc_model.errors import Finding, Severity

EDGE_WORDS = {
    "carbide": CuttingMaterial.CARBIDE,
    "solid carbide": CuttingMaterial.CARBIDE,
    "hm": CuttingMaterial.CARBIDE,
    "hss": CuttingMaterial.HSS,
    "hsse": CuttingMaterial.HSS,
    "cobalt": CuttingMaterial.HSS,
    "ceramic": CuttingMaterial.CERAMIC,
    "ceramics": CuttingMaterial.CERAMIC,
}
"""Names of edge materials in files of CAM systems, in lower case."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileValue:
    """Value of a key of a tool row, as a file gives it."""

    value: object
    """In the unit of the key."""
    place: str
    """Where the file gives it: a column, an attribute, or the path to a JSON value."""
    written: str = ""
    """What the file says if its unit is another one, such as ``500 inch``."""


def file_length(value: object, place: str, unit: FileUnit) -> FileValue:
    """Length of a file in mm; what is no number stays as it is, to be refused."""
    if unit is FileUnit.MM or isinstance(value, bool) or not isinstance(value, int | float):
        return FileValue(value=value, place=place)
    return FileValue(value=unit.mm(value), place=place, written=f"{value:g} {unit}")


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedRow:
    """Tool row and where it stands."""

    row: ToolRow
    place: str = ""
    """Path to the tool in the file; empty if the line gives the place."""
    line: int = 0
    """Line of the file, counted from 1; 0 if there is none."""
    values: Mapping[str, FileValue] = field(default_factory=dict)
    """Values by the keys of a tool row."""

    def error(self, message: str, path: Path, key: str) -> LibraryError:
        """Error at a key of this row, named as the file names it."""
        given = self.values.get(key)
        place = key if given is None else given.place
        if given is None and self.place:
            place = f"{self.place}.{key}"
        return LibraryError(message, path=str(path), key=place, line=self.line)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolRows:
    """Rows of a tool file, with what was left out or assumed."""

    rows: tuple[PlacedRow, ...]
    findings: tuple[Finding, ...] = ()


def placed_row(
    values: Mapping[str, FileValue], path: Path, *, place: str = "", line: int = 0
) -> PlacedRow:
    """Check the values of a tool and make a row of them.

    Parameters
    ----------
    values : mapping of str to FileValue
        Values by the keys of a tool row.
    path : Path
        The file, for messages.
    place : str
        Path to the tool in the file.
    line : int

    Raises
    ------
    LibraryError
        With the place in the file, the value, the bound and the unit.
    """
    content = {key: each.value for key, each in values.items()}
    try:
        row = converted(content, ToolRow, path, line=line)
    except LibraryError as error:
        at = values.get(error.key)
        shown = error.key if at is None else at.place
        if at is None and place:
            shown = f"{place}: {error.key}" if error.key else place
        message = error.message
        if at is not None and at.written:
            message = f"{message} (the file says {at.written})"
        raise LibraryError(message, path=str(path), key=shown, line=line) from error
    return PlacedRow(row=row, place=place, line=line, values=values)


def edge_values(name: object, place: str) -> dict[str, FileValue]:
    """Cutting material of a name; nothing if the name is not one of an edge material."""
    material = EDGE_WORDS.get(str(name).strip().lower())
    if material is None:
        return {}
    return {"cutting_material": FileValue(value=material.value, place=place)}


def left_out(what: str, why: str, *, line: int = 0) -> Finding:
    """Finding about a tool of the file that cannot be used."""
    message = f"{what} is left out: {why}"
    return Finding(severity=Severity.WARNING, message=message, line=line)


def assumed(what: str, how: str, *, line: int = 0) -> Finding:
    """Finding about a value that the file does not give."""
    return Finding(severity=Severity.WARNING, message=f"{what}: {how}", line=line)
