"""The command ``optimise`` for NC code. Imports are late, so that ``--help`` stays quick."""

import argparse
from typing import TYPE_CHECKING

from service.cli.options import LIMIT_EXCEEDED, NOTHING_ADVISED, OK

if TYPE_CHECKING:
    from service.program_kind import ProgramKind


def require_typed_served(options: argparse.Namespace, kind: "ProgramKind") -> None:
    """Refuse options that were typed and that a kind of program cannot use.

    Raises
    ------
    StepNcError
        With the option and the reason.
    """
    from service.requests.serves import require_options_served

    given = {name: value for name, value in vars(options).items() if value}
    require_options_served(given, kind, flags=options.flags)


def optimise_code(options: argparse.Namespace) -> int:
    """Plan the feeds along the paths of NC code and write them into a copy of it."""
    from service.along_path.code_output import code_advice_json, print_code_advice, write_views
    from service.along_path.of_code import CodeFiles
    from service.along_path.of_code import optimise_code as optimise
    from service.cli.machine import length_unit
    from service.requests.advice import AdviceRequest
    from service.requests.fields import from_options
    from service.terminal import tell, write_out

    files = CodeFiles(
        file=options.file,
        tools=options.tools,
        tools_unit=length_unit(options.tools_unit),
        output=options.output,
        in_place=options.in_place,
        dry_run=options.dry_run,
        report=options.report,
        feeds=options.feeds_csv,
        most_repeats=options.most_repeats,
        holding=options.holding,
        knowledge=options.kb,
    )
    found = optimise(from_options(AdviceRequest, options), files, tell=tell)
    write_views(found, files, tell=tell)
    if options.json:
        write_out(code_advice_json(found))
    else:
        print_code_advice(found)
    if found.faults:
        return LIMIT_EXCEEDED
    return OK if found.is_advised else NOTHING_ADVISED
