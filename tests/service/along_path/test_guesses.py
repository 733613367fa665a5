"""Code of which tools or stock are guessed: no feed is bolder than with the true ones."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from service.errors import OK
from service.requests.advice import AdviceRequest
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import Severity
from stepnc_model.nc.moves import MoveKind
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.units import speed_from_mm_min
from tests.every_case import every_case

pytestmark = pytest.mark.slow

POSTS = Path(__file__).parents[2] / "data" / "posts"
ALONE = AdviceRequest(machine="vmc15", material="c45")
POCKET = (
    "%\nO1001 (POCKET)\n(T1 D=10. CR=0. - ZMIN=-5. - FLAT END MILL)\n"
    "(T2 D=5. CR=0. TAPER=118DEG - ZMIN=-12. - DRILL)\nG90 G94 G17 G21\n"
    "T1 M6\nS5000 M3\nG54\nG0 X30. Y20.\nG43 Z15. H1\nG1 Z5. F500.\nZ1. F333.\n"
    "G3 X20. I-5. Z-1.\nX30. I5. Z-3.\nG1 X45. F600.\nY40.\nX5.\nY5.\nX45.\nY20.\n"
    "G0 Z15.\nT2 M6\nS3000 M3\nG0 X-10. Y5.\nG43 Z15. H2\n"
    "G98 G83 X-10. Y5. Z-12. R5. Q2. F150.\nG80\nG0 Z50.\nM30\n%\n"
)
ROW = "{},{},{},{},{}\n"
TRUE_STOCKS = ("-30,-20,-20,70,60,0", "-16,-1,-13,60,50,1")


@cache
def advised(text: str, stock: str = "", *, tools: str = "") -> CodeAdvice:
    """Advice for a program with what is given beside it."""
    with TemporaryDirectory() as folder:
        file, table = Path(folder) / "part.nc", Path(folder) / "tools.csv"
        file.write_text(text)
        table.write_text(tools)
        files = AdviceFiles(file=file, tools=table if tools else None, dry_run=True)
        return optimise_code(replace(ALONE, stock=stock), files)


def table(teeth: int, edge: str) -> str:
    """Tools that the comments may mean."""
    head = "number,kind,diameter_mm,teeth,cutting_material\n"
    mill, drill = ROW.format(1, "endmill", 10, teeth, edge), ROW.format(2, "drill", 5, 2, edge)
    return head + mill + drill


def greatest(program: NcProgram, lines: np.ndarray) -> dict[int, float]:
    """Greatest feed of each line of the source, mm/s."""
    found: dict[int, float] = {}
    moves = program.moves
    for row in np.flatnonzero(np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC))).tolist():
        line = int(lines[moves.block[row]])
        found[line] = max(found.get(line, 0.0), float(moves.feed[row]))
    return found


def feeds(found: CodeAdvice) -> dict[int, float]:
    """Greatest advised feed of each line of the program, mm/s."""
    program = read_program(found.rewritten.data)
    written = found.rewritten.lines
    count = len(program.text)
    origins = np.array([written.origin(line).line for line in range(1, count + 1)])
    return greatest(program, origins)


def programmed(text: str) -> dict[int, float]:
    """Programmed feed of each line, mm/s."""
    program = read_program(text.encode())
    return greatest(program, program.text.lines)


@every_case("stock", TRUE_STOCKS)
@every_case(("teeth", "edge"), [(2, "carbide"), (4, "carbide"), (6, "carbide")])
def test_no_feed_is_bolder_than_programmed_and_than_with_the_truth(
    teeth: int, edge: str, stock: str
) -> None:
    guessed, true = advised(POCKET), advised(POCKET, stock, tools=table(teeth, edge))
    before, informed = programmed(POCKET), feeds(true)
    for line, feed in feeds(guessed).items():
        # Corners share the time of a line differently: its greatest feed varies a little.
        assert feed <= 1.1 * max(before[line], informed[line]), line


def test_feeds_rise_and_none_falls() -> None:
    guessed, before = advised(POCKET), programmed(POCKET)
    found = feeds(guessed)
    assert any(feed > 1.2 * before[line] for line, feed in found.items())
    assert all(feed > 0.999 * before[line] for line, feed in found.items())
    assert guessed.time_after < 0.95 * guessed.time_before


def test_what_is_guessed_is_told_and_is_no_fault() -> None:
    guessed = advised(POCKET)
    messages = " ".join(each.message for each in guessed.findings)
    for words in ("T1 is a 10 mm endmill", "3 teeth", "T2 is a 5 mm drill", "a box around"):
        assert words in messages
    assert guessed.exit_code == OK
    assert not any(each.severity is Severity.ERROR for each in guessed.findings)


def test_air_of_a_guessed_stock_keeps_its_feed() -> None:
    over = POCKET.replace("G0 Z15.\nT2", "G1 Z30. F400.\nX90. F400.\nT2")
    line = over.splitlines().index("X90. F400.") + 1
    assert feeds(advised(over))[line] == pytest.approx(speed_from_mm_min(400.0))


def test_a_second_run_changes_nothing() -> None:
    written = advised(POCKET).rewritten.data.decode()
    assert advised(written).rewritten.data.decode() == written


@every_case("post", sorted(file.name for file in POSTS.iterdir()))
def test_programs_in_the_manner_of_posts_need_a_material_alone(post: str) -> None:
    files = AdviceFiles(file=POSTS / post, dry_run=True)
    found = optimise_code(ALONE, files)
    assert found.is_advised
    assert not found.faults
    text = (POSTS / post).read_text()
    before = programmed(text)
    assert all(feed > 0.999 * before[line] for line, feed in feeds(found).items())
