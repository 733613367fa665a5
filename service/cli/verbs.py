"""Door of the command line to the verbs: options, output and exit code from declarations."""

import argparse
from collections.abc import Callable
from functools import partial

from service.cli.options import CommandParser, Commands
from service.verbs.result import Result, ServedResult
from service.verbs.verb import Verb


def add_verb(commands: Commands, verb: Verb) -> None:
    """Add a verb to the commands."""
    line = verb.line
    verb_parser(
        verb,
        partial(
            commands.add_parser,
            verb.name.rpartition(" ")[2],
            help=(line[:1].lower() + line[1:]).replace("%", "%%"),
        ),
    )


def verb_parser(verb: Verb, made: Callable[..., CommandParser]) -> CommandParser:
    """Make a parser with the options that a verb's request and files declare."""
    parser = made(
        description=verb.details or verb.line,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.fill = partial(_fill, verb)
    return parser


def _fill(verb: Verb, parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options

    add_options(parser, verb.files)
    add_options(parser, verb.request, usual=verb.usual)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.set_defaults(run=partial(_run, verb))


def _run(verb: Verb, options: argparse.Namespace) -> int:
    """Run a verb with its parsed options; print and write what it returns."""
    from service.requests.fields import from_options, require_bounds
    from service.terminal import tell
    from service.verbs.call import ran

    request = from_options(verb.request, options, **verb.usual)
    require_bounds(request)
    files = from_options(verb.files, options)
    typed = {name: value for name, value in vars(options).items() if value or value == 0}
    given = {name: value for name, value in typed.items() if value is not False}
    result = ran(verb, request, files, given=given, tell=tell)
    if isinstance(result, ServedResult):
        if options.json:
            tell("--json has no effect: what is served says nothing at its end")
    elif options.json:
        from service.rendering.records import dump
        from service.terminal import write_out

        write_out(dump(result.record()))
    else:
        print_result(result)
    return result.exit_code


def print_result(result: Result) -> None:
    """Print a result as text, as wide as the terminal."""
    from service.rendering.text import print_line, screen_width

    for text, colour in result.view().lines(width=screen_width()):
        print_line(text, colour)
