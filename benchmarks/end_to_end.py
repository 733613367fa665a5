"""Way of a program from ``check`` to advice, NC code and simulation, as a user goes it.

What a program lacks is given as its own check says: the command that it calls ready is taken,
and each name in capitals is filled in. The optimised program is then posted, simulated and
optimised again, which must change nothing.
"""

import contextlib
import io
import re
import shlex
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from pathlib import Path
from time import perf_counter

from service.cli.main import main as stepnc
from service.errors import OK

READY = re.compile(r"^ready: stepnc optimise (.*)$", re.MULTILINE)
TABLE_OF = re.compile(r"a table with tools? ([^;\n]*)")
MATERIAL, FEED, SIZE = "c45", "240", "16."
SPEED, SPEED_REV_S = "-960.", "-16."
BAR = "60,-100,1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Said:
    """Printed output of a command."""

    code: int
    out: str
    told: str

    @property
    def reason(self) -> str:
        """Reason of a refusal; empty if it did what it is for."""
        if self.code == OK:
            return ""
        found = re.search(r"^error: (.*)", self.told, re.MULTILINE)
        found = found or re.search(r"^  .*(untouched: .*)", self.out, re.MULTILINE)
        return found[1] if found else f"exit code {self.code}"


def run(*words: str | Path) -> Said:
    """Run a command of ``stepnc`` in this process."""
    out, told, code = io.StringIO(), io.StringIO(), OK
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(told):
        try:
            stepnc([str(word) for word in words])
        except SystemExit as ended:
            code = int(ended.code or OK)
    return Said(code=code, out=out.getvalue(), told=told.getvalue())


@dataclass(slots=True)
class Way:
    """Outcome of one program; made in the order of the steps."""

    name: str
    read_as: str = ""
    options: tuple[str, ...] = ()
    steps: dict[str, Said] = field(default_factory=dict)
    is_same_again: bool | None = None
    """Whether a second run gives the same bytes; None where there was no first one."""
    unchanged: float | None = None
    """Share of the bytes of the program that stay in the optimised one."""
    seconds: float = 0.0

    @property
    def is_whole(self) -> bool:
        """True if the program was advised, posted and simulated, and stays so."""
        names = ("optimise", "post", "simulate")
        return bool(self.is_same_again) and all(
            name in self.steps and self.steps[name].code == OK for name in names
        )


def way(file: Path, folder: Path) -> Way:
    """Go the way of one program, with its files in a folder."""
    begin = perf_counter()
    found = Way(name=file.name)
    checked = found.steps["check"] = run("check", file)
    found.read_as = _read_as(checked.out)
    beside = file.with_name("tools.csv")
    found.options = tuple(filled(checked.out, folder, beside if beside.is_file() else None))
    plain = _without(found.options, ("--tools", "--material", "--machine"))
    advised, again = folder / "advised.stpnc", folder / "again.stpnc"
    found.steps["optimise"] = run("optimise", file, *found.options, "-o", advised)
    if advised.is_file():
        found.unchanged = _kept(file.read_bytes(), advised.read_bytes())
        second = run("optimise", advised, *found.options, "-o", again)
        data = again.read_bytes() if again.is_file() else advised.read_bytes()
        found.is_same_again = data == advised.read_bytes() and second.code in (OK, 4, 5, 6)
    part = advised if advised.is_file() else file
    found.steps["post"] = run(
        "post", part, *plain, "--control", "linuxcnc", "-o", folder / "part.ngc"
    )
    found.steps["simulate"] = run("simulate", part, *found.options)
    found.seconds = perf_counter() - begin
    return found


def filled(text: str, folder: Path | None = None, tools: Path | None = None) -> Iterator[str]:
    """Options of the command that a check calls ready, with a value for each name.

    Parameters
    ----------
    text : str
        What ``check`` or a refusal printed.
    folder : Path, optional
        Folder for a tool table that is made with end mills of the names that are missing.
    tools : Path, optional
        Table of the tools, which counts before one that is made.
    """
    ready = READY.search(text) or re.search(r"complete and run: stepnc \w+ (.*)", text)
    if ready is None:
        return
    names = TABLE_OF.search(text[text.rindex("missing") :])
    table = tools
    if table is None and folder is not None:
        table = _table(folder, names[1] if names else "")
    units = re.search(r"the units of feeds and speeds \((\S+)", text)
    values = {
        "MATERIAL": MATERIAL,
        "FEED": FEED,
        "TABLE": str(table),
        "UNITS": units[1] if units else "auto",
    }
    speed = SPEED if "in rpm" in text else SPEED_REV_S
    for word in shlex.split(ready[1].replace("DIAMETER,Z0,Z1", BAR))[1:]:
        name, _, last = word.rpartition("=")
        number = {"SPEED": speed, "VALUE": SIZE}.get(last)
        yield values.get(word, word if number is None else f"{name}={number}")


def _table(folder: Path, names: str) -> Path:
    """Tool table with end mills of some names."""
    path = folder / "tools.csv"
    lines = ["number,id,kind,diameter_mm,teeth,edge_length_mm,cutting_material"]
    for row, name in enumerate(re.findall(r"'([^']*)'", names), 1):
        number = name if name.isdecimal() else str(900 + row)
        lines.append(f"{number},{name},endmill,12,3,30,carbide")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _read_as(text: str) -> str:
    """Operations of the listing of ``check``, each with the number of its workingsteps."""
    rows = re.findall(r"workingstep +.*?  +([a-z_]+)(?:  +|$)", text, re.MULTILINE)
    kinds = dict.fromkeys(rows)
    return ", ".join(f"{rows.count(kind)} {kind}" for kind in kinds) or "nothing"


def _without(options: Sequence[str], names: tuple[str, ...]) -> list[str]:
    """Options without some of them and their values."""
    kept: list[str] = []
    words = iter(options)
    for word in words:
        if word in names:
            next(words)
        else:
            kept.append(word)
    return kept


def _kept(before: bytes, after: bytes) -> float:
    """Share of the bytes of the lines that stay."""
    lines, others = before.splitlines(keepends=True), after.splitlines(keepends=True)
    matcher = SequenceMatcher(None, lines, others, autojunk=False)
    kept = sum(
        len(line)
        for block in matcher.get_matching_blocks()
        for line in lines[block.a : block.a + block.size]
    )
    return kept / len(before)


def ways(files: Sequence[Path]) -> Iterator[Way]:
    """Go the ways of several programs."""
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            yield way(file, Path(folder))


def table(rows: Sequence[Way]) -> str:
    """Markdown of the ways: a row for each program, and below it the refusals."""
    heads = (
        "program", "read as", "given", "optimise", "NC code", "simulate", "second run equal",
        "bytes unchanged", "s",
    )  # fmt: skip
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    notes: list[str] = []
    for row in rows:
        cells = [row.name, row.read_as, _shown(row.options)]
        for name in ("optimise", "post", "simulate"):
            reason = row.steps[name].reason
            if reason:
                notes.append(f"{row.name}, {name}: {reason}")
            cells.append(f"no ({len(notes)})" if reason else "yes")
        cells.append({None: "", True: "yes", False: "**no**"}[row.is_same_again])
        cells.append("" if row.unchanged is None else f"{100.0 * row.unchanged:.1f} %")
        cells.append(f"{row.seconds:.1f}")
        lines.append(f"| {' | '.join(cells)} |")
    whole = sum(row.is_whole for row in rows)
    lines += ["", f"{whole} of {len(rows)} go the whole way.", ""]
    lines += [f"{number}. {note}" for number, note in enumerate(notes, 1)]
    return "\n".join(lines)


def _shown(options: Sequence[str]) -> str:
    """Options as they are typed, without the place of the tool table."""
    words = [Path(word).name if word.endswith(".csv") else word for word in options]
    return f"`{shlex.join(words)}`" if words else ""
