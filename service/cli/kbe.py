"""Commands of the knowledge base: ``stepnc kbe …``."""

import argparse
from collections.abc import Callable
from pathlib import Path

from service.cli.kbe_options import (
    add_filters,
    add_place,
    count,
    share,
)
from service.cli.kbe_verbs import (
    SUFFIXES,
    accept_command,
    add_command,
    back_up_command,
    check_command,
    export_command,
    list_corrections_command,
    list_outcomes_command,
    read_command,
    restore_command,
    review_command,
    show_command,
    table_command,
    withdraw_command,
    write_command,
)
from service.cli.options import Commands, add_json, text
from service.requests.fields import output_path

USAGE = 2

EXAMPLES = """examples:
  stepnc kbe list --machine vmc15 --since 2026-03-01
  stepnc kbe table --only violated -o table.html
  stepnc kbe review
  stepnc kbe accept 3 --by "A. Smith"
  stepnc kbe export outcomes --format parquet -o outcomes.parquet

The knowledge base holds outcomes of runs and corrections for plans. It is named by --kb, else
by $STEPNC_KB, else it is ~/.local/share/stepnc/knowledge.db."""

ONLY = ("all", "violated", "wasted", "with-remarks", "with-trend", "factor-pending")
SORT = ("name", "grade", "runs", "latest", "force", "time", "feed", "roughness", "time-to-win")
"""Option values from :mod:`kbe.evaluation`, with hyphens so that they need no quotes."""

Run = Callable[[argparse.Namespace], int]


def add_knowledge_commands(commands: Commands) -> None:
    """Add the commands of the knowledge base to ``stepnc``."""
    parser = commands.add_parser(
        "kbe",
        help="the knowledge base: outcomes of runs, their evaluation, corrections",
        description=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=lambda _: _show_help(parser))
    verbs = parser.add_subparsers(dest="verb", metavar="VERB")
    _add_list(verbs)
    _add_show(verbs)
    _add_table(verbs)
    _add_review(verbs)
    _add_decisions(verbs)
    _add_export(verbs)
    _add_write(verbs)
    _add_read(verbs)
    _add_add(verbs)
    _add_copies(verbs)


def _show_help(parser: argparse.ArgumentParser) -> int:
    parser.print_help()
    return USAGE


def _verb(verbs: Commands, name: str, run: Run, what: str) -> argparse.ArgumentParser:
    """Add a verb with its option for the knowledge base."""
    parser = verbs.add_parser(name, help=what, description=what)
    add_place(parser)
    parser.set_defaults(run=run)
    return parser


def _add_list(verbs: Commands) -> None:
    parser = _verb(verbs, "list", list_outcomes_command, "list outcomes, newest first")
    parser.add_argument(
        "--limit", type=count, default=50, metavar="N", help="most rows to show (default 50)"
    )
    add_filters(parser)
    add_json(parser)


def _add_show(verbs: Commands) -> None:
    what = "show one run in full, by its id or the start of it; or a correction, by its number"
    parser = _verb(verbs, "show", show_command, what)
    parser.add_argument("id", type=text, metavar="RUN|ID", help="see `list` and `corrections`")
    add_json(parser)


def _add_table(verbs: Commands) -> None:
    what = "evaluate outcomes: planned, measured, deviations, grades, recommended actions"
    parser = _verb(verbs, "table", table_command, what)
    _add_table_options(parser)
    form = parser.add_mutually_exclusive_group()
    form.add_argument(
        "--format",
        choices=tuple(SUFFIXES.values()),
        help="default: by the file extension; on stdout text",
    )
    form.add_argument(
        "--json", action="store_const", const="json", dest="format", help="--format json"
    )
    parser.add_argument(
        "-o", "--output", type=output_path, metavar="FILE", help="output file (default: stdout)"
    )


def _add_table_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of an evaluation table."""
    add = parser.add_argument
    add(
        "--by",
        choices=("feature", "kind"),
        default="feature",
        help="a row for each feature of each program (default), or for each kind of feature",
    )
    add("--only", choices=ONLY, default="all", help="keep only rows with such a result")
    add("--sort", choices=SORT, default="name", help="order of the rows (default: name)")
    add(
        "--summary",
        action="store_true",
        help="only counts, means and spreads by machine, material, tool and kind of feature: "
        "a million outcomes in about a second",
    )
    add_filters(parser)


def _add_review(verbs: Commands) -> None:
    what = "learn factors on k_c from outcomes and propose new or changed corrections"
    parser = _verb(verbs, "review", review_command, what)
    add = parser.add_argument
    add(
        "--auto-accept",
        action="store_true",
        help="accept proposals within the three bounds below; others wait for a person",
    )
    add("--least-confidence", type=share, default=0.8, metavar="P", help="0 to 1 (default 0.8)")
    add(
        "--fewest-outcomes",
        type=count,
        default=3,
        metavar="N",
        help="outcomes that support a proposal (default 3)",
    )
    add(
        "--greatest-change",
        type=share,
        default=0.25,
        metavar="SHARE",
        help="change of the accepted factor, 0.25 or 25%% (default)",
    )
    _add_by(parser)
    add_filters(parser)
    add_json(parser)


def _add_decisions(verbs: Commands) -> None:
    accept = _verb(
        verbs, "accept", accept_command, "accept corrections, which the next plans apply"
    )
    withdraw = _verb(
        verbs,
        "withdraw",
        withdraw_command,
        "withdraw accepted corrections, or reject proposals",
    )
    for parser in (accept, withdraw):
        parser.add_argument(
            "ids", type=count, nargs="+", metavar="ID", help="see `corrections`"
        )
        _add_by(parser)
        add_json(parser)
    add_json(
        _verb(
            verbs,
            "corrections",
            list_corrections_command,
            "list corrections and their status",
        )
    )


def _add_by(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--by", type=text, default="", metavar="NAME", help="your name (default: the login)"
    )


def _add_export(verbs: Commands) -> None:
    parser = _verb(
        verbs,
        "export",
        export_command,
        "write outcomes, corrections or the table to a file; JSON and Parquet keep every "
        "value, CSV puts an apostrophe before text that a spreadsheet would calculate",
    )
    add = parser.add_argument
    add("what", choices=("outcomes", "corrections", "table"))
    add("--format", choices=tuple(SUFFIXES.values()), help="default: by the file extension")
    add("-o", "--output", type=output_path, required=True, metavar="FILE")
    _add_table_options(parser)


def _add_write(verbs: Commands) -> None:
    what = (
        "write a run's outcomes, and the accepted corrections for its tools, into the program "
        "as STEP-NC entities"
    )
    parser = _verb(verbs, "write", write_command, what)
    add = parser.add_argument
    add("file", type=Path, metavar="FILE", help="the program that was run")
    add("--run", type=text, default="", dest="of_run", metavar="ID", help="default: newest run")
    add("-o", "--output", type=output_path, metavar="FILE", help="default: FILE.recorded.stpnc")


def _add_read(verbs: Commands) -> None:
    what = "list the outcomes and corrections stored in a program file"
    parser = verbs.add_parser("read", help=what, description=what)
    parser.set_defaults(run=read_command)
    parser.add_argument("file", type=Path, metavar="FILE", help="as written by `write`")
    add_json(parser)


def _add_add(verbs: Commands) -> None:
    what = "add outcomes of real runs from a JSON file, as `export outcomes` writes it"
    parser = _verb(verbs, "add", add_command, what)
    parser.add_argument("file", type=Path, metavar="FILE.json")


def _add_copies(verbs: Commands) -> None:
    back_up = _verb(verbs, "backup", back_up_command, "copy the knowledge base to a new file")
    restore = _verb(
        verbs, "restore", restore_command, "fill an empty knowledge base from a backup"
    )
    for parser, kind in ((back_up, output_path), (restore, Path)):
        parser.add_argument("file", type=kind, metavar="FILE")
        add_json(parser)
    add_json(_verb(verbs, "check", check_command, "check the integrity of all stored data"))
