"""Draft of the setup of NC code: each value with where it comes from and how sure it is."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from service.requests.program_facts import StockFile
from service.simulation.code_setup import CodeSetup, GivenSetup
from service.simulation.placement import frame_of_stock
from service.simulation.setup_file import Guessed
from simulator.files.toml_file import changed_keys
from simulator.tool_files.file_unit import FileUnit
from simulator.tools.plausible_tools import ToolGuess
from simulator.tools.tool_table import ToolRow
from simulator.tools.usual_teeth import usual_teeth
from stepnc_model.nc.program import NcProgram
from stepnc_model.nc.remarks import NO_UNIT

HEAD = """\
# Setup of {name}, drafted by `stepnc setup`. Correct it, fill in what is empty, and keep it
# beside the program: stepnc finds it there, or takes it with --setup. What stands in a list
# `guessed` counts for every usual value; take it out of the list when you are sure of it.
"""


class Sureness(StrEnum):
    """Certainty of a value of a draft."""

    GIVEN = "given"
    """By the user."""
    STATED = "stated"
    """By the program."""
    GUESSED = "guessed"
    MISSING = "missing"


@dataclass(frozen=True, slots=True, kw_only=True)
class DraftRow:
    """One value of a draft."""

    name: str
    value: str
    sure: Sureness
    source: str
    """Where the value comes from, in words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupDraft:
    """Draft of a setup: its values, and the text of its file."""

    rows: tuple[DraftRow, ...]
    text: str


def setup_draft(program: NcProgram, known: GivenSetup, setup: CodeSetup) -> SetupDraft:
    """Draft the setup of a program.

    Parameters
    ----------
    setup : CodeSetup
        What was found for it.
    """
    general = tuple(_general(program, known))
    stock = _stock_row(known, setup)
    tools = tuple(_tools(known, setup))
    rows = (*general, stock, *(row for _, rows in tools for row in rows))
    lines = [HEAD.format(name=known.file.name), _key("program", known.file.name)]
    lines += [_key(row.name, row.value, row) for row in general]
    if known.tools is not None:
        lines.append(_key("tools", str(known.tools.resolve())))
    lines += ["", *_stock_lines(setup, stock)]
    for table, of_tool in tools:
        lines += ["", "[[tool]]", *_commented(table, of_tool)]
    if not tools and known.tools is None:
        lines += ["", *NO_TOOL]
    return SetupDraft(rows=rows, text="\n".join(lines) + "\n")


NO_TOOL = (
    "# No tool is known. One [[tool]] for each number that the program calls:",
    "# [[tool]]",
    "# number = 1",
    '# kind = "endmill"        # or drill, facemill, reamer, tap, …: docs/tools_and_stock.md',
    "# diameter_mm = 10",
    "# teeth = 3",
)


def _general(program: NcProgram, setup: GivenSetup) -> Iterator[DraftRow]:
    """Unit, zero, material and machine."""
    unit = FileUnit.INCH if program.unit > 1.0 else FileUnit.MM
    is_assumed = any(each.message.startswith(NO_UNIT) for each in program.findings)
    yield DraftRow(
        name="unit",
        value=unit.value,
        sure=Sureness.GUESSED if is_assumed else Sureness.STATED,
        source="the program states none" if is_assumed else "unit of the program",
    )
    yield DraftRow(
        name="zero",
        value=frame_of_stock(program),
        sure=Sureness.STATED,
        source="frame of the first cut, in which the stock stands",
    )
    for name, value, verb in (
        ("material", setup.material, "materials"),
        ("machine", setup.machine, "machines"),
    ):
        source = "as you named it" if value else f"never guessed: see `stepnc {verb}`"
        sure = Sureness.GIVEN if value else Sureness.MISSING
        yield DraftRow(name=name, value=value, sure=sure, source=source)


def _stock_row(known: GivenSetup, setup: CodeSetup) -> DraftRow:
    stock = setup.stock
    value = str(stock.path) if isinstance(stock, StockFile) else stock
    if not value:
        source = "the code states none, and no tool is known around whose cuts it could be"
        return DraftRow(name="stock", value="", sure=Sureness.MISSING, source=source)
    if known.stock:
        sure, source = Sureness.GIVEN, "as you named it"
    elif setup.is_stock_guessed:
        sure, source = Sureness.GUESSED, "box around the cutting moves, rather too large"
    else:
        sure, source = Sureness.STATED, "stated by the program"
    return DraftRow(name="stock", value=value, sure=sure, source=source)


def _stock_lines(setup: CodeSetup, row: DraftRow) -> Iterator[str]:
    """Lines of the stock; a comment where there is none."""
    if row.sure is Sureness.MISSING:
        yield f"# {row.source}; its numbers are those of --stock:"
        yield "# [stock]"
        yield '# numbers_mm = "X0,Y0,Z0,X1,Y1,Z1"'
        return
    yield "[stock]"
    if isinstance(setup.stock, StockFile):
        yield _key("file", str(setup.stock.path.resolve()), row)
        return
    yield _key("numbers_mm", row.value, row)
    if setup.is_stock_guessed:
        yield "guessed = true"


def _tools(known: GivenSetup, setup: CodeSetup) -> Iterator[tuple[list[str], list[DraftRow]]]:
    """Lines of each tool of the comments, and its values."""
    if known.tools is not None:
        return
    for number, row in setup.rows.items():
        guess = setup.guesses.get(number, ToolGuess())
        found = list(_values(number, row, guess, setup.lines.get(number, 0)))
        yield list(_tool_lines(row, guess)), found


def _tool_lines(row: ToolRow, guess: ToolGuess) -> Iterator[str]:
    """Keys of a tool, and which of them are guesses."""
    for key in dict.fromkeys((*changed_keys(row), Guessed.EDGE.value)):
        value = getattr(row, key)
        yield f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value:.9g}"
    guessed = list(_guessed(row, guess))
    if Guessed.LENGTH in guessed:
        yield "# edge_length_mm = 30"
    if guessed:
        names = ", ".join(f'"{each.value}"' for each in guessed)
        yield f"guessed = [{names}]"


def _guessed(row: ToolRow, guess: ToolGuess) -> Iterator[Guessed]:
    """Keys of a tool that are guessed."""
    if guess.has_kind:
        yield Guessed.KIND
    if guess.has_teeth:
        yield Guessed.TEETH
    if guess.has_edge:
        yield Guessed.EDGE
    if guess.has_length and not row.edge_length_mm:
        yield Guessed.LENGTH


def _values(number: int, row: ToolRow, guess: ToolGuess, line: int) -> Iterator[DraftRow]:
    """Values of a tool that a draft shows."""
    name, by = f"T{number}", f"comment on line {line}"
    size = row.diameter_mm or 0.0
    usual = usual_teeth(row.kind, size)
    for key, value, is_guess, why in (
        ("kind", row.kind.value, guess.has_kind, f"{by} gives only a diameter"),
        ("diameter_mm", f"{size:g}", False, ""),
        ("teeth", f"{row.edges}", guess.has_teeth, f"{usual.least} to {usual.most} are usual"),
        ("cutting_material", row.cutting_material.value, guess.has_edge, "not said"),
        ("edge_length_mm", "", guess.has_length and not row.edge_length_mm, "not said"),
    ):
        sure = Sureness.GUESSED if is_guess else Sureness.STATED
        yield DraftRow(
            name=f"{name} {key}", value=value, sure=sure, source=why if is_guess else by
        )


def _commented(lines: list[str], rows: list[DraftRow]) -> Iterator[str]:
    """Lines of a table with the source of their values."""
    notes = {row.name.partition(" ")[2]: row for row in rows}
    for line in lines:
        row = notes.get(line.partition(" = ")[0])
        yield line if row is None else f"{line:<30}  # {row.sure}: {row.source}"


def _key(name: str, value: str, row: DraftRow | None = None) -> str:
    text = value.replace("\\", "\\\\").replace('"', '\\"')
    line = f'{name} = "{text}"'
    return line if row is None else f"{line:<30}  # {row.sure}: {row.source}"
