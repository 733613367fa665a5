"""NC code of any origin: what ``optimise`` makes of each program of some folders.

``python -m benchmarks.wild_code [FOLDER ...]`` optimises each program as a new user would, with
a material alone (default: the samples of posts of the tests). Where tools or a stock are
missing, stand-ins take their place, which is said: end mills of 10 mm, or turning inserts and a
bar around the moves. A Markdown table says for what each program was taken, what the user had
to give, the share of the path whose feed could be chosen, the times before and after, and the
seconds that it took; another one counts why feeds stayed or fell.
"""

import argparse
import re
import resource
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from optimiser.along_path.caps import CapName
from service.files import read_bytes
from service.inputs.program_kind import ProgramKind, kind_of
from service.requests.advice import AdviceRequest
from service.simulation.code_setup import CodeSetup, GivenSetup, code_setup
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import StepNcError
from stepnc_model.nc.moves import MoveKind, NcMoves
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.post.blocks import MachineType

POSTS = Path(__file__).parents[1] / "tests" / "data" / "posts"

MATERIAL = "c45"

MOST_SECONDS = 120.0
"""Time after which a program is given up, s."""

MOST_MEMORY = 2 << 30
"""Greatest memory of one program, bytes."""

STAYS = re.compile(r"the feeds of .*? stay as programmed: (?P<why>.*)")
"""Findings on feeds that could not be chosen."""

COLUMNS = (
    "program", "taken for", "needed", "path advised", "before s", "after s", "took s",
    "why not",
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class WildProgram:
    """Result of one program."""

    name: str
    taken_for: str = ""
    needed: str = ""
    """What the user had to give besides a material; empty: nothing."""
    share: float = 0.0
    """Share of the known path at a feed whose feed could be chosen."""
    before: float = 0.0
    after: float = 0.0
    seconds: float = 0.0
    reasons: Counter[str] = field(default_factory=Counter)
    """Findings on feeds that stay or fall, by reason."""
    error: str = ""


def tried(file: Path) -> WildProgram:
    """Optimise one program, with stand-ins for what it does not tell."""
    begin = time.perf_counter()
    data = read_bytes(file)
    if kind_of(data) is not ProgramKind.NC_CODE:
        return WildProgram(name=file.name, taken_for="no NC code", error="is no NC code")
    try:
        program = read_program(data)
    except StepNcError as error:
        return WildProgram(name=file.name, taken_for="NC code", error=str(error))
    taken_for = f"{program.dialect.value} {program.machine.value}"
    needed = ""
    try:
        setup = code_setup(program, GivenSetup(file=file, material=MATERIAL))
        needed = "; ".join(setup.missing)
        with tempfile.TemporaryDirectory() as folder:
            files = AdviceFiles(file=file, tools=_tools(program, setup, folder), dry_run=True)
            stock = "" if program.machine is MachineType.MILL or setup.stock else _bar(program)
            code = optimise_code(AdviceRequest(material=MATERIAL, stock=stock), files)
    except StepNcError as error:
        seconds = time.perf_counter() - begin
        return WildProgram(
            name=file.name,
            taken_for=taken_for,
            needed=needed,
            seconds=seconds,
            error=str(error),
        )
    return WildProgram(
        name=file.name,
        taken_for=taken_for,
        needed=needed,
        share=_share(program, code),
        before=code.time_before,
        after=code.time_after,
        seconds=time.perf_counter() - begin,
        reasons=Counter(_reasons(program, code)),
    )


def _tools(program: NcProgram, setup: CodeSetup, folder: str) -> Path | None:
    """Table of stand-ins; None where comments describe tools."""
    if setup.library.tools:
        return None
    numbers = sorted({each.tool for each in program.moves.settings if each.tool} or {1})
    table = Path(folder) / "stand_ins.csv"
    if program.machine is MachineType.MILL:
        rows = [f"{number},endmill,10,3," for number in numbers]
    else:
        rows = [f"{number},turning,,1,0.8" for number in numbers]
    head = "number,kind,diameter_mm,teeth,nose_radius_mm"
    table.write_text("\n".join((head, *rows)) + "\n")
    return table


def _bar(program: NcProgram) -> str:
    """Bar around the moves of a lathe at a feed."""
    rows = _fed(program.moves)
    if not rows.any():
        return "40,-100,0"
    points = np.concatenate((program.moves.start[rows], program.moves.end[rows]))
    radius = float(np.nanmax(np.abs(points[:, 0])))
    low, high = float(np.nanmin(points[:, 2])), float(np.nanmax(points[:, 2]))
    return f"{max(2.0 * radius, 1.0):.6g},{low - 5.0:.6g},{high + 0.1:.6g}"


def _fed(moves: NcMoves) -> np.ndarray:
    """True if moves go at a feed along a known path, (N,)."""
    return np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & moves.is_known


def _share(program: NcProgram, code: CodeAdvice) -> float:
    """Share of the known path at a feed whose feed could be chosen."""
    whole = float(np.nansum(program.moves.length[_fed(program.moves)]))
    chosen = sum(
        length
        for step in code.along.steps
        if step.plan is not None and step.name not in code.along.idle
        for name, (length, _) in step.plan.shares.items()
        if name is not CapName.NO_STOCK
    )
    return min(1.0, chosen / whole) if whole else 0.0


def _reasons(program: NcProgram, code: CodeAdvice) -> Iterator[str]:
    """Reasons why feeds of a program stay or fall; those of reading only if nothing moves."""
    for each in code.findings:
        if stays := STAYS.search(each.message):
            yield stays["why"]
        elif "meets no stock" in each.message:
            yield "the tool meets no stock"
    for text in code.along.slower_than_programmed:
        yield f"slower: {text.partition(': ')[2] or text}"
    if not _fed(program.moves).any():
        yield "no known move at a feed"
    for each in program.findings:
        if "not understood" in each.message or "unknown" in each.message:
            yield re.sub(r"'.*?'|\d+", "…", each.message)


def _answer(file: Path, answers: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, MOST_MEMORY))
    try:
        answers.send(tried(file))
    except Exception as error:
        kind = type(error).__name__
        answers.send(WildProgram(name=file.name, error=f"CRASH {kind}: {error}"))


def in_process(file: Path, seconds: float) -> WildProgram:
    """Try one program in a process of its own, within a time."""
    context = get_context("fork")
    answers, ours = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(file, ours))
    process.start()
    try:
        if answers.poll(seconds):
            found: WildProgram = answers.recv()
            return found
        return WildProgram(name=file.name, error=f"not done after {seconds:g} s")
    except EOFError:
        return WildProgram(name=file.name, error="the process died")
    finally:
        process.kill()
        process.join()


def programs(folders: Sequence[Path]) -> Iterator[Path]:
    """Yield files of folders, and files that are named, which may be programs."""
    for folder in folders:
        if folder.is_file():
            yield folder
            continue
        tables = {".csv", ".toml", ".md", ".txt", ".tbl"}
        found = (each for each in sorted(folder.rglob("*")) if each.is_file())
        yield from (each for each in found if each.suffix.lower() not in tables)


def table(found: Sequence[WildProgram]) -> Iterator[str]:
    """Yield the lines of the table of programs, of the totals, and of the reasons."""
    yield f"| {' | '.join(COLUMNS)} |"
    yield "|---" * len(COLUMNS) + "|"
    for each in found:
        why = each.error or "; ".join(f"{why} ×{n}" for why, n in each.reasons.most_common(3))
        why = why.replace("|", "\\|").replace("\n", " ")[:160]
        figures = (
            "– | – | –"
            if each.error
            else (f"{each.share:.0%} | {each.before:.1f} | {each.after:.1f}")
        )
        needed = each.needed.replace("|", "\\|") or "–"
        yield (
            f"| {each.name} | {each.taken_for} | {needed} | {figures} | {each.seconds:.1f} | "
            f"{why} |"
        )
    done = [each for each in found if not each.error]
    faster = sum(each.after < 0.999 * each.before for each in done)
    slower = sum(each.after > 1.001 * each.before for each in done)
    yield ""
    yield (
        f"{len(found)} programs: {faster} faster, {slower} slower, "
        f"{len(done) - faster - slower} the same, {len(found) - len(done)} refused; "
        f"{sum(not each.needed for each in done)} needed nothing but a material"
    )
    yield ""
    yield "| programs | reason |"
    yield "|---|---|"
    reasons: Counter[str] = Counter()
    for each in found:
        reasons.update(each.reasons.keys())
        reasons.update([f"refused: {_refusal(each.error)}"] if each.error else [])
    for why, count in reasons.most_common():
        yield f"| {count} | {why} |"


def _refusal(error: str) -> str:
    """First words of an error, without the command to complete and without places."""
    return re.sub(r"/\S+", "…", error.partition("; complete and run")[0])[:120]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table of the programs of some folders."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path, default=[POSTS])
    parser.add_argument("--seconds", type=float, default=MOST_SECONDS)
    given = parser.parse_args(arguments)
    found = [in_process(file, given.seconds) for file in programs(given.folders)]
    print("\n".join(table(found)))


if __name__ == "__main__":
    main()
