"""Commands on block rate and cycle time: ``blocktest``, ``blockfit`` and ``cycletime``."""

import argparse
from pathlib import Path

from service.cli.options import (
    CONTROLS,
    OK,
    Commands,
    add_json,
    add_most_repeats,
    add_program_options,
    output_path,
    program_request,
    text,
)


def add_block_commands(commands: Commands) -> None:
    """Add the commands on block rate and cycle time to ``stepnc``."""
    test = commands.add_parser(
        "blocktest", help="write a test program for the block rate of a control"
    )
    test.fill = _test_options
    _add_fit(commands)
    _add_cycle_time(commands)


def _add_fit(commands: Commands) -> None:
    """Add the command ``stepnc blockfit``."""
    parser = commands.add_parser(
        "blockfit", help="fit a control's time for a block to a log of its test, or to a table"
    )
    add = parser.add_argument
    add(
        "log",
        type=text,
        metavar="LOG",
        help="recorded run (.parquet, .csv), MTConnect document (.xml), address of an agent; "
        "or a table with columns spacing_in and feed_in_min, or spacing_mm and feed_mm_min",
    )
    add("--program", type=Path, metavar="CODE", help="the test program that was run")
    add("--dialect", default="", metavar="NAME", help=f"dialect of the program: {CONTROLS}")
    add(
        "--zero",
        default="",
        metavar="X,Y,Z",
        help="position of the program's zero in the log, in mm (default: 0,0,0, or searched)",
    )
    add("--machine", default="", help="one of `stepnc machines`, or your own file")
    add("-o", "--output", type=output_path, metavar="TOML",
        help="write the machine with its block time")  # fmt: skip
    add(
        "--report",
        type=output_path,
        metavar="HTML",
        help="write a self-contained page with a plot",
    )
    add_json(parser)
    parser.set_defaults(run=_fit)


def _add_cycle_time(commands: Commands) -> None:
    """Add the command ``stepnc cycletime``."""
    parser = commands.add_parser(
        "cycletime",
        help="estimate a program's cycle time from the block rate, and compare it with a log",
    )
    parser.fill = _cycle_time_options


def _cycle_time_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("file", type=Path, metavar="FILE", help="a STEP-NC program (Part 21), or NC code")
    add(
        "log",
        type=text,
        nargs="?",
        default="",
        metavar="LOG",
        help="recorded run (.parquet, .csv), MTConnect document (.xml) or address of an agent",
    )
    add_program_options(parser)
    add("--machine", default="", help="one of `stepnc machines`, or your own file")
    add("--dialect", default="", metavar="NAME", help=f"dialect of NC code: {CONTROLS}")
    add_most_repeats(parser)
    add("--control", default="fir", metavar="NAME",
        help="motion control: fir (default), junction or exact-stop")  # fmt: skip
    add("--deviation-mm", type=float, default=0.01, metavar="MM",
        help="path deviation of the junction control, mm (default: 0.01)")  # fmt: skip
    add("-o", "--output", type=output_path, metavar="CODE",
        help="write NC code with each feed lowered to what will be reached")  # fmt: skip
    add(
        "--report",
        type=output_path,
        metavar="HTML",
        help="write a self-contained page with a plot",
    )
    add_json(parser)
    parser.set_defaults(run=_cycle_time)


def _test_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.blocks import BlockTestRequest
    from service.requests.fields import add_options

    parser.add_argument(
        "-o",
        "--output",
        type=output_path,
        required=True,
        metavar="FILE",
        help="NC code to write",
    )
    add_options(parser, BlockTestRequest)
    parser.set_defaults(run=_test)


def _test(options: argparse.Namespace) -> int:
    """Run the command ``stepnc blocktest``."""
    from service.blocks.block_program import write_test
    from service.requests.blocks import BlockTestRequest
    from service.requests.fields import from_options
    from service.terminal import tell

    write_test(from_options(BlockTestRequest, options), options.output, tell=tell)
    return OK


def _fit(options: argparse.Namespace) -> int:
    """Run the command ``stepnc blockfit``."""
    from service.blocks.block_fit import BlockFitRequest, fit_blocks
    from service.blocks.fit_output import block_fit_json, block_fit_page, print_block_fit
    from service.files import write_atomically
    from service.terminal import tell, write_out

    result = fit_blocks(
        BlockFitRequest(
            log=options.log,
            program=options.program,
            dialect=options.dialect,
            zero=options.zero,
            machine=options.machine,
            output=options.output,
        ),
        tell=tell,
    )
    if options.report is not None:
        write_atomically(options.report, block_fit_page(result).encode())
        tell(f"report: {options.report}")
    if options.json:
        write_out(block_fit_json(result))
    else:
        print_block_fit(result)
    return OK


def _cycle_time(options: argparse.Namespace) -> int:
    """Run the command ``stepnc cycletime``."""
    from service.blocks.cycle_output import cycle_time_json, cycle_time_page, print_cycle_time
    from service.blocks.cycle_time import CycleTimeRequest, cycle_time
    from service.files import write_atomically
    from service.requests.fields import member_of
    from service.terminal import tell, write_out
    from simulator.motion.model_name import ControlModelName

    result = cycle_time(
        CycleTimeRequest(
            file=options.file,
            machine=options.machine,
            log=options.log,
            program=program_request(options),
            dialect=options.dialect,
            control=member_of(ControlModelName, options.control, "control"),
            deviation=options.deviation_mm,
            output=options.output,
            most_repeats=options.most_repeats,
        ),
        tell=tell,
    )
    if options.report is not None:
        write_atomically(options.report, cycle_time_page(result).encode())
        tell(f"report: {options.report}")
    if options.json:
        write_out(cycle_time_json(result))
    else:
        print_cycle_time(result)
    return OK
