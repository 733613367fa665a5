"""Commands of ``optimise`` and ``stepnc``: the verbs, their errors and exit codes.

Data goes to stdout, messages and progress to stderr. Slow imports stay inside the commands, so
that ``--help`` answers at once.

Options, output and exit code are made from the declarations of a verb. No output takes the
place of another file of the command.
"""

import argparse
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.errors import BAD_INPUT, INFEASIBLE, OK, USAGE
from service.requests.fields import Request, output_path
from service.verbs.call import Verb, verbs
from service.verbs.result import Result, ServedResult

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction["CommandParser"]
else:
    Commands = object


_EMPTY = re.compile(r"--[a-z-]+=")
"""Option that is typed without its value."""


class CommandParser(argparse.ArgumentParser):
    """Parser of one command; its options are added on first use, to keep start-up fast."""

    fill: Callable[["CommandParser"], None] | None = None
    """Function that adds the options."""

    def __init__(self, *args: Any, **words: Any) -> None:
        super().__init__(*args, **words)
        # Coordinates may be negative: "-3,-3,-40,153,93,2" is not an option.
        self._negative_number_matcher = re.compile(r"-[.\d]")

    def complete(self) -> None:
        """Add the options, unless they were added before."""
        fill, self.fill = self.fill, None
        if fill is not None:
            fill(self)

    def parse_known_args(self, *args: Any, **words: Any) -> Any:
        """Parse known arguments after adding the options; note which of them are outputs."""
        self.complete()
        if any(word == "" or _EMPTY.fullmatch(word) for word in args[0] or ()):
            self.error("an option or name is empty: leave it out, or give its value")
        namespace, rest = super().parse_known_args(*args, **words)
        if names := output_names(self):
            namespace.output_names = names
        return namespace, rest


def output_names(parser: argparse.ArgumentParser) -> tuple[str, ...]:
    """Names of the arguments of a command that are outputs."""
    return tuple(each.dest for each in parser._actions if each.type is output_path)


def add_verbs(commands: Commands, verbs: Iterable[Verb]) -> None:
    """Add verbs to the commands, those of a group below the command of its name."""
    for group, members in groupby(verbs, key=lambda verb: verb.group):
        below = list(members)
        if below[0].folder == group:
            add_verb(commands, below[0])
        else:
            _add(commands, Verb(folder=group)).fill = partial(_fill_group, below)


def add_verb(commands: Commands, verb: Verb) -> None:
    """Add a verb to the commands."""
    _add(commands, verb).fill = partial(_fill, verb)


def verb_parser(verb: Verb, prog: str) -> CommandParser:
    """Make a parser of its own, with the options that a verb's request and files declare."""
    parser = _parser(verb, partial(CommandParser, prog=prog))
    parser.fill = partial(_fill, verb)
    return parser


def print_help(parser: argparse.ArgumentParser) -> int:
    """Print the help of a command that only has commands below it; return the exit code."""
    parser.print_help()
    return USAGE


def _add(commands: Commands, verb: Verb) -> CommandParser:
    line = verb.line
    shown = (line[:1].lower() + line[1:]).replace("%", "%%")
    name = verb.name.rpartition(" ")[2]
    return _parser(verb, partial(commands.add_parser, name, help=shown))


def _parser(verb: Verb, made: Callable[..., CommandParser]) -> CommandParser:
    if verb.details:
        raw = argparse.RawDescriptionHelpFormatter
        return made(description=verb.details, formatter_class=raw)
    return made(description=verb.line.replace("%", "%%"))


def _fill_group(members: Sequence[Verb], parser: argparse.ArgumentParser) -> None:
    parser.set_defaults(work=lambda _: print_help(parser))
    below = parser.add_subparsers(dest="verb", metavar="VERB", parser_class=CommandParser)
    for verb in members:
        add_verb(below, verb)


def _fill(verb: Verb, parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options

    add_options(parser, verb.files)
    add_options(parser, verb.request, usual=verb.usual)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.set_defaults(work=partial(_run_verb, verb))


def _run_verb(verb: Verb, options: argparse.Namespace) -> int:
    """Run a verb with its parsed options; print and write what it returns."""
    from service.requests.fields import from_options, require_bounds
    from service.requests.output import OutputFiles
    from service.terminal import tell
    from service.verbs.call import ran
    from stepnc_model.errors import StepNcError

    request = from_options(verb.request, options, **verb.usual)
    require_bounds(request)
    files = from_options(verb.files, options)
    require_bounds(files)
    if options.json and isinstance(files, OutputFiles) and files.is_printed:
        raise StepNcError("give --format or --json, not both")
    typed = {name: value for name, value in vars(options).items() if value or value == 0}
    given = {name: value for name, value in typed.items() if value is not False}
    result = ran(verb, request, files, named=given, tell=tell)
    if isinstance(result, ServedResult):
        if options.json:
            tell("--json has no effect: what is served says nothing at its end")
    else:
        _print(result, files, is_json=options.json)
    return result.exit_code


def _print(result: Result, files: Request, *, is_json: bool) -> None:
    """Print a result as JSON, or in the format that its files name where they name no file."""
    from service.outputs.output_format import OutputFormat
    from service.requests.output import OutputFiles
    from service.terminal import write_out

    form = OutputFormat.TEXT
    if isinstance(files, OutputFiles):
        if files.output is not None and not is_json:
            return
        form = files.format or form
    if is_json:
        form = OutputFormat.JSON
    if form is OutputFormat.TEXT:
        print_result(result)
    else:
        write_out(result.printed(form))


def print_result(result: Result) -> None:
    """Print a result as text, as wide as the terminal."""
    from service.rendering.text import print_line, screen_width

    for text, colour in result.view().lines(width=screen_width()):
        print_line(text, colour)


def require_own_places(options: argparse.Namespace) -> None:
    """Refuse a command of which two outputs, or an output and an input, are the same file.

    Outputs are the arguments of type :func:`service.cli.commands.output_path`. Inputs are all
    others that name a file: a machine or a stock is typed as text, and may be a file.

    Raises
    ------
    WriteError
        Before anything is read or written.
    """
    from service.files import require_distinct

    names = getattr(options, "output_names", ())
    # A command with --in-place names it where the output is its file.
    own = {"output", "file"} if hasattr(options, "in_place") else set()
    outputs = {name: getattr(options, name) for name in names}
    inputs = {
        name: list(_files(value))
        for name, value in vars(options).items()
        if name not in outputs and name != "output_names"
    }
    require_distinct(outputs.values())
    for name, place in outputs.items():
        read = (
            each for other, files in inputs.items() if {name, other} != own for each in files
        )
        require_distinct([place], apart_from=read)


def _files(value: object) -> Iterator[Path]:
    """Files that the value of an argument names."""
    if isinstance(value, Path):
        yield value
    elif isinstance(value, (list, tuple)):
        for each in value:
            yield from _files(each)
    elif isinstance(value, str):
        # The solid of a STEP file follows its name: part.step#SOLID.
        for name in {value, value.partition("#")[0]}:
            if name and _is_file(name):
                yield Path(name)


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # a long text, or one with a null character
        return False


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
    _complete(commands)
    return top


def _complete(commands: Commands) -> None:
    for each in commands.choices.values():
        each.complete()
        for action in each._actions:
            if isinstance(action, argparse._SubParsersAction):
                _complete(action)


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
    add_verbs(commands, [each for name, each in verbs().items() if name != "optimise"])
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
    if "work" not in options:
        return partial(print_help, top)
    return partial(_run, options)


def _optimise_parser() -> CommandParser:
    return verb_parser(verbs()["optimise"], "optimise")


def _print_completion(shell: str) -> int:
    import shtab

    from service.terminal import write_out

    write_out(shtab.complete(parser(), shell=shell))
    return OK


def _run(options: argparse.Namespace) -> int:
    """Run a command and turn the project's errors into exit codes."""
    from service.optional_packages import missing_extras_named
    from service.terminal import OutputFault, drop_out, prepare, tell
    from stepnc_model.errors import StepNcError

    prepare()
    code = OK
    try:
        with missing_extras_named(getattr(options, "command", "optimise")):
            require_own_places(options)
            code = options.work(options)
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
    """Message of an error of the operating system, with the file that it names."""
    reason = error.strerror or str(error) or type(error).__name__
    return f"{error.filename}: {reason}" if error.filename else reason


def _alternative(error: Exception, options: argparse.Namespace) -> str:
    """Option that helps where one instance is at fault and no other option is named."""
    from stepnc_model.errors import SchemaError

    # What an option itself names wrongly stays wrong, whatever else is left out.
    is_of_file = bool(getattr(error, "line", 0))
    is_local = isinstance(error, SchemaError) and bool(error.entity) and is_of_file
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
