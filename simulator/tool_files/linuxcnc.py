"""LinuxCNC's tool table, ``tool.tbl``.

One tool a line: ``T1 P1 Z0.511 D0.125 ;1/8 end mill``. Lengths are in the units of the machine,
which the file does not name. A remark is all that tells the kind of a milling tool and its
teeth. A tool with an orientation Q or with angles I and J is a turning tool: D is the diameter
of its nose, I and J are the angles of its edges from the direction of Z away from the chuck
towards that of X away from the axis, Q says where the nose lies beside the programmed point.

References
----------
[1] LinuxCNC, G-code documentation, "Tool Compensation", section "Tool Table Format".
[2] LinuxCNC, "Lathe User Information", tool orientations and angles; the nose lies beside the
    programmed point as its display draws it: 1 (x, −z), 2 (x, z), 3 (−x, z), 4 (−x, −z),
    6 (x, 0), 8 (−x, 0).
"""

import re
from collections.abc import Iterator
from pathlib import Path

from simulator.errors import LibraryError
from simulator.spec import ToolKind
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.placed_row import (
    FileValue,
    PlacedRow,
    ToolRows,
    assumed,
    file_length,
    left_out,
    placed_row,
)
from simulator.tool_files.tool_words import TEETH, kind_in
from simulator.tools.tool_table import ToolHand
from stepnc_model.errors import Finding

WORDS = "TPXYZABCUVWDIJQ"

INSIDE = {3, 4, 8}
"""Orientations of boring tools."""

HANDS = {
    1: ToolHand.LEFT,
    2: ToolHand.RIGHT,
    3: ToolHand.RIGHT,
    4: ToolHand.LEFT,
    6: ToolHand.NEUTRAL,
    8: ToolHand.NEUTRAL,
}

SAME_ANGLE = 0.5
"""Degrees by which the two edges of a neutral insert may differ."""

_WORD = re.compile(r"([A-Za-z])\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?=\s|$)")


def is_tool_line(line: str) -> bool:
    """True if a line is one of a tool table."""
    return re.match(r"\s*[TP]\s*\d+(?:\s|;|$)", line) is not None


def read_linuxcnc(text: str, path: Path, unit: FileUnit) -> ToolRows:
    """Read the tools of a table.

    Parameters
    ----------
    path : Path
        The file, for messages.
    unit : FileUnit
        Unit of the machine.

    Raises
    ------
    LibraryError
        With the line, the value, the bound and the unit.
    """
    rows: list[PlacedRow] = []
    findings: list[Finding] = []
    for line, words, remark in _lines(text, path):
        reason = _unusable(words)
        if reason:
            findings.append(left_out(f"T{words['T']:g}", reason, line=line))
            continue
        if "Q" in words or "I" in words or "J" in words:
            given = _insert(words, unit)
        else:
            given, notes = _cutter(words, remark, unit)
            findings += [assumed(f"T{words['T']:g}", note, line=line) for note in notes]
        rows.append(placed_row(given, path, line=line))
    return ToolRows(rows=tuple(rows), findings=tuple(findings))


def _lines(text: str, path: Path) -> Iterator[tuple[int, dict[str, float], str]]:
    """Lines with tools: number, words and remark."""
    for number, line in enumerate(text.splitlines(), start=1):
        code, _, remark = line.partition(";")
        if code.strip():
            yield number, _words(code, path, number), remark.strip()


def _words(code: str, path: Path, line: int) -> dict[str, float]:
    """Words of a line by their letters."""
    words: dict[str, float] = {}
    rest = code
    while rest := rest.lstrip():
        found = _WORD.match(rest)
        letter = "" if found is None else found[1].upper()
        if found is None or letter not in WORDS:
            message = f"'{rest.split()[0][:40]}' is not a word of a tool table: {WORDS}"
            raise LibraryError(message, path=str(path), line=line)
        if letter in words:
            message = f"{letter} is there twice"
            raise LibraryError(message, path=str(path), key=letter, line=line)
        words[letter] = float(found[2])
        rest = rest[found.end() :]
    for letter in "TP":
        if letter not in words:
            message = "missing; every tool has a number T and a pocket P"
            raise LibraryError(message, path=str(path), key=letter, line=line)
    return _nonzero_words(words)


def _nonzero_words(words: dict[str, float]) -> dict[str, float]:
    """Words without I0 J0 Q0, which editors write where nothing is given."""
    absent = {"Q"} if not words.get("Q") else set()
    if not words.get("I") and not words.get("J"):
        absent |= {"I", "J"}
    return {letter: value for letter, value in words.items() if letter not in absent}


def _unusable(words: dict[str, float]) -> str:
    """Reason why a tool cannot be used; empty if it can."""
    if words["T"] == 0.0:
        return "number 0 is an empty spindle"
    if not words.get("D", 0.0) and not {"Q", "I", "J"} & set(words):
        return "it has no diameter D"
    orientation = words.get("Q", 0.0)
    if orientation in {5.0, 7.0, 9.0}:
        return f"orientation Q{orientation:g} has no edge towards the axis or a bore"
    if not orientation and ("I" in words or "J" in words):
        return "it has edge angles I and J but no orientation Q"
    if HANDS.get(int(orientation)) is ToolHand.NEUTRAL and (
        abs(sum(_edges(words)) - 180.0) > SAME_ANGLE
    ):
        return f"the edges of orientation Q{orientation:g} lean differently"
    return ""


def _edges(words: dict[str, float]) -> tuple[float, float]:
    """Angles of the edges from Z, degrees, the lesser first, mirrored for a bore."""
    angles = [words.get("I", 0.0) % 360.0, words.get("J", 0.0) % 360.0]
    if int(words.get("Q", 0.0)) in INSIDE:
        angles = [(360.0 - angle) % 360.0 for angle in angles]
    return min(angles), max(angles)


def _insert(words: dict[str, float], unit: FileUnit) -> dict[str, FileValue]:
    """Values of a turning tool."""
    orientation = words.get("Q", 0.0)
    given = {
        "number": FileValue(value=words["T"], place="T"),
        "kind": FileValue(value=ToolKind.TURNING.value, place="Q"),
        "nose_radius_mm": _half(words.get("D", 0.0), unit),
        "inside": FileValue(value=orientation in INSIDE, place="Q"),
        "hand": FileValue(value=HANDS.get(int(orientation), f"Q{orientation:g}"), place="Q"),
    }
    if "I" not in words or "J" not in words:
        return given
    low, high = _edges(words)
    # The project counts the edge at the chuck from the direction towards it.
    leading, trailing = 180.0 - high, low
    if given["hand"].value == ToolHand.LEFT:
        leading, trailing = trailing, leading
    given["cutting_edge_angle_deg"] = FileValue(value=leading, place="I, J")
    if given["hand"].value != ToolHand.NEUTRAL:
        given["trailing_angle_deg"] = FileValue(value=trailing, place="I, J")
    return given


def _half(diameter: float, unit: FileUnit) -> FileValue:
    """Radius of a diameter that may be negative, mm."""
    value = 0.5 * unit.mm(abs(diameter))
    return FileValue(value=value, place="D", written=f"a diameter of {diameter:g} {unit}")


def _cutter(
    words: dict[str, float], remark: str, unit: FileUnit
) -> tuple[dict[str, FileValue], list[str]]:
    """Values of a rotating tool, and what was assumed about it."""
    lower, notes = remark.lower(), []
    kind = kind_in(lower)
    if kind is None:
        notes.append("no remark tells its kind: taken for an end mill")
        kind = ToolKind.ENDMILL
    given = {
        "number": FileValue(value=words["T"], place="T"),
        "kind": FileValue(value=kind.value, place="the remark"),
        "diameter_mm": file_length(abs(words["D"]), "D", unit),
    }
    if remark:
        given["id"] = FileValue(value=remark, place="the remark")
    if kind is ToolKind.ENDMILL and "ball" in lower:
        given["corner_radius_mm"] = _half(words["D"], unit)
    teeth = TEETH.search(lower)
    if teeth:
        count = float(teeth[1] or teeth[2])
        given["teeth"] = FileValue(value=count, place="the remark")
    return given, notes
