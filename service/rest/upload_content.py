"""Checks of uploaded files before they are stored: logs, tool tables and required parts."""

from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from xml.parsers import expat

from service.files import require_regular
from service.inputs.part_file import require_part, require_part_form
from service.outputs.parquet_pieces import parquet_file
from service.recording.table import POSITIONS, TABLES, headings
from service.storage.files import FileKind
from simulator.client.columns import TIME
from simulator.tool_files.read import ToolFormat, read_tools
from stepnc_model.errors import StepNcError

NEEDED = (TIME, POSITIONS[0], POSITIONS[2])
"""Columns that every log has; a lathe has no Y."""

MOST_ROWS = 20_000_000
"""Most rows of a Parquet file, which packs equal values into few bytes."""

MOST_ELEMENTS = 1_000_000
"""Most elements of a document, each of which takes many times its text in memory."""

STREAMS = "MTConnectStreams"
"""Root element of a document of streams."""

LOOKED_AT = 100
"""Lines of a log among which one must be SHDR."""

LONGEST_LINE = 1 << 16
"""Most characters of such a line that are looked at."""


def require_content(kind: FileKind, path: Path) -> None:
    """Refuse a file whose content is not of its kind.

    Raises
    ------
    StepNcError
        With what is wrong and where.
    """
    _CHECKS[kind](path)


def _require_log(path: Path) -> None:
    suffix = path.suffix.lower()
    if suffix in TABLES:
        _require_table(path)
    elif suffix == ".xml":
        _require_document(path)
    else:
        _require_lines(path)


def _require_table(path: Path) -> None:
    names = headings(path)
    for needed in NEEDED:
        if needed not in names:
            raise StepNcError(f"{path}: no column {needed}")
    if path.suffix.lower() == ".parquet":
        with parquet_file(path) as file:
            rows = file.metadata.num_rows
        if not 0 < rows <= MOST_ROWS:
            raise StepNcError(f"{path}: {rows} rows: it must be 1 to {MOST_ROWS}")


def _require_document(path: Path) -> None:
    """Refuse a text that is no well-formed document of streams, in little memory."""
    parser, count = expat.ParserCreate(), 0

    def begin(name: str, _attributes: object) -> None:
        nonlocal count
        count += 1
        local = name.rpartition(":")[2]
        if count == 1 and local != STREAMS:
            raise StepNcError(f"{path}: root element {local}; expected {STREAMS}")
        if count > MOST_ELEMENTS:
            raise StepNcError(f"{path}: more than {MOST_ELEMENTS} elements")

    def refuse(*_: object) -> None:
        raise StepNcError(f"{path}: a document type is not accepted")

    parser.StartElementHandler = begin
    parser.StartDoctypeDeclHandler = refuse
    require_regular(path)
    try:
        with path.open("rb") as file:
            parser.ParseFile(file)
    except expat.ExpatError as error:
        raise StepNcError(f"{path}: line {error.lineno}: not well-formed: {error}") from error


def _require_lines(path: Path) -> None:
    """Refuse a text without a line of SHDR: a timestamp, a key and a value."""
    require_regular(path)
    with path.open(encoding="utf-8", errors="replace") as file:
        for _ in range(LOOKED_AT):
            fields = file.readline(LONGEST_LINE).split("|")
            if len(fields) >= 3 and _is_time(fields[0]):
                return
    raise StepNcError(
        f"{path}: no line of SHDR, such as 2026-01-05T06:00:00Z|x_axis_position|12.5, among "
        f"the first {LOOKED_AT}"
    )


def _is_time(text: str) -> bool:
    try:
        datetime.fromisoformat(text.partition("@")[0].strip().replace("Z", "+00:00"))
    except ValueError:
        return False
    return True


def _require_tools(path: Path) -> None:
    if read_tools(path).format is ToolFormat.FREECAD:
        text = "a FreeCAD library consists of several files; send the tools as CSV or TOML"
        raise StepNcError(f"{path}: {text}")


def _require_part(path: Path) -> None:
    require_part(path)


def _require_stock(path: Path) -> None:
    require_part_form(path)


_CHECKS: Mapping[FileKind, Callable[[Path], None]] = {
    FileKind.LOG: _require_log,
    FileKind.TOOLS: _require_tools,
    FileKind.REQUIRED_PART: _require_part,
    FileKind.STOCK: _require_stock,
}
