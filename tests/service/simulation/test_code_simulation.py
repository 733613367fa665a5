"""Blocks, tools and stock from NC code, of our own or of any origin."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.progress import silent
from service.requests.advice import AdviceRequest
from service.requests.runs import RunRequest
from service.simulation.code_simulation import IDLE, CodeRequest, from_code
from service.simulation.run import simulate
from service.simulation.setup import PreparedRun, from_program
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.request import AdviceFiles
from simulator.machine.virtual import LoadedTool
from simulator.removal.cutter import Cutter
from simulator.removal.lathe import TurningStock
from stepnc_model.errors import StepNcError
from stepnc_model.post import blocks as post
from tests.asking import asked_simulation
from tests.service.along_path.foreign import BAR, BOX, END, HEAD, INSERTS, slot
from tests.service.along_path.foreign import TOOLS as TABLE
from tests.service.verbs.optimise.test_code import PROGRAMS

EXAMPLES = Path(__file__).parents[3] / "examples"
BRACKET = EXAMPLES / "parts" / "bracket.stpnc"
TOOLS = EXAMPLES / "tools" / "bracket.toml"

CAM = """%
O01001 (PART)
(T1  D=12. CR=0. - ZMIN=-4. - flat end mill)
N10 G90 G94 G17 G21
N15 G53 G0 Z0.
N20 T1 M6
N25 S3000 M3
N30 G54 M8
N35 G0 X-10. Y10.
N40 G43 Z15. H1
N45 Z-4.
N50 G1 X110. F300.
N55 G18 G2 X118. Z4. I0. K8.
N60 G0 Z15.
N65 M9
N70 G53 G0 Z0.
N75 M30
%
"""


def without_holder(tool: LoadedTool) -> LoadedTool:
    """Tool of which the holder is not compared: the program states the assembly's length."""
    assert isinstance(tool.shape, Cutter)
    return replace(tool, shape=replace(tool.shape, holder=None))


def test_the_table_of_the_example_holds_the_tools_of_its_program(tmp_path: Path) -> None:
    code = tmp_path / "a.ngc"
    code.touch()
    request = CodeRequest(code=code, tools=TOOLS, stock="-3,-3,-40,153,93,2")
    prepared = from_code(request, RunRequest(machine="vmc15", material="c45"), program=None)
    known = from_program(BRACKET, RunRequest(machine="vmc15"), tell=silent)
    tools, others = (
        {number: without_holder(tool) for number, tool in (each.tools or {}).items()}
        for each in (prepared, known)
    )
    assert tools == others
    assert prepared.raw == known.raw


def coded(folder: Path, text: str, name: str = "a.ngc", *, dialect: str = "") -> PreparedRun:
    path = folder / name
    path.write_text(text, encoding="ascii")
    request = CodeRequest(code=path, dialect=dialect)
    return from_code(request, RunRequest(machine="vmc15"), program=None)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.ngc", "G21 G90 G94\nG0 X1 Y2 Z3\n"),
        ("a.NC", "G21 G90 G94\nG0 X1. Y2. Z3.\n"),
        ("a.mpf", "G710 G90 G94\nG0 X1 Y2 Z3\n"),
        ("a.h", "0 BEGIN PGM A MM\n1 L X+1 Y+2 Z+3 R0 FMAX\n"),
    ],
)
def test_the_ending_of_a_file_names_its_dialect(tmp_path: Path, name: str, text: str) -> None:
    rapids = [
        (line, block.end)
        for line, block in coded(tmp_path, text, name).blocks
        if isinstance(block, post.Rapid)
    ]
    assert rapids == [(2, (1.0, 2.0, 3.0))]


def test_a_dialect_that_is_named_wins(tmp_path: Path) -> None:
    prepared = coded(tmp_path, "0 BEGIN PGM A MM\n1 M8\n", dialect="HEIDENHAIN")
    assert [line for line, block in prepared.blocks if isinstance(block, post.Coolant)] == [2]


def test_remarks_that_name_a_workingstep_begin_it(tmp_path: Path) -> None:
    path = tmp_path / "a.ngc"
    path.write_text("(rough-face)\n(mill a slot)\n(MILL SLOT)\n", encoding="ascii")
    request = CodeRequest(code=path)
    prepared = from_code(request, RunRequest(machine="vmc15"), program=BRACKET)
    begun = [
        block.workingstep for _, block in prepared.blocks if isinstance(block, post.Comment)
    ]
    assert begun == ["ROUGH FACE", "", "MILL SLOT"]


def test_a_bar_has_a_diameter_and_two_ends(tmp_path: Path) -> None:
    path = tmp_path / "a.ngc"
    path.write_text("", encoding="ascii")
    request = CodeRequest(code=path, stock="60,-150,2", tools=TOOLS)
    prepared = from_code(request, RunRequest(machine="lathe22", material="c45"), program=None)
    assert prepared.raw is not None
    assert (prepared.raw.low, prepared.raw.high) == ((-30.0, -30.0, -150.0), (30.0, 30.0, 2.0))
    assert prepared.raw.radius == 30.0
    assert isinstance(prepared.stock(""), TurningStock)


def test_share_of_code_is_that_of_its_blocks(tmp_path: Path) -> None:
    prepared = coded(tmp_path, "(A)\n" * 10)
    assert prepared.done() == 0.0
    assert len(list(prepared.blocks)) == 12
    assert prepared.done() == 1.0


def written(folder: Path, text: str, name: str = "part.nc") -> CodeRequest:
    """NC code with tools and stock."""
    (folder / "tools.csv").write_text(TABLE, encoding="ascii")
    (folder / name).write_text(text, encoding="ascii")
    return CodeRequest(code=folder / name, tools=folder / "tools.csv", stock=BOX)


def test_code_of_another_cam_runs_as_its_plan_says(tmp_path: Path) -> None:
    code = written(tmp_path, CAM)
    request = AdviceRequest(machine="vmc15", material="c45", stock=BOX)
    files = AdviceFiles(file=code.code, tools=code.tools, output=tmp_path / "out.nc")
    advice = optimise_code(request, files)
    run = simulate(*asked_simulation(code=code, machine="vmc15", material="c45"))
    assert run.whole.duration == pytest.approx(advice.along.time_before, rel=1e-9)
    assert run.whole.volume == pytest.approx(
        sum(step.before.volume for step in advice.along.steps)
    )
    after = simulate(
        *asked_simulation(
            code=CodeRequest(code=tmp_path / "out.nc", tools=code.tools, stock=BOX),
            machine="vmc15", material="c45",
        )
    )  # fmt: skip
    assert after.whole.duration == pytest.approx(advice.along.time_after, rel=1e-4)
    assert "note: read as code for haas, guessed from O01001" in map(str, run.findings)


@pytest.mark.parametrize("suffix", [".tap", ".nc", ""])
def test_the_words_of_code_show_its_dialect(tmp_path: Path, suffix: str) -> None:
    found = coded(tmp_path, CAM, f"part{suffix}")
    assert found.code is not None
    assert found.code.dialect.value == "haas"
    assert found.findings[-1] is IDLE


LEFT_OUT = {
    "a tool that the table lacks": ("T9 M6\nS3000 M3\n" + slot(40.0), "tool table"),
    "an end from a variable": (slot(40.0).replace("X110.", "X#100"), "not known"),
    "an unknown word": ("G199 X1.\n" + slot(40.0), "not understood: G199"),
}


@pytest.mark.parametrize("what", LEFT_OUT)
def test_what_cannot_be_run_is_refused_or_left_out(tmp_path: Path, what: str) -> None:
    words, told = LEFT_OUT[what]
    code = written(tmp_path, HEAD + "G53 G0 Z0.\n" + slot(10.0) + words + END)
    asked = asked_simulation(code=code, machine="vmc15", material="c45")
    with pytest.raises(StepNcError, match=r"part.nc: line \d+.*--keep-going leaves it out"):
        simulate(*asked)
    asked = asked_simulation(code=code, machine="vmc15", material="c45", keep_going=True)
    run = simulate(*asked)
    assert told in "\n".join(map(str, run.findings))
    # 12 mm wide, 4 mm deep, 100 mm long; with the word that is unknown the slot is known again.
    slots = 2.0 if what == "an unknown word" else 1.0
    assert run.whole.volume == pytest.approx(slots * 4800.0, rel=0.01)


@pytest.mark.parametrize(
    ("words", "told"), [("S-5", "speed of -5"), ("G4 P-1.", "dwell of -1 s")]
)
def test_numbers_below_nothing_are_refused(tmp_path: Path, words: str, told: str) -> None:
    code = written(tmp_path, CAM.replace("N30 G54", f"N30 {words}\nN31 G54"))
    with pytest.raises(StepNcError, match=f"part.nc: line 8: not understood: .*{told}"):
        simulate(*asked_simulation(code=code, machine="vmc15", material="c45"))


def test_code_for_another_kind_of_machine_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="this is code for a mill, and lathe22 is a lathe"):
        simulate(
            *asked_simulation(code=written(tmp_path, CAM), machine="lathe22", material="c45")
        )


@pytest.mark.parametrize("name", PROGRAMS)
def test_code_of_many_origins_runs(name: str, tmp_path: Path) -> None:
    text, request = PROGRAMS[name]
    code = written(tmp_path, text)
    if request.machine == "lathe22":
        (tmp_path / "tools.csv").write_text(INSERTS, encoding="ascii")
        code = replace(code, stock=BAR)
    asked = asked_simulation(
        code=code, machine=request.machine, material="c45", keep_going=True
    )
    assert simulate(*asked).whole.volume > 0.0


def test_small_letters_remove_what_plain_code_removes(tmp_path: Path) -> None:
    text = HEAD + slot(40.0) + END
    plain, foreign = (
        simulate(
            *asked_simulation(code=written(tmp_path, words), machine="vmc15", material="c45")
        )
        for words in (text, text.lower().replace("o0001", "; small"))
    )
    assert plain.whole.volume == pytest.approx(4800.0, rel=0.002)
    assert foreign.whole.volume == pytest.approx(plain.whole.volume)
    assert foreign.whole.cutting_time == pytest.approx(plain.whole.cutting_time)


def test_code_of_a_lathe_may_show_it_by_nothing(tmp_path: Path) -> None:
    text = "T1 M6\nS800 M3\nG53 G0 Z0\nG0 X23. Z2.\nG1 Z-40. F90.\nM30\n"
    code = replace(written(tmp_path, text, "part.ngc"), stock=BAR)
    (tmp_path / "tools.csv").write_text(INSERTS, encoding="ascii")
    run = simulate(*asked_simulation(code=code, machine="lathe22", material="c45"))
    assert run.whole.volume > 0.0


def test_an_error_in_the_code_of_a_program_names_its_file(tmp_path: Path) -> None:
    code = CodeRequest(code=tmp_path / "part.ngc")
    code.code.write_text("G21 G90\nG199 X1\n", encoding="ascii")
    asked = asked_simulation(BRACKET, code=code, machine="vmc15")
    with pytest.raises(StepNcError, match=r"^part.ngc: line 2: G199 is not known"):
        simulate(*asked)
