"""Tools of a file by their numbers, whatever its format.

The content tells the format, not the name of the file: TOML and CSV with the columns of
:mod:`simulator.tools.tool_table`, LinuxCNC's ``tool.tbl``, libraries of Fusion (JSON, or
``.tools``), of HSMWorks (``.hsmlib``) and of FreeCAD (``.fctl``, ``.fctb``).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

from simulator.errors import LibraryError
from simulator.files.toml_file import read_bounded
from simulator.tool_files.csv_table import is_heading, is_passed, read_csv
from simulator.tool_files.file_unit import FileUnit, other_size
from simulator.tool_files.freecad import read_freecad
from simulator.tool_files.fusion import read_fusion
from simulator.tool_files.hsmworks import read_hsmworks
from simulator.tool_files.json_text import parsed_json
from simulator.tool_files.linuxcnc import is_tool_line, read_linuxcnc
from simulator.tool_files.placed_row import PlacedRow, ToolRows, assumed
from simulator.tools.tool_table import TableTool, read_tool_rows, tool_of_row
from stepnc_model.errors import Finding
from stepnc_model.zip_member import DAMAGES, read_member

MOST_BYTES = 1 << 25
"""Greatest size of a library of a CAM system, bytes, also when unpacked."""

ARCHIVED = "tools.json"
"""Name of the document in an archive of Fusion."""


class ToolFormat(StrEnum):
    """Formats of tool files."""

    TOML = "TOML"
    CSV = "CSV"
    LINUXCNC = "LinuxCNC tool table"
    FUSION = "Fusion tool library"
    HSMWORKS = "HSMWorks tool library"
    FREECAD = "FreeCAD tool library"


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolLibrary:
    """Tools of a file, or of the comments of a program."""

    format: ToolFormat | None = None
    """Format of the file; None: comments of a program."""
    tools: tuple[TableTool, ...]
    """Tools, ascending by number; no number is there twice."""
    findings: tuple[Finding, ...] = ()
    """Tools that were left out, and values that were assumed."""

    @property
    def by_number(self) -> dict[int, TableTool]:
        """Tools by their numbers."""
        return {tool.number: tool for tool in self.tools}


def read_tools(path: Path, *, unit: FileUnit | None = None) -> ToolLibrary:
    """Read the tools of a file in any known format.

    Parameters
    ----------
    unit : FileUnit, optional
        Unit of lengths of a format that names none, LinuxCNC's; by default mm.

    Raises
    ------
    LibraryError
        With the line or the path to the value in the file, the value, the bound and the unit:
        if the format is unknown, a value is missing or out of its range, a number is there
        twice, or a diameter contradicts the tool's name by a factor of an inch.
    """
    data = read_bounded(path, most=MOST_BYTES)
    kind, text = _detected(data, path)
    if unit is not None and kind is not ToolFormat.LINUXCNC:
        message = f"a {kind} names its own units; omit the unit {unit}"
        raise LibraryError(message, path=str(path))
    rows = _rows(kind, text, path, unit or FileUnit.MM)
    _require_rows(rows, path)
    _require_numbers_once(rows, path)
    for row in rows.rows:
        _require_named_size(row, path, kind)
    tools = sorted((tool_of_row(each.row) for each in rows.rows), key=lambda each: each.number)
    findings = (*rows.findings, *_without_teeth(rows))
    return ToolLibrary(format=kind, tools=tuple(tools), findings=findings)


def _without_teeth(rows: ToolRows) -> Iterator[Finding]:
    """Findings on tools whose number of teeth the file does not give."""
    for each in rows.rows:
        if each.row.lacks_teeth:
            name = f"T{each.row.number:g}" + (f" '{each.row.id}'" if each.row.id else "")
            how = "its number of teeth is not given: taken for one"
            yield assumed(name, how, line=each.line)


def _detected(data: bytes, path: Path) -> tuple[ToolFormat, str]:
    """Format of a content, and its text."""
    if data.startswith(b"PK\x03\x04"):
        return ToolFormat.FUSION, _unpacked(data, path)
    text = _decoded(data, path)
    lines = (line.strip() for line in text.splitlines())
    first = next(
        (each for each in lines if each and each[0] != ";" and not is_passed(each)), ""
    )
    if first.startswith("<"):
        return ToolFormat.HSMWORKS, text
    if first.startswith("{"):
        return _json_format(text, path), text
    if is_tool_line(first):
        return ToolFormat.LINUXCNC, text
    if is_heading(first):
        return ToolFormat.CSV, text
    if first.startswith("[") or "=" in first or path.suffix.lower() == ".toml":
        return ToolFormat.TOML, text
    known = ", ".join(ToolFormat)
    raise LibraryError(f"is none of the known formats: {known}", path=str(path))


def _decoded(data: bytes, path: Path) -> str:
    """Text of a content, in UTF-8, or in UTF-16 with a byte-order mark."""
    encoding = "utf-16" if data[:2] in {b"\xff\xfe", b"\xfe\xff"} else "utf-8-sig"
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        raise LibraryError(f"is not {encoding} text: {error.reason}", path=str(path)) from error


def _unpacked(data: bytes, path: Path) -> str:
    """Document in an archive."""
    try:
        with ZipFile(BytesIO(data)) as archive:
            content = read_member(archive, archive.getinfo(ARCHIVED), most=MOST_BYTES)
    except KeyError as error:
        raise LibraryError(f"the archive has no {ARCHIVED}", path=str(path)) from error
    except DAMAGES as error:
        raise LibraryError(f"is a damaged archive: {error}", path=str(path)) from error
    return _decoded(content, path)


def _json_format(text: str, path: Path) -> ToolFormat:
    content = parsed_json(text, path)
    if "data" in content:
        return ToolFormat.FUSION
    if "tools" in content or "shape" in content:
        return ToolFormat.FREECAD
    message = "is a JSON document with neither 'data' (Fusion) nor 'tools' or 'shape' (FreeCAD)"
    raise LibraryError(message, path=str(path))


def _rows(kind: ToolFormat, text: str, path: Path, unit: FileUnit) -> ToolRows:
    """Rows of a text in a format."""
    match kind:
        case ToolFormat.TOML:
            rows = enumerate(read_tool_rows(path), start=1)
            return ToolRows(
                rows=tuple(PlacedRow(row=row, place=f"tool[{at}]") for at, row in rows)
            )
        case ToolFormat.CSV:
            return read_csv(text, path)
        case ToolFormat.LINUXCNC:
            return read_linuxcnc(text, path, unit)
        case ToolFormat.FUSION:
            return read_fusion(parsed_json(text, path), path)
        case ToolFormat.HSMWORKS:
            return read_hsmworks(text, path)
        case ToolFormat.FREECAD:
            return read_freecad(parsed_json(text, path), path)


def _require_rows(rows: ToolRows, path: Path) -> None:
    if rows.rows:
        return
    reasons = "; ".join(finding.message for finding in rows.findings[:3])
    message = f"has no tool that can be used{': ' if reasons else ''}{reasons}"
    raise LibraryError(message, path=str(path))


def _require_numbers_once(rows: ToolRows, path: Path) -> None:
    """Refuse a number that two tools have."""
    first: dict[float, PlacedRow] = {}
    for row in rows.rows:
        other = first.setdefault(row.row.number, row)
        if other is not row:
            where = f"line {other.line}" if other.line else other.place
            message = f"T{row.row.number:g} is there twice; first at {where}"
            raise row.error(message, path, "number")


def _require_named_size(row: PlacedRow, path: Path, kind: ToolFormat) -> None:
    """Refuse a diameter that is an inch where the tool's name says a millimetre, or reverse."""
    diameter, name = row.row.diameter_mm, row.row.id or ""
    if row.row.taper_angle_deg:  # the name has the size of the wide end
        return
    size = None if diameter is None else other_size(name, diameter)
    if size is None:
        return
    hint = "; is the table in another unit?" if kind is ToolFormat.LINUXCNC else ""
    message = f"{diameter:g} mm, but its name '{name}' says {size:g} mm{hint}"
    raise row.error(message, path, "diameter_mm")
