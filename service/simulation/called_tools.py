"""Tools of NC code that a table knows otherwise than by a number in the code.

Sinumerik and Heidenhain may call a tool by its name, which is then the ``id`` of the table.
Code of small machines, on which tools are changed by hand, calls none.
"""

from collections.abc import Iterator
from dataclasses import replace

from simulator.tool_files.read import ToolLibrary
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.moves import ModalSetting
from stepnc_model.nc.program import NcProgram


def with_called_tools(program: NcProgram, library: ToolLibrary) -> NcProgram:
    """Return the program with numbers for the tools that it names or leaves out."""
    names = _numbers_by_name(library)
    settings = program.moves.settings
    if _is_without_tools(program) and len(library.tools) == 1:
        only = library.tools[0].number
        found = tuple(replace(each, tool=only) for each in settings)
    else:
        found = tuple(_numbered(each, names) for each in settings)
    return replace(program, moves=replace(program.moves, settings=found))


def called_tool_findings(program: NcProgram, library: ToolLibrary) -> Iterator[Finding]:
    """Findings on tools that the program calls by name, or not at all."""
    names = _numbers_by_name(library)
    for name in dict.fromkeys(each.tool_name for each in program.moves.settings):
        if not name:
            continue
        number = names.get(name.casefold())
        if number is None:
            text = f"tool '{name}' is the id of no tool of the table: its feeds stay"
            yield Finding(severity=Severity.WARNING, message=text)
        else:
            text = f"tool '{name}' is T{number} of the table, by its id"
            yield Finding(severity=Severity.NOTE, message=text)
    if _is_without_tools(program):
        if len(library.tools) == 1:
            text = (
                f"the program calls no tool: T{library.tools[0].number}, the only one of the "
                "table, is taken"
            )
        else:
            text = (
                f"the program calls no tool, and the table has {len(library.tools)}: name a "
                "table with the one that cuts"
            )
        yield Finding(severity=Severity.WARNING, message=text)


def _numbers_by_name(library: ToolLibrary) -> dict[str, int]:
    """Numbers of the tools by their ids in small letters; ids of several tools are left out."""
    found: dict[str, int] = {}
    several = set()
    for tool in library.tools:
        name = tool.id.casefold()
        if name in found:
            several.add(name)
        found[name] = tool.number
    return {name: number for name, number in found.items() if name not in several}


def _numbered(setting: ModalSetting, names: dict[str, int]) -> ModalSetting:
    """Return the setting with the number of the tool that it names, if there is one."""
    if setting.tool is not None:
        return setting
    return replace(setting, tool=names.get(setting.tool_name.casefold()))


def _is_without_tools(program: NcProgram) -> bool:
    """Whether the program calls no tool at all."""
    return all(each.tool is None and not each.tool_name for each in program.moves.settings)
