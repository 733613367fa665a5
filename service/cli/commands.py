"""Commands of ``optimise`` and ``stepnc``, a thin layer above :mod:`service.usecases`.

Data goes to stdout, messages and progress to stderr. Slow imports stay inside the commands, so
that ``--help`` answers at once.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from service.cli.control import add_control_command
from service.cli.kbe import USAGE, add_knowledge_commands
from service.cli.machine import add_machine_commands
from service.cli.options import (
    BAD_INPUT,
    INFEASIBLE,
    OK,
    CommandParser,
    Commands,
    add_json,
    add_most_repeats,
    add_program,
    program_request,
)
from service.cli.paths import add_path_commands
from service.cli.serve import add_service_commands
from service.cli.verbs import add_verb, verb_parser
from service.requests.fields import output_path
from service.verbs.verb import verbs

EXAMPLES = """examples:
  optimise part.stpnc --mode TC --machine vmc15
  optimise part.stpnc --mode QC --roughness 1.6 --report part.html
  optimise part.stpnc --mode EC --free feed,depth,speed --dry-run --json
  stepnc check part.stpnc
  stepnc toolpath part.stpnc --plot path.png
  stepnc post part.stpnc --control linuxcnc

Optimise the feeds of a STEP-NC program and write them back as STEP-NC."""


def parser() -> argparse.ArgumentParser:
    """Return the complete parser of ``stepnc``, with the options of all commands."""
    top, commands = _commands()
    for each in commands.choices.values():
        each.complete()
    return top


def _commands() -> tuple[argparse.ArgumentParser, Commands]:
    """Return the parser, whose commands get their options on first use."""
    top = argparse.ArgumentParser(
        prog="stepnc",
        description=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument(
        "--print-completion",
        choices=("bash", "zsh", "tcsh"),
        help="print a completion script for a shell",
    )
    commands = top.add_subparsers(dest="command", metavar="COMMAND", parser_class=CommandParser)
    add_verb(commands, verbs()["optimise"])
    _add_check(commands)
    _add_convert(commands)
    add_path_commands(commands)
    add_machine_commands(commands)
    add_knowledge_commands(commands)
    add_control_command(commands)
    for verb in verbs().values():
        if verb.name not in commands.choices:
            add_verb(commands, verb)
    add_service_commands(commands)
    for kind in ("machines", "materials"):
        listing = commands.add_parser(kind, help=f"list the {kind}, or show one")
        listing.add_argument("name", nargs="?", default="", help="show only this one, in full")
        add_json(listing)
        listing.set_defaults(run=_show_library)
    return top, commands


def parsed(name: str, arguments: Sequence[str] | None = None) -> Callable[[], int]:
    """Read a command line; return the work of its command, which returns the exit code.

    Parameters
    ----------
    name : str
        ``stepnc`` or ``optimise``, an alias of ``stepnc optimise``.
    arguments : sequence of str, optional
        Default: those of this process.
    """
    top = _commands()[0] if name == "stepnc" else _optimise_parser()
    words = list(sys.argv[1:] if arguments is None else arguments)
    if words and words[0] == "optimize" and name == "stepnc":
        words[0] = "optimise"
    options = top.parse_args(words)
    if getattr(options, "print_completion", None):
        return partial(_print_completion, options.print_completion)
    if "run" not in options:
        return partial(_print_help, top)
    return partial(_run, options)


def _optimise_parser() -> CommandParser:
    return verb_parser(verbs()["optimise"], partial(CommandParser, prog="optimise"))


def _print_completion(shell: str) -> int:
    import shtab

    from service.terminal import write_out

    write_out(shtab.complete(parser(), shell=shell))
    return OK


def _print_help(top: argparse.ArgumentParser) -> int:
    top.print_help()
    return USAGE


def _add_check(commands: Commands) -> None:
    """Add the command ``stepnc check``."""
    parser = commands.add_parser(
        "check",
        help="show the contents of a program or of NC code and its errors; exit 3 if it is "
        "unusable",
    )
    parser.fill = _check_options


def _check_options(parser: argparse.ArgumentParser) -> None:
    add_program(parser)
    parser.add_argument(
        "--control",
        default="",
        metavar="NAME",
        help="control of NC code: linuxcnc, fanuc, haas, sinumerik or heidenhain; default: "
        "guessed from the code",
    )
    add_most_repeats(parser)
    add_json(parser)
    parser.set_defaults(run=_check)


def _add_convert(commands: Commands) -> None:
    """Add the command ``stepnc convert``."""
    parser = commands.add_parser(
        "convert",
        help="convert a program to AP238 or ISO 14649, or its records to the other profile",
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="a STEP-NC program (Part 21)")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "--to",
        metavar="STANDARD",
        help="write the program by another standard: ap238 or iso14649",
    )
    what.add_argument(
        "--profile", help="write the optimisation records in profile optimisation or standard"
    )
    parser.add_argument("-o", "--output", type=output_path, required=True, metavar="FILE")
    parser.set_defaults(run=_convert)


def _run(options: argparse.Namespace) -> int:
    """Run a command and turn the project's errors into exit codes."""
    from service.cli.places import require_own_places
    from service.extras import missing_extras_named
    from service.terminal import OutputFault, drop_out, prepare, tell
    from stepnc_model.errors import StepNcError

    prepare()
    code = OK
    try:
        with missing_extras_named(getattr(options, "command", "optimise")):
            require_own_places(options)
            code = options.run(options)
        sys.stdout.flush()
    except StepNcError as error:
        tell(f"error: {error}{_alternative(error, options)}")
        code = _exit_code(error)
    except OutputFault as fault:
        # Buffered output has no reader any more; a reader that left (``| head``) is fine.
        drop_out()
        if not fault.is_reader_gone:
            tell(f"error: stdout: {fault.strerror}")
            code = BAD_INPUT
    except OSError as error:
        tell(f"error: {_named(error)}")
        code = BAD_INPUT
    return code


def _named(error: OSError) -> str:
    """What the system refused, with the file that it names."""
    reason = error.strerror or str(error) or type(error).__name__
    return f"{error.filename}: {reason}" if error.filename else reason


def _alternative(error: Exception, options: argparse.Namespace) -> str:
    """Option that helps where one instance is at fault and no other option is named."""
    from stepnc_model.errors import SchemaError

    is_local = isinstance(error, SchemaError) and bool(error.entity)
    can_keep_going = getattr(options, "keep_going", None) is False
    if not is_local or not can_keep_going or " --" in str(error):
        return ""
    return "; --keep-going leaves out what depends on it"


def _exit_code(error: Exception) -> int:
    """Return 4 for conflicting limits, 2 for what is missing, 3 for all errors of the input."""
    from optimiser.errors import OptimisationError
    from service.errors import MissingArgument

    if isinstance(error, MissingArgument):
        return USAGE
    return INFEASIBLE if isinstance(error, OptimisationError) else BAD_INPUT


def _check(options: argparse.Namespace) -> int:
    """Run the command ``stepnc check``."""
    from service.code_contents import is_code

    return (
        _check_code(options)
        if options.control or is_code(options.file)
        else _check_program(options)
    )


def _check_code(options: argparse.Namespace) -> int:
    """Check NC code."""
    from service.code_contents import check_code
    from service.requests.given import ProgramRequest
    from service.terminal import write_out
    from stepnc_model.errors import StepNcError

    if program_request(options) != ProgramRequest():
        raise StepNcError(
            "--units, --stock, --set, --teeth and --feed are for STEP-NC programs"
        )
    contents = check_code(
        options.file, control=options.control, most_repeats=options.most_repeats
    )
    if options.json:
        from service.code_contents_output import code_json

        write_out(code_json(contents))
    else:
        from service.code_contents_output import print_code

        print_code(contents)
    return OK


def _check_program(options: argparse.Namespace) -> int:
    """Check a STEP-NC program."""
    from service.contents import check
    from service.paths.remarks import tell_remarks
    from service.terminal import tell, write_out

    contents = check(options.file, program_request(options), tell=tell)
    tell_remarks(contents.remarks, tell)
    if options.json:
        from service.contents_output import contents_json

        write_out(contents_json(contents))
    else:
        from service.contents_output import print_contents

        print_contents(contents)
    return OK if contents.is_of_use else BAD_INPUT


def _convert(options: argparse.Namespace) -> int:
    """Run the command ``stepnc convert``."""
    from service.conversion import Standard, convert_to
    from service.requests.fields import member_of
    from service.terminal import tell
    from stepnc_model.file_profile import FileProfile

    if options.to is not None:
        standard = member_of(Standard, options.to, "standard")
        for finding in convert_to(options.file, standard=standard, output=options.output):
            tell(str(finding))
        tell(f"{options.output}: written by standard '{standard.value}'")
        return OK

    profile = member_of(FileProfile, options.profile, "profile")
    from service.verbs.optimise.program import convert

    convert(options.file, profile=profile, output=options.output)
    tell(f"{options.output}: records converted to profile '{profile.value}'")
    return OK


def _show_library(options: argparse.Namespace) -> int:
    """Run the commands ``stepnc machines`` and ``stepnc materials``."""
    from service import library_output
    from service.chosen import library_entries, library_entry
    from service.terminal import write_out

    kind, name = options.command, options.name
    if name:
        entry = library_entry(kind, name)
        if options.json:
            write_out(library_output.entry_json(entry))
        else:
            library_output.print_entry(entry)
        return OK
    entries = library_entries(kind)
    write_out(
        library_output.entries_json(entries)
    ) if options.json else library_output.print_entries(kind, entries)
    return OK
