"""The page of the command line, from the parsers themselves."""

import argparse
from collections.abc import Iterator

from docs.hooks.markdown import block, code, page, table
from service import errors as exit_codes
from service.cli.commands import parser
from service.cli.interrupts import INTERRUPTED

EXIT_CODES = {
    exit_codes.OK: "done",
    exit_codes.USAGE: "the words of the command line make no command: unknown option, "
    "word missing",
    exit_codes.BAD_INPUT: "a file, a name or a number cannot be used; nothing was written",
    exit_codes.INFEASIBLE: "no feed keeps all limits, or the solver found none",
    exit_codes.LIMIT_EXCEEDED: "a run passed a bound of power or force, or was stopped",
    exit_codes.NOTHING_ADVISED: "`optimise` found nothing to advise, and wrote no program",
    INTERRUPTED: "interrupted by Ctrl-C or SIGTERM",
}

VARIABLES = {
    "STEPNC_KB": "knowledge base where no `--kb` is given: a file or `postgresql://…`",
    "STEPNC_DATA": "folder of the service's data where no `--data` is given",
    "STEPNC_DATABASE": "database of the service where no `--database` is given: `postgresql://…`",
    "XDG_DATA_HOME": "where the usual knowledge base lies, `stepnc/knowledge.db` below it; "
    "without it `~/.local/share`",
    "XDG_CACHE_HOME": "where compiled kernels lie that have no place beside their modules, "
    "`stepnc-optimiser` below it; without it `~/.cache`",
    "NO_COLOR": "set to anything: no colours on a terminal",
    "COLUMNS": "letters in a line, for tables that fold",
}
"""that the command line reads; other programs' habits (``HOME``, ``LOGNAME``) are theirs"""

INTRODUCTION = """This page is made from the parsers when the site is built: it says what
`--help`, which every command takes, prints. `optimise` is a shorter name for `stepnc optimise`.

Tables and JSON go to standard output; messages and progress go to standard error, so
`stepnc … --json > plan.json` holds JSON only. Numbers on the command line carry their unit in
the name of the option or in its help."""

USAGE_WIDTH = 104
"""letters in a line of usage"""


def command_page() -> str:
    """The whole page."""
    top = parser()
    parts = [INTRODUCTION, "## Commands", _overview(top), *_sections(top)]
    parts += ["## Exit codes", _exit_codes(), "## Environment", _variables()]
    return page("Command line", parts)


def commands(top: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """Every parser below this one that runs something, in the order of ``--help``."""
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield below
                yield from commands(below)


def listed(action: argparse.Action) -> str:
    """An option or a word, as the user types it."""
    if not action.option_strings:
        return _value(action)
    names = ", ".join(action.option_strings)
    return names if action.nargs == 0 else f"{names} {_value(action)}"


def _value(action: argparse.Action) -> str:
    name = action.metavar
    if isinstance(name, tuple):
        name = " ".join(name)
    if name is None:
        name = action.dest.upper()
    match action.nargs:
        case "?":
            return f"[{name}]"
        case "+":
            return f"{name} …"
        case "*":
            return f"[{name} …]"
    return name


def _overview(top: argparse.ArgumentParser) -> str:
    return table(
        ("command", "what it does"),
        ((f"[`{each.prog}`](#{_anchor(each)})", _what(top, each)) for each in commands(top)),
    )


def _anchor(command: argparse.ArgumentParser) -> str:
    return command.prog.replace(" ", "-")


def _what(top: argparse.ArgumentParser, command: argparse.ArgumentParser) -> str:
    """The line that ``--help`` of the command above it shows."""
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for choice, (name, below) in zip(
                action._choices_actions, action.choices.items(), strict=True
            ):
                if below is command:
                    return choice.help or name
                found = _what(below, command)
                if found:
                    return found
    return ""


def _sections(top: argparse.ArgumentParser) -> Iterator[str]:
    for each in (top, *commands(top)):
        yield f"## {each.prog} {{#{_anchor(each)}}}"
        what = _what(top, each)
        if what:
            yield what[0].upper() + what[1:] + "."
        yield block(_usage(each))
        if each.description and each.description != what:
            yield block(each.description)
        rows = [(code(listed(action)), _help(each, action)) for action in _told(each)]
        if rows:
            yield table(("option", "meaning"), rows)


def _usage(command: argparse.ArgumentParser) -> str:
    """The line of usage, of one width whatever the terminal."""
    formatter = argparse.HelpFormatter(command.prog, width=USAGE_WIDTH)
    groups = command._mutually_exclusive_groups
    formatter.add_usage(command.usage, command._actions, groups, prefix="")
    return formatter.format_help()


def _told(command: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Words and options; commands below it have sections of their own."""
    for action in command._actions:
        if not isinstance(action, argparse._SubParsersAction | argparse._HelpAction):
            yield action


def _help(command: argparse.ArgumentParser, action: argparse.Action) -> str:
    text = (action.help or "") % {**vars(action), "prog": command.prog}
    notes = [text] if text else []
    if action.choices is not None:
        notes.append("one of " + ", ".join(code(str(each)) for each in action.choices))
    if action.required and action.option_strings:
        notes.append("required")
    return "; ".join(notes)


def _exit_codes() -> str:
    return table(
        ("code", "meaning"), ((str(number), text) for number, text in EXIT_CODES.items())
    )


def _variables() -> str:
    return table(
        ("variable", "meaning"), ((code(name), text) for name, text in VARIABLES.items())
    )
