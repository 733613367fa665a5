"""Commands of ``optimise`` and ``stepnc``, a thin layer above :mod:`service.usecases`.

Data goes to stdout, messages and progress to stderr. Slow imports stay inside the commands, so
that ``--help`` answers at once.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial

from service.cli.kbe import USAGE, add_knowledge_commands
from service.cli.options import (
    BAD_INPUT,
    INFEASIBLE,
    OK,
    CommandParser,
    Commands,
)
from service.cli.serve import add_service_commands
from service.cli.verbs import add_verb, verb_parser
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
    add_knowledge_commands(commands)
    for verb in verbs().values():
        if verb.name not in commands.choices:
            add_verb(commands, verb)
    add_service_commands(commands)
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
