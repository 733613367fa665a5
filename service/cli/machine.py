"""Command of the virtual machine, ``simulate``."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from service.cli.options import (
    BAD_INPUT,
    CONTROLS,
    LIMIT_EXCEEDED,
    OK,
    Commands,
    add_json,
    add_most_repeats,
)
from service.requests.fields import output_path

if TYPE_CHECKING:
    from service.requests.runs import RunRequest
    from service.simulation.run import RunFiles
    from simulator.tool_files.file_unit import FileUnit

N = TypeVar("N", bound="RunRequest")

USUAL_RATE = 10.0
"""Default number of samples per second in a file."""


def add_machine_commands(commands: Commands) -> None:
    """Add the commands of the virtual machine to ``stepnc``."""
    _add_simulate(commands)


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


def _add_simulate(commands: Commands) -> None:
    parser = commands.add_parser(
        "simulate",
        help="run a program on a virtual machine: time, force, power and energy",
    )
    parser.fill = _simulate_options


def _simulate_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.runs import SimulationRequest

    add = parser.add_argument
    add("file", type=Path, nargs="?", metavar="FILE", help="a STEP-NC program (Part 21)")
    add_options(parser, SimulationRequest, usual={"rate_hz": USUAL_RATE})
    add_code(parser)
    add("--carbon-g-kwh", type=float, metavar="G", help="grams of CO2 per kWh (default 480)")
    add(
        "-o",
        "--output",
        type=output_path,
        metavar="FILE",
        help="write the run, .parquet or .csv",
    )
    add(
        "--report",
        type=output_path,
        metavar="HTML",
        help="write a self-contained page with plots",
    )
    add("--keep-stock", type=output_path, metavar="NPZ",
        help="write the remaining stock, which --stock of a later run can take",
    )  # fmt: skip
    add("--mtconnect", type=output_path, metavar="XML",
        help="write the run as an MTConnect document; in a folder its name is MACHINE_PART.xml",
    )  # fmt: skip
    add("--schema", default="2.7", help="schema version of it: 1.3, 2.0 or 2.7 (default)")
    add("--names", default="modern", help="ids in it: modern (default), or papers")
    add("--part", default="", metavar="ID", help="id of the part in it")
    add("--batch", default="", metavar="ID", help="id of the batch in it")
    add_json(parser)
    parser.set_defaults(run=_simulate)


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


def _simulate(options: argparse.Namespace) -> int:
    """Run the command ``stepnc simulate``."""
    from service.requests.fields import member_of
    from service.requests.runs import SimulationRequest
    from service.simulation.carbon import WORLD, stated
    from service.simulation.run import simulate
    from service.terminal import tell
    from simulator.agent.names import NameSet, SchemaVersion

    carbon = WORLD if options.carbon_g_kwh is None else stated(options.carbon_g_kwh)
    request = run_request(SimulationRequest, options, rate_hz=USUAL_RATE)
    files = run_files(options, options.file)
    if options.mtconnect is None:
        simulation = simulate(request, files, tell=tell)
    else:
        from service.agent.run import DocumentChoice, simulated_with_document

        simulation = simulated_with_document(
            request,
            files,
            options.mtconnect,
            DocumentChoice(
                version=member_of(SchemaVersion, options.schema, "schema version"),
                names=member_of(NameSet, options.names, "set of names"),
                part=options.part,
                batch=options.batch,
            ),
            tell=tell,
        )
    if options.report is not None and simulation.trace is not None:
        from service.files import write_atomically
        from service.simulation.output import simulation_page

        page = simulation_page(
            simulation, simulation.trace, material=simulation.material, carbon=carbon
        )
        write_atomically(options.report, page.encode())
        tell(f"report: {options.report}")
    if options.json:
        from service.simulation.output import simulation_json
        from service.terminal import write_out

        write_out(simulation_json(simulation, carbon=carbon))
    else:
        from service.simulation.output import print_simulation

        print_simulation(simulation, carbon=carbon)
    if simulation.faults:
        return BAD_INPUT
    is_exceeded = simulation.whole.overload_time > 0.0 or bool(simulation.collisions)
    return LIMIT_EXCEEDED if is_exceeded else OK
