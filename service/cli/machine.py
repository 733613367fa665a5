"""Options of ``agent`` for runs on the virtual machine."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from service.cli.options import (
    CONTROLS,
    add_most_repeats,
)

if TYPE_CHECKING:
    from service.requests.runs import RunRequest
    from service.simulation.run import RunFiles
    from simulator.tool_files.file_unit import FileUnit

N = TypeVar("N", bound="RunRequest")


USUAL_RATE = 10.0
"""Default number of samples per second in a file."""


def add_code(parser: argparse.ArgumentParser) -> None:
    """Add the options for NC code, and for the data that it lacks."""
    add = parser.add_argument
    add("--nc", type=Path, metavar="CODE", help="run this NC code instead of the program's own")
    add("--dialect", default="", metavar="NAME", help=f"dialect of the NC code: {CONTROLS}")
    add(
        "--tools",
        type=Path,
        metavar="TABLE",
        help="tool table, for NC code without a program: TOML or CSV, LinuxCNC's tool.tbl, a "
        "library of Fusion (.json, .tools), HSMWorks (.hsmlib) or FreeCAD (.fctl)",
    )
    add("--tools-unit", default="", metavar="UNIT", help="unit of a tool.tbl: mm or inch")
    add_most_repeats(parser)


def run_files(options: argparse.Namespace, file: Path | None) -> "RunFiles":
    """Return the files of a run from the parsed options.

    Raises
    ------
    StepNcError
        When options of NC code alone are given without --nc.
    """
    from service.requests.stock import raw_part_in
    from service.simulation.of_code import CodeRequest
    from service.simulation.run import RunFiles
    from stepnc_model.errors import StepNcError

    code = None
    if options.nc is None and (options.dialect or options.tools):
        raise StepNcError("--dialect and --tools need NC code: name it with --nc")
    if options.tools_unit and options.tools is None:
        raise StepNcError("--tools-unit needs a tool table: name it with --tools")
    if options.nc is not None:
        code = CodeRequest(
            code=options.nc,
            dialect=options.dialect,
            tools=options.tools,
            tools_unit=length_unit(options.tools_unit),
            stock=raw_part_in(options.stock or ""),
            most_repeats=options.most_repeats,
        )
    return RunFiles(
        file=file,
        code=code,
        output=options.output,
        report=getattr(options, "report", None),
        kept=getattr(options, "keep_stock", None),
    )


def run_request(kind: type[N], options: argparse.Namespace, **values: object) -> N:
    """Return the request of a run; a stock that is named for NC code is not the program's.

    Raises
    ------
    StepNcError
        When an option is not valid.
    """
    from dataclasses import replace

    from service.requests.fields import from_options

    request = from_options(kind, options, **values)
    return request if options.nc is None else replace(request, stock="")


def length_unit(name: str) -> "FileUnit | None":
    """Return the unit of a tool table that names none; None if none is given."""
    from service.reading import one_of
    from simulator.tool_files.file_unit import FileUnit

    return one_of(FileUnit, name, "unit") if name else None
