"""``stepnc verify``: the part that logged positions left, against the programmed one."""

import argparse
from pathlib import Path

from service.cli.options import LIMIT_EXCEEDED, OK, Commands, add_json
from service.requests.fields import output_path


def add_verify_command(commands: Commands) -> None:
    """Add it to ``stepnc``."""
    parser = commands.add_parser(
        "verify", help="compare the part that logged positions left with the programmed one"
    )
    parser.fill = _verify_options


def _verify_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.verification import VerificationRequest

    add = parser.add_argument
    add(
        "log",
        metavar="LOG",
        help="positions as logged: .parquet, .csv, MTConnect .xml, SHDR, or the address of an "
        "agent, http://HOST:PORT, whose buffer is read",
    )
    add(
        "--program",
        type=Path,
        metavar="FILE",
        help="a STEP-NC program; without one, name --tools, --stock, --required and --machine",
    )
    add_options(parser, VerificationRequest)
    add(
        "--tools",
        type=Path,
        metavar="TABLE",
        help="tool table with the measured tools, by the program's numbers; without a program, "
        "all tools by the numbers of the log",
    )
    add(
        "--required",
        "--part",
        default="",
        metavar="FILE",
        help="required part in coordinates of the setup, in place of the features: an STL file "
        "in mm, or a STEP file, part.step#SOLID where it has several solids",
    )
    add(
        "-o",
        "--output",
        type=output_path,
        metavar="FILE",
        help="write the deviations of places on the surface, .parquet or .csv",
    )
    add(
        "--report",
        type=output_path,
        metavar="HTML",
        help="write a self-contained page with pictures",
    )
    add_json(parser)
    parser.set_defaults(run=_verify)


def _verify(options: argparse.Namespace) -> int:
    """``stepnc verify``."""
    from service.files import require_places, write_atomically
    from service.part_file import part_place
    from service.requests.fields import from_options
    from service.requests.verification import VerificationRequest
    from service.run_file import require_suffix
    from service.terminal import tell
    from service.verification.run import VerificationInputs, verify

    request = from_options(VerificationRequest, options)
    required, solid = part_place(options.required) if options.required else (None, "")
    require_places([options.output, options.report])
    if options.output is not None:
        require_suffix(options.output)
    found = verify(
        options.log,
        options.program,
        request,
        inputs=VerificationInputs(tools=options.tools, required=required, solid=solid),
        tell=tell,
    )
    if options.report is not None:
        from service.verification.output import verification_page

        write_atomically(options.report, verification_page(found).encode())
        tell(f"report: {options.report}")
    if options.output is not None:
        from service.verification.output import write_places

        tell(f"written: {options.output} ({write_places(options.output, found)} places)")
    if options.json:
        from service.terminal import write_out
        from service.verification.output import verification_json

        write_out(verification_json(found))
    else:
        from service.verification.output import print_verification

        print_verification(found)
    return LIMIT_EXCEEDED if found.has_errors else OK
