"""Commands on block rate: ``blocktest`` and ``blockfit``."""

import argparse
from pathlib import Path

from service.cli.options import CONTROLS, OK, Commands, add_json, text
from service.requests.fields import output_path


def add_block_commands(commands: Commands) -> None:
    """Add the commands on block rate to ``stepnc``."""
    test = commands.add_parser(
        "blocktest", help="write a test program for the block rate of a control"
    )
    test.fill = _test_options
    _add_fit(commands)


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
