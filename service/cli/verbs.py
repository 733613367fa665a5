"""Door of the command line to the verbs: options, output and exit code from declarations."""

import argparse
from functools import partial

from service.cli.options import Commands
from service.verbs.verb import Verb


def add_verb(commands: Commands, verb: Verb) -> None:
    """Add a verb with the options that its request and files declare."""
    first, _, rest = verb.about.strip().partition("\n\n")
    line = " ".join(first.split()).removesuffix(".")
    parser = commands.add_parser(
        verb.name.rpartition(" ")[2],
        help=(line[:1].lower() + line[1:]).replace("%", "%%"),
        description=rest.strip() or line,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.fill = partial(_fill, verb)


def _fill(verb: Verb, parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options

    add_options(parser, verb.files)
    add_options(parser, verb.request)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.set_defaults(run=partial(_run, verb))


def _run(verb: Verb, options: argparse.Namespace) -> int:
    """Run a verb with its parsed options; print and write what it returns."""
    from service.requests.fields import from_options, require_bounds
    from service.terminal import tell
    from service.verbs.call import ran

    request = from_options(verb.request, options)
    require_bounds(request)
    files = from_options(verb.files, options)
    result = ran(verb, request, files, tell=tell)
    if options.json:
        from service.rendering.records import dump
        from service.terminal import write_out

        write_out(dump(result.record()))
    else:
        from service.rendering.text import print_line, screen_width

        for text, colour in result.view().lines(width=screen_width()):
            print_line(text, colour)
    return result.exit_code
