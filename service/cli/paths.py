"""Commands for tool paths and NC code: ``toolpath``, ``post`` and ``canonical``."""

import argparse
from pathlib import Path

from service.cli.options import (
    BAD_INPUT,
    CONTROLS,
    OK,
    Commands,
    add_json,
    add_program,
    program_request,
)
from service.requests.fields import output_path


def add_path_commands(commands: Commands) -> None:
    """Add the commands for tool paths and NC code to ``stepnc``."""
    _add_toolpath(commands)
    _add_post(commands)
    _add_canonical(commands)


def _add_toolpath(commands: Commands) -> None:
    """Add the command ``stepnc toolpath``."""
    parser = commands.add_parser(
        "toolpath", help="generate the tool paths of a program, or use those that it contains"
    )
    parser.fill = _toolpath_options


def _toolpath_options(parser: argparse.ArgumentParser) -> None:
    add_program(parser)
    _add_keep_going(parser)
    parser.add_argument(
        "--plot", type=output_path, metavar="PNG", help="draw paths, coloured by type"
    )
    add_json(parser)
    parser.set_defaults(run=_toolpath)


def _add_post(commands: Commands) -> None:
    """Add the command ``stepnc post``."""
    parser = commands.add_parser("post", help="write NC code for a control")
    parser.fill = _post_options


def _post_options(parser: argparse.ArgumentParser) -> None:
    add_program(parser)
    parser.add_argument("--control", required=True, metavar="NAME", help=CONTROLS)
    parser.add_argument(
        "-o",
        "--output",
        type=output_path,
        metavar="FILE",
        help="default: next to the program, with the control's file extension",
    )
    parser.add_argument(
        "--cycles", action="store_true", help="use the control's own drilling cycles"
    )
    parser.add_argument(
        "--exact-path",
        action="store_true",
        help="exact stops at corners, instead of rounding them within the path tolerance",
    )
    _add_keep_going(parser)
    parser.set_defaults(run=_post)


def _add_canonical(commands: Commands) -> None:
    """Add the command ``stepnc canonical``."""
    parser = commands.add_parser(
        "canonical", help="show NC code as canonical commands, to compare programs"
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="NC code")
    parser.add_argument("--control", required=True, metavar="NAME", help=CONTROLS)
    parser.add_argument("--lathe", action="store_true", help="Fanuc or Haas code for a lathe")
    parser.set_defaults(run=_canonical)


def _add_keep_going(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--keep-going",
        action="store_true",
        help="skip workingsteps for which no path can be generated; exit code 3 remains",
    )


def _toolpath(options: argparse.Namespace) -> int:
    """Run the command ``stepnc toolpath``."""
    from service.paths import toolpaths
    from service.terminal import tell, write_out

    paths = toolpaths.tool_paths(
        options.file, program_request(options), keep_going=options.keep_going, tell=tell
    )
    if options.plot is not None:
        toolpaths.plot(paths, options.file, options.plot)
        tell(f"picture: {options.plot}")
    if options.json:
        from service.paths.output import paths_json

        write_out(paths_json(paths))
    else:
        from service.paths.output import print_paths

        print_paths(paths)
    return BAD_INPUT if paths.faults else OK


def _post(options: argparse.Namespace) -> int:
    """Run the command ``stepnc post``."""
    from service.paths import toolpaths
    from service.terminal import tell

    paths = toolpaths.post(
        toolpaths.PostRequest(
            file=options.file,
            control=options.control,
            program=program_request(options),
            output=options.output,
            cycles=options.cycles,
            exact_path=options.exact_path,
            keep_going=options.keep_going,
        ),
        tell=tell,
    )
    return BAD_INPUT if paths.faults else OK


def _canonical(options: argparse.Namespace) -> int:
    """Run the command ``stepnc canonical``."""
    from service.paths import toolpaths
    from service.terminal import write_out

    for line in toolpaths.canonical_of(
        options.file, control=options.control, is_lathe=options.lathe
    ):
        write_out(line)
    return OK
