"""Table of programs and commands: what works, with which options, and why the rest does not.

``python -m benchmarks.corpus [FOLDER ...]`` prints two tables in Markdown about the programs
of the folders (default: the public programs beside the project, and ten AP238 programs of tool
paths alone that are written for it). The first is the way from ``check`` to advice, NC code and
simulation, with what each check calls missing (:mod:`benchmarks.end_to_end`). For the second
each command runs on each public program. Where it refuses one, it runs again with the option
that its refusal names (units, a material, a spindle speed, a feed), then with the one that
leaves workingsteps out; NC code, simulation and control are tried on the optimised program too.
Refusals are printed as the commands print them.
"""

import argparse
import contextlib
import io
import re
import tempfile
import textwrap
from dataclasses import dataclass, replace
from pathlib import Path

from benchmarks.end_to_end import filled, ways
from benchmarks.end_to_end import table as way_table
from service.cli.main import main as stepnc
from service.errors import BAD_INPUT, OK
from service.files import read_bytes
from stepnc_model.ap238.view import is_aim
from stepnc_model.errors import StepNcError
from stepnc_model.part21.reader import Part21File
from tests.stepnc_model.ap238.writer_samples import write_samples

CORPUS = Path(__file__).parents[2] / "shared" / "corpus"
FOLDERS = (CORPUS / "iso14649", CORPUS / "ap238")

SUFFIXES = {".238", ".p21", ".stp", ".step", ".stpnc"}

Options = tuple[str, ...]

MATERIAL: Options = ("--material", "c45")
KEEP: Options = ("--keep-going",)
FEED: Options = ("--feed", "240")

SPINDLE = "-16.", "-960."
"""Spindle speed that is given where a refusal asks for one, in rev/s and in rpm."""

MOST_ATTEMPTS = 8
"""Greatest number of runs of one command on one file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """Command of ``stepnc``, and the options that may help it, the mildest first."""

    name: str
    options: Options = ()
    output: str = ""
    """Suffix of the file that it writes; empty if it writes none."""
    helps: tuple[Options, ...] = ()


HELPS = (FEED, KEEP)
OPTIMISE = Command(name="optimise", output=".stpnc", helps=HELPS)
BEFORE = (Command(name="check"), Command(name="toolpath", helps=(KEEP,)))
AFTER = (
    Command(name="post", options=("--control", "linuxcnc"), output=".ngc", helps=HELPS),
    Command(name="simulate", output=".csv", helps=HELPS),
    Command(name="control", output=".csv", helps=HELPS),
)
"""Commands that are tried on the optimised program too."""

ORDER = ("check", "toolpath", "post", "simulate", "optimise", "control", "convert")


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One run of a command."""

    code: int
    error: str = ""
    """Reason why it did not do all that was asked; empty if it did."""
    is_made: bool = False
    """Whether it made what it is for: a file, or else an answer."""
    left: int = 0
    """Number of workingsteps that it left out."""

    @property
    def is_of_use(self) -> bool:
        """True if something was made: of the whole program, or without some workingsteps."""
        return self.is_made and (self.code != BAD_INPUT or self.left > 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """Outcome of a command on a program."""

    works: bool
    options: Options = ()
    """Options that it needs beyond its usual ones."""
    left: int = 0
    code: int = OK
    error: str = ""
    """First refusal, and the last one where it is another."""
    is_after: bool = False
    """Whether it works on the optimised program only."""


def main(arguments: list[str] | None = None) -> None:
    """Print the table of the programs of some folders, and the refusals below it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs="*", type=Path, metavar="FOLDER")
    folders = parser.parse_args(arguments).folders
    with tempfile.TemporaryDirectory() as written:
        if not folders:
            write_samples(Path(written))
        files = [file for each in folders or FOLDERS for file in programs(each)]
        samples = programs(Path(written))
        if not files and not samples:
            print("no program in these folders: nothing to print")
            return
        print(way_table(list(ways([*files, *samples]))))
        if files:
            print()
            print(table({file.name: entries(file) for file in files}))


def programs(folder: Path) -> list[Path]:
    """Programs of a folder, by name."""
    found = folder.iterdir() if folder.is_dir() else ()
    return sorted(file for file in found if file.suffix.lower() in SUFFIXES)


def entries(file: Path) -> dict[str, Entry]:
    """Outcomes of the commands on a program, in the order of the table."""
    with tempfile.TemporaryDirectory() as folder:
        advised = Path(folder) / f"advised{OPTIMISE.output}"
        found = {each.name: entry(file, each) for each in (*BEFORE, _conversion(file))}
        found[OPTIMISE.name] = entry(file, OPTIMISE, output=advised)
        for command in AFTER:
            plain = entry(file, command)
            if (not plain.works or plain.left) and advised.is_file():
                after = entry(advised, command)
                if after.works and (not plain.works or after.left < plain.left):
                    plain = replace(after, is_after=True, error=plain.error)
            found[command.name] = plain
    return {name: found[name] for name in ORDER}


def entry(file: Path, command: Command, *, output: Path | None = None) -> Entry:
    """Run a command on a program, with more and more options as long as it refuses.

    Parameters
    ----------
    file : Path
    command : Command
    output : Path, optional
        Place for the file that it writes; a folder that is removed if not given.
    """
    options: Options = ()
    first = last = attempt(file, command, options, output=output)
    for _ in range(MOST_ATTEMPTS):
        more = None if last.is_of_use else _next(command, last.error, options)
        if more is None:
            break
        options += more
        last = attempt(file, command, options, output=output)
    if last.is_of_use:
        error = first.error or last.error
        code = last.code if last.code != BAD_INPUT else OK
        return Entry(works=True, options=options, left=last.left, code=code, error=error)
    if last.error in first.error:
        return Entry(works=False, error=first.error)
    return Entry(works=False, error=f"{first.error}; with `{_words(options)}`: {last.error}")


def attempt(
    file: Path, command: Command, more: Options, *, output: Path | None = None
) -> Attempt:
    """Run a command once."""
    out, told, code = io.StringIO(), io.StringIO(), OK
    with tempfile.TemporaryDirectory() as folder:
        place = output or Path(folder) / f"out{command.output}"
        written = ("-o", str(place)) if command.output else ()
        words = [command.name, str(file), *command.options, *more, *written]
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(told):
            try:
                stepnc(words)
            except SystemExit as ended:
                code = int(ended.code or OK)
        is_made = place.is_file() if command.output else code == OK or bool(out.getvalue())
    is_done = code == OK and is_made
    return Attempt(
        code=code,
        error="" if is_done else _reason(out.getvalue(), told.getvalue(), code),
        is_made=is_made,
        left=len(re.findall(r"^left (?:out|as programmed): ", told.getvalue(), re.MULTILINE)),
    )


def _reason(out: str, told: str, code: int) -> str:
    """Reason for a refusal, in the words of the command."""
    for text, pattern in (
        (told, r"^error: (.*)"),
        (told, r"^(infeasible, .*)"),
        (told, r"^left as programmed: (.*)"),
        (out, r"^  .*(untouched: .*)"),
        (out, r"^error: (.*)"),
        (out, r"^  advice: no: (.*)"),
    ):
        if found := re.search(pattern, text, re.MULTILINE):
            return found[1]
    return f"exit code {code}"


def _next(command: Command, error: str, options: Options) -> Options | None:
    """Option to try next: one that a refusal names, or the next that helps a command."""
    named = re.search(r"--units ([a-z-]+)", error)
    if named and "--units" not in options:
        return "--units", named[1]
    given = re.search(r"give this one so, as --feed (\S+)", error)
    if given and given[1] not in options:
        return "--feed", given[1]
    asked = re.search(r'--set "(#\d+\.spindle)=VALUE"', error)
    if asked:
        is_rpm = any(word.startswith("rpm-") for word in options)
        value = f"{asked[1]}={SPINDLE[is_rpm]}"
        return ("--set", value) if value not in options else None
    if "complete and run:" in error and not options:
        return _completed(error)
    if "--material" in error and "--material" not in options:
        return MATERIAL
    return next(
        (
            each
            for each in command.helps
            if each[0] not in options and (each is KEEP or each[0] in error)
        ),
        None,
    )


def _completed(error: str) -> Options | None:
    """Options of the command that a refusal names, with a value for each name in capitals.

    Tools are those of the first table only: None where a tool table is missing.
    """
    return None if "TABLE" in error else tuple(filled(error))


def table(rows: dict[str, dict[str, Entry]]) -> str:
    """Markdown of all entries: a row for each program, and below it the refusals by number."""
    heads = list(next(iter(rows.values())))
    lines = [f"| program | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    notes: dict[str, int] = {}
    for name, found in rows.items():
        cells = (_cell(name, each, notes) for each in found.values())
        lines.append(f"| {name} | {' | '.join(cells)} |")
    lines.append("")
    for note, number in notes.items():
        lines += textwrap.wrap(
            f"{number}. {note}",
            width=110,
            subsequent_indent="   ",
            break_long_words=False,
            break_on_hyphens=False,
        )
    return "\n".join(lines)


def _conversion(file: Path) -> Command:
    """Conversion of a program to the other standard."""
    try:
        is_ap238 = is_aim(Part21File.from_bytes(read_bytes(file)))
    except StepNcError:
        is_ap238 = False
    standard = "iso14649" if is_ap238 else "ap238"
    return Command(name="convert", options=("--to", standard), output=".stpnc")


def _cell(name: str, found: Entry, notes: dict[str, int]) -> str:
    """Text of one entry, with the number of its refusal."""
    text = "yes" if found.works else "no"
    if found.is_after:
        text = "after `optimise`"
    if found.options:
        text += f" with `{_words(found.options)}`"
    if found.code != OK:
        text += f", exit code {found.code}"
    if found.left:
        text += f", {found.left} left out"
    if not found.error:
        return text
    number = notes.setdefault(f"{name}: {found.error}", len(notes) + 1)
    return f"{text} ({number})"


def _words(options: Options) -> str:
    """Options as they are typed."""
    return " ".join(f'"{word}"' if "#" in word else word for word in options)


if __name__ == "__main__":
    main()
