"""Reading of programs, and parsing of option values."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from service.files import read_bytes
from service.inputs.numbers import feed_in
from service.inputs.program_bodies import ProgramBodies
from service.progress import Tell, silent
from service.requests.program_facts import ProgramRequest, RawPart
from stepnc_model.editing.user_data import Completed, GivenData, completed
from stepnc_model.errors import StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.plausibility import units_by_numbers
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.user_tools import GivenTool
from stepnc_model.toolpath.task import drawn_stock
from stepnc_model.units import AUTO, PROFILES, UnitProfile

if TYPE_CHECKING:
    from service.programs.raw_stock import GivenStock
    from simulator.tool_files.file_unit import FileUnit
    from simulator.tool_files.read import ToolLibrary

E = TypeVar("E", bound=StrEnum)

FEEDS = ("feedrate", "feedrate_per_tooth", "feed_per_revolution")
"""Attributes of technologies that give a feed."""


def read_program(
    path: Path, *, units: str, name: str = "", stock: RawPart = "", tell: Tell = silent
) -> Program:
    """Read a program from a file; its name is the file's name unless another is given.

    A raw part that is given counts in place of that of the file, which is told. With the units
    ``auto``, the profile that fits is told, with the numbers of each technology.
    """
    called = name or path.name
    file = Part21File.from_bytes(read_bytes(path), name=called)
    raw = read_stock(stock)
    program = program_in(file, units=units, name=called, stock=raw, tell=tell)
    if program.stock is not None and drawn_stock(program, None) is not None:
        tell(f"raw part: as given, in place of that of '{program.name}'")
    return program


def read_completed(
    path: Path,
    request: ProgramRequest,
    *,
    name: str = "",
    tools: "ToolLibrary | None" = None,
    tell: Tell = silent,
) -> Completed:
    """Read a program with all that a request gives about it: units, raw part, missing data.

    Parameters
    ----------
    name : str
        Name of the program; empty: the name of its file.
    tools : ToolLibrary or None
        Tools of which the file may have nothing but the name.
    tell : callable
        Receives messages.

    Returns
    -------
    Completed
        The program, and the data to be withdrawn from a file that is written.

    Raises
    ------
    StepNcError
        When the file or something that is given is not valid.
    """
    program = read_program(path, units=request.units, stock=request.stock, name=name, tell=tell)
    program.tools = () if tools is None else user_tools(tools)
    whole = completed(program, user_data(request))
    _tell_unused(whole, request, tell)
    return whole


def _tell_unused(whole: Completed, request: ProgramRequest, tell: Tell) -> None:
    """Tell which options have no effect on a program."""
    if request.feed and not any(each.attribute in FEEDS for each in whole.attributes):
        text = "has no effect: each technology gives a feed; --set changes one"
        tell(f"--feed {request.feed} {text}")
    program = whole.program
    names = {str(getattr(program.get(s.tool_ref), "its_id", "")) for s in program.workingsteps}
    if program.tools and not any(
        each.is_named(name) for each in program.tools for name in names
    ):
        of_program = ", ".join(f"'{name}'" for name in sorted(names))
        of_table = ", ".join(f"'{each.id}'" for each in program.tools)
        tell(f"--tools has no effect: the program has tools {of_program}, the table {of_table}")


def user_data(request: ProgramRequest) -> GivenData:
    """Data that a file lacks, from the words of a request."""
    return GivenData(
        values=request.given,
        teeth=request.teeth,
        feed=feed_in(request.feed) if request.feed else None,
    )


def user_tools(library: "ToolLibrary") -> tuple[GivenTool, ...]:
    """Tools of a table, for a program that only names them."""
    from simulator.tools.program_tools import user_tool  # noqa: PLC0415 (numpy)

    return tuple(user_tool(tool) for tool in library.tools)


def tool_library(path: Path | None, unit: "FileUnit | None" = None) -> "ToolLibrary | None":
    """Read a tool table; None without a file."""
    if path is None:
        return None
    from simulator.tool_files.read import read_tools  # noqa: PLC0415 (numpy)

    return read_tools(path, unit=unit)


def program_in(
    file: Part21File,
    *,
    units: str,
    name: str,
    stock: "GivenStock | None" = None,
    tell: Tell = silent,
) -> Program:
    """Program of a file in the named units, or in those that its numbers show.

    Raises
    ------
    StepNcError
        When the units are unknown or, for ``auto``, not shown by the numbers.
    """
    bodies = ProgramBodies(tell, None if stock is None else stock.triangles)
    bounds = None if stock is None else stock.bounds
    if units != AUTO:
        profile = unit_profile(units)
        return Program(file, units=profile, name=name, stock=bounds, bodies=bodies)
    program = Program(file, name=name, stock=bounds, bodies=bodies)
    profile, evidence = units_by_numbers(program, program.workingsteps)
    tell(f"units: {profile.name}, the only ones that make all numbers plausible")
    for each in evidence:
        tell(f"  line {each.line}: {each.entity}: {each.message}")
    return Program(file, units=profile, name=name, stock=bounds, bodies=bodies)


def read_stock(part: RawPart) -> "GivenStock | None":
    """Read a raw part, in numbers or from a file; None for an empty text."""
    if not part:
        return None
    from service.programs.raw_stock import user_stock  # noqa: PLC0415 (numpy)

    return user_stock(part)


def unit_profile(name: str) -> UnitProfile:
    """Return the unit profile with the given name."""
    if name not in PROFILES:
        known = ", ".join((*PROFILES, AUTO))
        raise StepNcError(f"unknown units '{name}'; known: {known}")
    return PROFILES[name]


def one_of(kinds: type[E], word: str, what: str) -> E:
    """Return the enumeration member with the given value."""
    try:
        return kinds(word)
    except ValueError:
        known = ", ".join(kind.value for kind in kinds)
        raise StepNcError(f"unknown {what} '{word}'; known: {known}") from None


def selected(program: Program, wanted: tuple[str, ...]) -> tuple[ResolvedWorkingstep, ...]:
    """Select workingsteps by id or #instance; all if none is named.

    Raises
    ------
    StepNcError
        When a named workingstep does not exist.
    """
    if not wanted:
        return program.workingsteps
    found = tuple(
        step for step in program.workingsteps if step.id in wanted or str(step.ref) in wanted
    )
    names = {step.id for step in found} | {str(step.ref) for step in found}
    missing = [name for name in wanted if name not in names]
    if missing:
        known = ", ".join(f"'{step.id}' ({step.ref})" for step in program.workingsteps)
        raise StepNcError(f"no workingstep '{missing[0]}'; known: {known}")
    return found
