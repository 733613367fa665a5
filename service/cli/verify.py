"""``stepnc verify``: the part that logged positions left, against the programmed one."""

import argparse
import re
from pathlib import Path

from service.cli.options import LIMIT_EXCEEDED, OK, Commands, add_json


def add_verify_command(commands: Commands) -> None:
    """Add it to ``stepnc``."""
    parser = commands.add_parser(
        "verify", help="compare the part that logged positions left with the programmed one"
    )
    parser.fill = _verify_options


def _verify_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.verification import VerificationRequest

    # Coordinates may be negative: "-3,-3,-40" is not an option.
    parser._negative_number_matcher = re.compile(r"-[.\d]")
    add = parser.add_argument
    add("log", type=Path, metavar="LOG", help="positions as logged: .parquet or .csv")
    add("--program", type=Path, required=True, metavar="FILE", help="a STEP-NC program")
    add_options(parser, VerificationRequest)
    add(
        "--tools",
        type=Path,
        metavar="TOML",
        help="tool table with the measured tools, by the program's numbers",
    )
    add_json(parser)
    parser.set_defaults(run=_verify)


def _verify(options: argparse.Namespace) -> int:
    """``stepnc verify``."""
    from service.cli.machine import interruptible
    from service.requests.fields import from_options
    from service.requests.verification import VerificationRequest
    from service.terminal import tell
    from service.verification.run import verify

    request = from_options(VerificationRequest, options)
    with interruptible():
        found = verify(options.log, options.program, request, tools=options.tools, tell=tell)
    if options.json:
        from service.terminal import write_out
        from service.verification.output import verification_json

        write_out(verification_json(found))
    else:
        from service.verification.output import print_verification

        print_verification(found)
    return LIMIT_EXCEEDED if found.has_errors else OK
