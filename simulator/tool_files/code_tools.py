"""Tools that the comments of an NC program describe, and what is guessed about them.

A comment that names a tool's number counts wherever it stands. One without a number counts for
the tool that is called in its block, or next behind it before anything moves, or just before
it. Comments that contradict each other about a tool leave it out: its feeds then stay.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from simulator.errors import LibraryError
from simulator.spec import ToolKind
from simulator.tool_files.file_unit import ALIKE, other_size
from simulator.tool_files.placed_row import FileValue, PlacedRow, assumed, left_out, placed_row
from simulator.tool_files.tool_note import ToolNote, defined_note, note_of
from simulator.tools.plausible_tools import ToolGuess
from simulator.tools.tool_table import TURNED, TableTool, ToolRow, tool_of_row
from simulator.tools.usual_teeth import usual_teeth
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.comments import CalledTool, CodeComment, remarks_of
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.dialect import Dialect

NEAR = 12
"""Greatest number of blocks from a comment to the tool call that it is about."""

GREATEST = 200.0
"""Diameter above which a comment is taken for one in another unit, mm."""

POINTED = {ToolKind.DRILL, ToolKind.CENTER_DRILL, ToolKind.COUNTERSINK}


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeTools:
    """Tools of the comments of a program."""

    tools: tuple[TableTool, ...] = ()
    """Tools, ascending by number."""
    rows: Mapping[int, ToolRow] = field(default_factory=dict)
    """Rows of a tool table by the numbers of the tools."""
    guesses: Mapping[int, ToolGuess] = field(default_factory=dict)
    """What is guessed, by the number of the tool."""
    lines: Mapping[int, int] = field(default_factory=dict)
    """Line of the comment of each tool."""
    findings: tuple[Finding, ...] = ()
    """Tools that were left out, and values that were guessed."""

    @property
    def by_number(self) -> dict[int, TableTool]:
        """Tools by their numbers."""
        return {tool.number: tool for tool in self.tools}


def tools_of_code(program: NcProgram, *, name: str = "") -> CodeTools:
    """Read the tools that the comments of a program describe.

    Parameters
    ----------
    name : str
        Name of the program, for messages.
    """
    found: list[TableTool] = []
    guesses: dict[int, ToolGuess] = {}
    lines: dict[int, int] = {}
    rows: dict[int, ToolRow] = {}
    findings: list[Finding] = []
    for number, notes in sorted(_by_number(program).items()):
        known = [note for note in notes if note.diameter is not None]
        if not known:
            continue
        whole = _joined(known)
        why = _why_left_out(known)
        made = _row(number, whole, name) if why is None else why
        if isinstance(made, str):
            findings.append(left_out(f"T{number}", made, line=known[-1].line))
            continue
        tool = tool_of_row(made.row)
        found.append(tool)
        rows[number] = made.row
        lines[number] = whole.line
        guess = ToolGuess(
            has_kind=whole.kind is None,
            has_teeth=whole.teeth is None,
            has_edge=whole.edge is None,
        )
        guesses[number] = guess
        findings.append(_said(tool, whole, guess))
    return CodeTools(
        tools=tuple(found), rows=rows, guesses=guesses, lines=lines, findings=tuple(findings)
    )


def against_table(tools: CodeTools, table: Mapping[int, TableTool]) -> Iterator[Finding]:
    """Findings on tools of a table that differ from what the comments say; the table counts."""
    for number, tool in tools.by_number.items():
        other = table.get(number)
        if other is None or other.kind in TURNED:
            continue
        one, two = _size(tool), _size(other)
        if abs(one - two) > ALIKE * two:
            text = f"T{number} has {two:g} mm in the tool table, which counts, but a comment "
            yield Finding(
                severity=Severity.WARNING,
                message=text + f"says {one:g} mm",
                line=tools.lines[number],
            )


def _size(tool: TableTool) -> float:
    """Diameter of a tool, mm; 0 for one that turns."""
    return float(getattr(tool.shape, "diameter", 0.0))


def _by_number(program: NcProgram) -> dict[int, list[ToolNote]]:
    """Notes of each tool, in the order of the file."""
    found: dict[int, list[ToolNote]] = {}
    loose: list[tuple[int, ToolNote]] = []
    nobody: list[ToolNote] = []
    called: CalledTool | None = None
    is_called = False
    for each in remarks_of(program.text, program.dialect):
        if isinstance(each, CalledTool):
            called, is_called = each, True
            for block, note in loose:
                if each.block - block <= NEAR:
                    found.setdefault(each.number, []).append(note)
            loose.clear()
        elif isinstance(each, CodeComment):
            note = note_of(each.text, line=each.line, unit=program.unit)
            if not note.is_of_tool:
                continue
            if note.number is not None:
                found.setdefault(note.number, []).append(note)
            elif called is not None and each.block - called.block <= NEAR:
                found.setdefault(called.number, []).append(note)
            else:
                loose.append((each.block, note))
                nobody.append(note)
        else:
            called = None
            loose.clear()
    for note in _defined(program):
        found.setdefault(note.number or 0, []).append(note)
    if not is_called and not found and len({_key(note) for note in nobody}) == 1:
        found[1] = nobody
    return found


def _key(note: ToolNote) -> tuple[object, ...]:
    return note.diameter, note.kind, note.corner_radius


def _defined(program: NcProgram) -> Iterator[ToolNote]:
    """Tools that Klartext defines."""
    if program.dialect is not Dialect.HEIDENHAIN or b"TOOL DEF" not in program.text.data:
        return
    text = program.text
    for index, block in enumerate(text.blocks()):
        note = defined_note(block, line=text.line(index), unit=program.unit)
        if note is not None and note.diameter is not None:
            yield note


def _why_left_out(notes: list[ToolNote]) -> str | None:
    """Reason why comments make no tool; None if they make one."""
    first = notes[0]
    for note in notes:
        sizes = note.diameter or 0.0, first.diameter or 0.0
        if abs(sizes[0] - sizes[1]) > ALIKE * sizes[1]:
            return (
                f"its comments contradict each other: {sizes[1]:g} mm (line {first.line}) and "
                f"{sizes[0]:g} mm"
            )
        other = other_size(note.text, sizes[0])
        if other is not None:
            return (
                f"its comment gives {sizes[0]:g} mm by the unit of the program and {other:g} mm"
            )
    for what, values in (
        ("kinds", {note.kind for note in notes if note.kind is not None}),
        ("numbers of teeth", {note.teeth for note in notes if note.teeth is not None}),
    ):
        if len(values) > 1:
            named = " and ".join(sorted(str(value) for value in values))
            return f"its comments contradict each other: {what} {named}"
    if (first.diameter or 0.0) > GREATEST:
        return f"its comment gives {first.diameter:g} mm; is this the unit of the program?"
    return None


def _joined(notes: list[ToolNote]) -> ToolNote:
    """One note with what each of several says."""
    whole = notes[0]
    for note in notes[1:]:
        whole = replace(
            whole,
            kind=whole.kind or note.kind,
            teeth=whole.teeth or note.teeth,
            edge=whole.edge or note.edge,
            corner_radius=whole.corner_radius
            if whole.corner_radius is not None
            else note.corner_radius,
            angle_deg=whole.angle_deg or note.angle_deg,
            is_chamfer=whole.is_chamfer or note.is_chamfer,
            is_bull=whole.is_bull or note.is_bull,
            is_shaped=whole.is_shaped or note.is_shaped,
        )
    return whole


def _row(number: int, note: ToolNote, name: str) -> PlacedRow | str:
    """Row of a tool table; or why the comment is not enough for one."""
    kind = note.kind or ToolKind.ENDMILL
    if note.is_shaped:
        return "no comment tells its shape"
    if note.is_chamfer and not note.angle_deg:
        return "its comment gives no angle of the chamfer"
    if note.is_bull and not note.corner_radius:
        return "its comment gives no corner radius"
    diameter = note.diameter or 0.0
    values: dict[str, object] = {"number": number, "kind": kind.value, "diameter_mm": diameter}
    values["teeth"] = note.teeth or usual_teeth(kind, diameter).usual
    if note.edge is not None:
        values["cutting_material"] = note.edge.value
    if kind in POINTED and note.angle_deg:
        values["point_angle_deg"] = note.angle_deg
    elif note.is_chamfer and note.angle_deg:
        values["point_angle_deg"] = 2.0 * note.angle_deg
    elif kind is ToolKind.ENDMILL and note.angle_deg:
        values["taper_angle_deg"] = note.angle_deg
    if kind not in POINTED and note.corner_radius:
        values["corner_radius_mm"] = note.corner_radius
    given = {key: FileValue(value=value, place=key) for key, value in values.items()}
    try:
        return placed_row(given, Path(name), line=note.line)
    except LibraryError as error:
        return f"{error.key}: {error.message}" if error.key else error.message


def _said(tool: TableTool, note: ToolNote, guess: ToolGuess) -> Finding:
    """Finding that says what a comment gives and what is guessed."""
    guessed = []
    if guess.has_kind:
        guessed.append("its kind")
    if guess.has_teeth:
        usual = usual_teeth(tool.kind, _size(tool))
        guessed.append(f"{tool.teeth} teeth ({usual.least} to {usual.most} are usual)")
    if guess.has_edge:
        guessed.append(f"{tool.cutting_material} edges")
    what = f"T{tool.number} is a {_size(tool):g} mm {tool.kind.replace('_', ' ')} by a comment"
    if not guessed:
        return Finding(severity=Severity.NOTE, message=what, line=note.line)
    return assumed(what, f"guessed: {', '.join(guessed)}", line=note.line)
