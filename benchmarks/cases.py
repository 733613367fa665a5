"""Small inputs that once gave wrong or dangerous answers: what they gave, and give now.

Each row runs the commands of its case and prints the figures or the words that matter. The
cases lie beside the project, in ``shared/cases``.
"""

import contextlib
import io
import json
import re
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from service.cli.main import main as stepnc

ROOT = Path(__file__).parents[1]
PARTS = ROOT / "examples" / "parts"
CASES = ROOT.parent / "shared" / "cases"
NC, INPUT = CASES / "nc", CASES / "input"
MILL = ("--machine", "vmc15", "--material", "c45")
BLOCK = ("--tools", NC / "t6.csv", "--stock=-20,-20,-20,70,40,0", *MILL)
INCHES = ("--tools", NC / "t6.csv", "--stock=-508,-508,-508,1778,1016,0", *MILL)
PROFILE = CASES.parent / "corpus" / "iso14649" / "RanhuraPerfilVee.p21"
SLOT = (PROFILE, "--units", "rpm-mmtooth", "--confirm")

Word = str | Path


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """Exit code and output of a command."""

    code: int
    out: str
    err: str

    @property
    def plan(self) -> dict[str, Any]:
        """Its JSON."""
        found: dict[str, Any] = json.loads(self.out)
        return found

    def line(self, word: str) -> str:
        """First line with a word, in either stream."""
        lines = (self.err + self.out).replace(f"{INPUT}/", "").splitlines()
        return next((each.strip()[:100] for each in lines if word in each), f"no line '{word}'")


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One case: what was found once, and a function that finds what comes out now."""

    name: str
    then: str
    now: Callable[[Path], str]


def answer(*words: Word) -> Answer:
    """Answer of a command."""
    out, err = io.StringIO(), io.StringIO()
    code = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            stepnc([str(word) for word in words])
        except SystemExit as end:
            code = int(end.code or 0)
    return Answer(code=code, out=out.getvalue(), err=err.getvalue())


def plan(*words: Word) -> dict[str, Any]:
    """Plan of ``optimise`` as JSON."""
    return answer("optimise", *words, "--dry-run", "--json").plan


def material(part: str, name: Word) -> str:
    """Greatest advised feed of a part in a material, and what is marked."""
    steps = plan(PARTS / f"{part}.stpnc", "--machine", "vmc15", "--material", name)[
        "workingsteps"
    ]
    feeds = [each["advised"]["feed_mm_min"] for each in steps if each["status"] == "advised"]
    marked = sum(bool(each["unchecked"]) for each in steps)
    refused = sum(each["status"] == "infeasible" for each in steps)
    greatest = f"at most {max(feeds):.1f} mm/min" if feeds else "no feed"
    return f"{greatest}; marked as unchecked: {marked}, infeasible: {refused} of {len(steps)}"


def in_hard(name: str, _: Path) -> str:
    """Advice for a mill of high-speed steel in a hard material."""
    return material("paper002", name)


def modes() -> str:
    """Times of ROUGH POCKET by mode."""
    words = (PARTS / "bracket.stpnc", *MILL, "--workingstep", "ROUGH POCKET", "--mode")
    times = {mode: plan(*words, mode)["total_time_s"]["after"] for mode in ("TC", "EC")}
    return ", ".join(f"{mode} {value:.1f} s" for mode, value in times.items())


def slot(folder: Path) -> str:
    """Figures of the confirmation of a slot with sloped flanks."""
    found = answer("optimise", *SLOT, "-o", folder / "out.stpnc", "--json").plan["confirmation"]
    return (
        f"bounds passed {len(found['passed'])}, stock left unlike {len(found.get('stock', []))}"
    )


def feeds(folder: Path, program: Word, *words: Word, at: str) -> str:
    """Feeds of the blocks with a word, after optimisation."""
    out = folder / "out.nc"
    found = answer("optimise", program, *words, "-o", out)
    if not out.exists():
        return f"exit code {found.code}, nothing written: {found.line(':')}"
    lines = out.read_text(encoding="utf-8").splitlines()
    values = [
        each[1] for line in lines if at in line and (each := re.search(r"F([\d.]+)", line))
    ]
    return f"F{', F'.join(values)} at {at}, exit code {found.code}"


def second(folder: Path) -> str:
    """Comparison of the bytes of two runs in a row."""
    one, two = folder / "one.nc", folder / "two.nc"
    answer("optimise", NC / "arc_over_180.nc", *INCHES, "-o", one)
    answer("optimise", one, *INCHES, "-o", two)
    return "byte-equal" if one.read_bytes() == two.read_bytes() else "differs"


def refusal(*words: Word) -> str:
    """Exit code, first error line and time of a command."""
    begin = time.process_time()
    found = answer(*words)
    used = time.process_time() - begin
    return f"exit code {found.code} in {used:.1f} CPU-s: {found.line('error')}"


def said(word: str, *words: Word) -> str:
    """Exit code and the line of an answer that has a word."""
    found = answer(*words)
    return f"exit code {found.code}: {found.line(word)}"


def cases() -> Iterator[Case]:
    """Every case, in the order of their list."""
    yield Case(
        name="C45 without a group, paper002",
        then="6026.8 mm/min, no word",
        now=lambda _: material("paper002", CASES / "advice" / "c45_nogroup.toml"),
    )
    yield Case(
        name="a shop's least material file, bracket",
        then="20000 mm/min, no word",
        now=lambda _: material("bracket", CASES / "advice" / "shop_steel.toml"),
    )
    for name, then in (
        ("hardened_55hrc", 5844),
        ("hardened_60hrc", 6022),
        ("chilled_iron", 3753),
    ):
        yield Case(
            name=f"HSS mill in {name}",
            then=f"{then} mm/min",
            now=partial(in_hard, name),
        )
    yield Case(
        name="ROUGH POCKET by mode", then="TC 135.9 s, EC 131.3 s", now=lambda _: modes()
    )
    yield Case(
        name="slot with sloped flanks", then="36 % of the volume left, bend × 4.4", now=slot
    )
    yield Case(
        name="a cycle above the stock, F200",
        then="F11046",
        now=lambda to: feeds(to, NC / "drill_low_stock.nc", *BLOCK, at="Z5."),
    )
    yield Case(
        name="a straight plunge, F100",
        then="F750",
        now=lambda to: feeds(to, NC / "plunge.nc", *BLOCK, at="Z-15."),
    )
    yield Case(
        name="a tool table without teeth",
        then="one tooth, silently",
        now=lambda to: said(
            "number of teeth",
            "optimise",
            NC / "base.nc",
            "--tools",
            NC / "noteeth.csv",
            *BLOCK[2:],
            "-o",
            to / "out.nc",
        ),
    )
    yield Case(
        name="a rapid through the stock",
        then="exit code 0",
        now=lambda to: said("rapid", "optimise", NC / "crash.nc", *BLOCK, "-o", to / "out.nc"),
    )
    yield Case(name="a second run, arcs over 180°", then="differs", now=second)
    yield Case(
        name="a reference to nothing",
        then="KeyError",
        now=lambda _: refusal("check", INPUT / "dangling_reference.stpnc"),
    )
    yield Case(
        name="the same in AP238",
        then="KeyError",
        now=lambda _: refusal("simulate", INPUT / "ap238_dangling.stpnc"),
    )
    yield Case(
        name="an integer of 400 digits",
        then="OverflowError",
        now=lambda _: refusal("check", INPUT / "ap238_integer_400_digits.stpnc"),
    )
    yield Case(
        name="a damaged model",
        then="zlib.error",
        now=lambda _: refusal("predict", INPUT / "damaged.skops"),
    )
    yield Case(
        name="a feed of 1e-308 mm/min",
        then="ZeroDivisionError",
        now=lambda _: refusal("blockfit", INPUT / "blockfit_tiny_feed.csv"),
    )
    yield Case(
        name="7.6 KB that unpack to 4 GB",
        then="4007 MB",
        now=lambda _: refusal(
            "verify",
            INPUT / "dictionary_4_GB.parquet",
            "--program",
            PARTS / "paper003_case1.stpnc",
            "--machine",
            "paper003",
        ),
    )
    yield Case(
        name="9999 repeats in 6.9 KB",
        then="over 50 s, 1.2 GB",
        now=lambda _: refusal("check", INPUT / "repeats_9999.nc"),
    )


def main() -> None:
    """Print what each case gave, and what it gives now."""
    rows = []
    for case in cases():
        with tempfile.TemporaryDirectory() as folder:
            rows.append((case.name, case.then, case.now(Path(folder))))
    widths = [max(len(row[at]) for row in rows) for at in range(3)]
    for row in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)))


if __name__ == "__main__":
    main()
