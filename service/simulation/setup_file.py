"""Setup of NC code in a file beside it: what ``stepnc setup`` drafts and the user confirms.

``part.nc`` has ``part.setup.toml``. A value that stands in a list ``guessed`` is still a guess,
with the bounds of one; what the user took out of the list is trusted.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from service.inputs.numbers import stock_in
from service.requests.program_facts import RawPart, StockFile
from simulator.errors import LibraryError
from simulator.files.toml_file import FileTable, KeyFault, read_toml
from simulator.tool_files.file_unit import FileUnit
from simulator.tools.plausible_tools import ToolGuess
from simulator.tools.tool_table import TableTool, ToolRow, tool_of_row
from stepnc_model.errors import Finding, Severity, StepNcError

SUFFIX = ".setup.toml"
"""Ending of the file beside a program, in place of the program's own."""


class Guessed(StrEnum):
    """Keys of a tool that may be guesses."""

    KIND = "kind"
    TEETH = "teeth"
    EDGE = "cutting_material"
    LENGTH = "edge_length_mm"


class SetupTool(ToolRow, frozen=True, kw_only=True):
    """``[[tool]]`` of a setup: a row of a tool table, and which of its values are guesses."""

    guessed: tuple[Guessed, ...] = ()


class SetupStock(FileTable, frozen=True, kw_only=True):
    """``[stock]`` of a setup, in coordinates of the program."""

    numbers_mm: str = ""
    file: str = ""
    guessed: bool = False

    def __post_init__(self) -> None:
        if bool(self.numbers_mm) is bool(self.file):
            raise KeyFault("numbers_mm", "give either numbers_mm or file")
        if self.guessed and self.file:
            raise KeyFault("guessed", "a file is no guess")
        if self.numbers_mm:
            try:
                stock_in(self.numbers_mm)
            except StepNcError as error:
                raise KeyFault("numbers_mm", str(error)) from error


class SetupTable(FileTable, frozen=True, kw_only=True):
    """Setup file."""

    program: str = ""
    unit: FileUnit | None = None
    zero: str = ""
    material: str = ""
    machine: str = ""
    tools: str = ""
    stock: SetupStock | None = None
    tool: tuple[SetupTool, ...] = ()

    def __post_init__(self) -> None:
        if self.tools and self.tool:
            raise KeyFault("tools", "names a tool table, and there are [[tool]] too: keep one")
        numbers = [row.number for row in self.tool]
        for at, number in enumerate(numbers, start=1):
            if number in numbers[: at - 1]:
                raise KeyFault(f"tool[{at}].number", f"T{number:g} is there twice")


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupFile:
    """Setup that a file gives; empty values are not given."""

    path: Path
    program: str = ""
    """Name of the program that it was drafted for."""
    unit: FileUnit | None = None
    zero: str = ""
    """Frame in which the stock stands, as the program calls it."""
    material: str = ""
    machine: str = ""
    table: Path | None = None
    """Tool table that it names."""
    tools: tuple[TableTool, ...] = ()
    """Tools ascending by number."""
    guesses: Mapping[int, ToolGuess] = field(default_factory=dict)
    """What is still guessed, by the number of the tool."""
    stock: RawPart = ""
    is_stock_guessed: bool = False


def setup_place(program: Path) -> Path:
    """Return the place of a program's setup file.

    Examples
    --------
    >>> setup_place(Path("jobs/part.nc")).name
    'part.setup.toml'
    """
    return program.with_name(f"{program.stem}{SUFFIX}")


def setup_of(program: Path, named: Path | None) -> SetupFile | Finding | None:
    """Read the setup that is named, or the one beside a program.

    A finding if that is of another program; None without one.

    Raises
    ------
    LibraryError
        With the key, the value and the bound.
    """
    if named is not None:
        return read_setup(named)
    place = setup_place(program)
    if not place.is_file():
        return None
    found = read_setup(place)
    if found.program and found.program != program.name:
        text = f"{place.name} beside it is the setup of {found.program}: it is not used"
        return Finding(severity=Severity.WARNING, message=text)
    return found


def read_setup(path: Path) -> SetupFile:
    """Read a setup file. Files that it names lie beside it, or where the path says.

    Raises
    ------
    LibraryError
        With the key, the value and the bound.
    """
    given = read_toml(path, SetupTable)
    guesses = {
        int(row.number): ToolGuess(
            has_kind=Guessed.KIND in row.guessed,
            has_teeth=Guessed.TEETH in row.guessed,
            has_edge=Guessed.EDGE in row.guessed,
            has_length=Guessed.LENGTH in row.guessed,
        )
        for row in given.tool
        if row.guessed
    }
    for at, row in enumerate(given.tool, start=1):
        if row.lacks_teeth:
            message = f"missing; T{row.number:g} cuts with a number of teeth"
            raise LibraryError(message, path=str(path), key=f"tool[{at}].teeth")
    stock: RawPart = ""
    if given.stock is not None:
        stock = given.stock.numbers_mm
        if given.stock.file:
            stock = StockFile(path=path.parent / given.stock.file)
    return SetupFile(
        path=path,
        program=given.program,
        unit=given.unit,
        zero=given.zero,
        material=_named(given.material, path),
        machine=_named(given.machine, path),
        table=path.parent / given.tools if given.tools else None,
        tools=tuple(sorted(map(tool_of_row, given.tool), key=lambda each: each.number)),
        guesses=guesses,
        stock=stock,
        is_stock_guessed=given.stock is not None and given.stock.guessed,
    )


def _named(name: str, path: Path) -> str:
    """Return a name of the library, or the path of a file that lies beside the setup."""
    beside = path.parent / name
    return str(beside) if Path(name).suffix and beside.is_file() else name
