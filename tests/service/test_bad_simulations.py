"""Rude programs, files, numbers and disks for ``simulate``.

Whatever is wrong: exit code 3 and one line that says what and where. What was simulated before
a fault in the middle of a program stays readable beside the output, under another name.
"""

import re
import signal
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest
from pyarrow import csv, parquet

from service.cli.main import main
from service.simulation import run_collector as gathering
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import simulate
from stepnc_model.errors import StepNcError, WriteError
from tests.asking import asked_simulation
from tests.every_case import every_case
from tests.full_disk import files_of_at_most
from tests.service.waiting import ended

PARTS = Path(__file__).parents[2] / "examples" / "parts"

BAD_INPUT, LIMIT_EXCEEDED, INTERRUPTED = 3, 5, 130

START = "G17 G21 G40 G49 G54 G80 G90 G94\nT1 M6\nS3000 M3\nG0 X-20 Y10 Z5\nZ-2\n"
CUT = "G1 X120 F300\n"
END = "G0 Z5\nM30\n"

TABLE = '[[tool]]\nnumber = 1\nkind = "endmill"\ndiameter_mm = 10\nteeth = 4\n'
STOCK = "0,0,-20,100,50,0"

# A shell that starts the tests in the background lets them ignore interrupts.
STEPNC = [
    sys.executable,
    "-c",
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from service.cli.main import main; main()",
]

Refused = Callable[..., str]


@pytest.fixture
def code(tmp_path: Path) -> Path:
    """A slot across a block, in a folder of its own with its tool table."""
    path = tmp_path / "slot.ngc"
    path.write_text(START + CUT + END, encoding="ascii")
    path.with_name("tools.toml").write_text(TABLE, encoding="ascii")
    return path


@pytest.fixture
def beside(code: Path) -> Path:
    """The slot beside a link to itself, one to a full disk, and a folder."""
    code.with_name("link.csv").symlink_to(code)
    code.with_name("full.csv").symlink_to("/dev/full")
    code.with_name("folder.csv").mkdir()
    return code


def alone(code: Path, **changed: str) -> list[str]:
    """Options that simulate code without a program; None takes one away."""
    options = {
        "nc": str(code),
        "machine": "vmc15",
        "material": "c45",
        "tools": str(code.with_name("tools.toml")),
        "stock": STOCK,
        **changed,
    }
    return ["simulate", *(f"--{name}={value}" for name, value in options.items() if value)]


@pytest.fixture
def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Refused:
    """Run a command that must refuse in one line and leave no file; that line."""

    def run(*words: object) -> str:
        before = sorted(tmp_path.iterdir())
        with pytest.raises(SystemExit) as stopped:
            main(list(map(str, words)))
        out, told = capsys.readouterr()
        assert stopped.value.code == BAD_INPUT, told
        assert sorted(tmp_path.iterdir()) == before
        assert not out
        *_, last = told.splitlines()
        assert last.startswith("error: ")
        assert "Traceback" not in told
        assert not re.search(r"\b(None|[A-Z]\w+Error)\b", last)
        return last

    return run


# ------------------------------------------------------------------ NC code


@every_case(
    ("text", "words"),
    [
        ("", "slot.ngc: the program contains nothing that takes time"),
        ("(a remark)\n", "takes time"),
        ("M30\n", "takes time"),
        ("hello world\n", "line 1: not understood: 'h' is no word: hello world"),
        (START + "G199 X1\n", "line 6: not understood: G199 is not known"),
        (START + "G1 X120\n", "line 6 left out of the run: no feed in force"),
        (START + "G1 X120 F0\n", "line 6 left out of the run: no feed in force"),
        (START + "G1 X120 F-5\n", "line 6 left out of the run: no feed in force"),
        (START + f"G1 X120 F{'9' * 400}\n", "line 6: not understood: 'F99"),
        (
            START + "G1 X120 F0.000000001\n",
            "line 6: 8.4e+12 s of machining: the limit is 1e+07 s",
        ),
        (START + f"G1 X{'9' * 40} F100\n", "line 6: not understood: 'X99"),
        (
            START + "G2 X0 Y10 I3 J0 F100\n",
            "line 6: not understood: the arc does not fit its ends",
        ),
        (START + "G2 X0 Y10 I0 J0 F100\n", "the arc does not fit its ends"),
        (START + "G2 X0 Y10 R2 F100\n", "the arc does not fit its ends"),
        (START + "G4 P-1\n", "line 6: not understood: a dwell of -1 s"),
        (START + "G4 P999999999\n", "line 6: 1e+09 s"),
        (START.replace("S3000", "S-1"), "line 3: not understood: a spindle speed of -1"),
        (
            START.replace("T1 M6", "T9 M6") + CUT,
            "line 6 left out of the run: the tool is not in the tool table",
        ),
        (
            START.replace("T1 M6", "T0 M6") + CUT,
            "line 6 left out",
        ),
        (
            START.replace("S3000 M3", "G95") + "G1 X9 F.1\n",
            "line 6 left out of the run: a feed per revolution while the spindle is stopped",
        ),
        ("\0\1\2", "line 1: "),
    ],
)
def test_code_that_cannot_be_run_is_refused_with_its_line(
    code: Path, refused: Refused, text: str, words: str
) -> None:
    code.write_text(text, encoding="ascii")
    assert words in refused(*alone(code))


def test_a_move_off_the_travel_leaves_what_came_before_it(
    code: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code.write_text(START + CUT + "G4 P5\nG0 X2000\n", encoding="ascii")
    with pytest.raises(SystemExit) as stopped:
        main([*alone(code), "-o", str(code.with_name("run.csv"))])
    assert stopped.value.code == BAD_INPUT
    *_, written, last = capsys.readouterr().err.splitlines()
    assert last == (
        "error: slot.ngc: workingstep 'T1': line 8: X = 2000 mm is outside the travel of the "
        "axis, -350 to 450 mm in the program's coordinates"
    )
    partial = code.with_name("run.partial.csv")
    rows = csv.read_csv(partial).num_rows
    assert rows > 300
    assert written == f"written: {partial} ({rows} samples)"
    assert not code.with_name("run.csv").exists()


@every_case(
    "text",
    [
        START + CUT,
        START + CUT + "M30\nG1 X9 Q1 F\n",
        START.replace("T1 M6\n", "") + CUT + END,
        START.replace("S3000 M3\n", "") + CUT + END,
        START.replace("S3000", "S99999999") + CUT + END,
        START + "G1 X-20 F300\n" + "G1 X-19.9999\nX-20\n" * 20 + END,
        START + "G3 X-20 Y10 I0 J0.0001 F100\n" + END,
        START + "G0 X50\n" + END,
    ],
)
def test_code_that_is_only_strange_is_run(code: Path, text: str) -> None:
    code.write_text(text, encoding="ascii")
    with pytest.raises(SystemExit) as stopped:
        main([*alone(code), "--json"])
    assert stopped.value.code in {0, LIMIT_EXCEEDED}


def test_cutting_with_a_standing_spindle_is_said(code: Path) -> None:
    code.write_text(START.replace("S3000 M3\n", "") + CUT + END, encoding="ascii")
    request = CodeRequest(code=code, tools=code.with_name("tools.toml"), stock=STOCK)
    run = simulate(*asked_simulation(code=request, machine="vmc15", material="c45"))
    assert "warning: line 5: cut with a stopped spindle" in "\n".join(map(str, run.findings))
    assert run.whole.force.value == 0.0


# ------------------------------------------------------------------ numbers and names


@every_case(
    ("changed", "words"),
    [
        ({"rate": "0"}, "rate 0 Hz: it must be 1 to 10000 Hz"),
        ({"rate": "-10"}, "rate -10 Hz"),
        ({"rate": "nan"}, "rate nan Hz"),
        ({"rate": "inf"}, "rate inf Hz"),
        ({"seed": "-1"}, "seed -1"),
        ({"missing": "1"}, "missing 1"),
        ({"missing": "nan"}, "missing nan"),
        ({"deviation-mm": "inf"}, "deviation inf mm"),
        (
            {"filter-s": "1e-300,1e-300"},
            "1e-06 to 100 s",
        ),
        ({"filter-s": "1"}, "filter times '1'"),
        ({"zero": "nan,0,0"}, "zero 'nan,0,0'"),
        (
            {"zero": "100,100,600"},
            "Z = 5 mm is outside",
        ),
        ({"runout-um": "5"}, "--force tooth"),
        ({"runout-um": "-5", "force": "tooth"}, "runout -5 µm"),
        ({"force": "x"}, "force 'x'"),
        ({"noise": "x"}, "noise 'x'"),
        ({"control": "x"}, "control 'x'"),
        ({"dialect": "x"}, "dialect 'x'"),
        ({"dialect": "canonical"}, "canonical commands"),
        ({"machine": "x"}, "machine 'x'"),
        ({"machine": ""}, "--machine"),
        ({"machine": "paper002"}, "no data for its axes"),
        ({"machine": "lathe22"}, "lathe22 is a lathe"),
        ({"material": "x"}, "material 'x'"),
        ({"material": ""}, "--material"),
        ({"stock": "text"}, "stock 'text'"),
        ({"stock": "1,2,3,4"}, "stock '1,2,3,4'"),
        ({"stock": "nan,0,0,1,1,1"}, "stock 'nan,0,0,1,1,1'"),
        (
            {"stock": "0,0,0,0,0,0"},
            "stock: x from 0 to 0 mm: must span at least 0.01 mm, within 100000 mm",
        ),
        ({"stock": "0,0,0,1,-1,1"}, "y from 0 to -1 mm"),
        ({"stock": "0,0,0,1,1,1e6"}, "z from 0 to 1e+06 mm"),
        ({"stock": "-10,0,20"}, "x from 5 to -5 mm"),
    ],
)
def test_a_number_or_name_that_cannot_be_is_refused(
    code: Path, refused: Refused, changed: dict[str, str], words: str
) -> None:
    assert words in refused(*alone(code, **changed))


def test_a_huge_stock_takes_no_more_memory(code: Path) -> None:
    with pytest.raises(SystemExit) as stopped:
        main([*alone(code, stock="-1e5,-1e5,-20,1e5,1e5,0"), "--json"])
    assert stopped.value.code in {0, LIMIT_EXCEEDED}


@every_case(
    ("table", "words"),
    [
        ("", "has no [[tool]]"),
        ("tool = [1", "is not valid TOML"),
        (TABLE + TABLE, "tool[1].number: T1"),
        (TABLE.replace("diameter_mm", "diametermm"), "tool[1].diametermm"),
        (TABLE + "colour = 1\n", "tool[1].colour"),
        (TABLE.replace("= 10", "= -10"), "tool[1].diameter_mm: -10 mm"),
        (TABLE.replace("= 10", "= nan"), "tool[1].diameter_mm: nan"),
        (TABLE.replace("= 10", '= "ten"'), "tool[1].diameter_mm"),
        (TABLE.replace("endmill", "axe"), "tool[1].kind"),
        (
            '[[tool]]\nnumber = 1\nkind = "turning"\n',
            "is a turning tool",
        ),
    ],
)
def test_a_tool_table_that_cannot_be_used_is_refused(
    code: Path, refused: Refused, table: str, words: str
) -> None:
    code.with_name("tools.toml").write_text(table, encoding="ascii")
    assert words in refused(*alone(code))


@every_case(
    ("words", "message"),
    [
        ([], "name a STEP-NC program, or NC code with --nc"),
        ([PARTS / "shaft.stpnc", "--tools", "x"], "x: cannot be read"),
        (["nowhere"], "nowhere: No such file"),
        ([PARTS], "is a folder"),
        ([PARTS / "paper002.stpnc", "--machine", "paper002"], "no data for its axes"),
        (
            [PARTS / "shaft.stpnc", "--machine", "vmc15"],
            "shaft.stpnc: workingstep 'ROUGH FACE': line 14: T1 ROUGHING TOOL, CARBIDE P25 "
            "is a turning tool, but the machine is a mill",
        ),
        (
            [PARTS / "bracket.stpnc", "--machine", "lathe22"],
            "X = -39.5 mm",
        ),
        (
            [PARTS / "bracket.stpnc", "--nc", "x.ngc", "--stock", STOCK],
            "tools and stock",
        ),
    ],
)
def test_programs_and_options_that_do_not_go_together_are_refused(
    refused: Refused, words: list[object], message: str
) -> None:
    assert message in refused("simulate", *words)


def test_a_program_whose_stock_has_no_volume_is_refused(code: Path, refused: Refused) -> None:
    part = code.with_name("part.stpnc")
    text = (PARTS / "bracket.stpnc").read_text(encoding="ascii")
    few = text.replace("'MAIN WORKPLAN',(#3,#7,#4,#5,#6)", "'MAIN WORKPLAN',(#15)")
    part.write_text(few.replace("#34,156.,", "#34,0.,"), encoding="ascii")
    told = refused("simulate", part, "--machine=vmc15")
    assert "stock: x from -3 to -3 mm: must span at least 0.01 mm" in told


# ------------------------------------------------------------------ files and disks


def test_code_that_cannot_be_read_is_refused(code: Path, refused: Refused) -> None:
    junk = code.with_name("junk.ngc")
    junk.write_bytes(bytes(range(256)) * 20)
    assert "junk.ngc: line 1: " in refused(*alone(code, nc=str(junk)))
    assert "nowhere.ngc: No such file" in refused(*alone(code, nc="nowhere.ngc"))
    assert "is a folder" in refused(*alone(code, nc=str(code.parent)), "--dialect=fanuc")
    assert "is a folder" in refused(*alone(code, nc=str(PARTS)))
    assert "is not a valid file name" in refused(*alone(code, nc="a\0.ngc"))


@every_case(
    ("output", "words"),
    [
        ("run.txt", ".parquet or .csv"),
        ("run", ".parquet or .csv"),
        ("/dev/full", ".parquet or .csv"),
        ("link.csv", "name another file"),
        ("nowhere/run.csv", "folder does not exist"),
        ("/dev/full/run.csv", "folder does not exist"),
        ("folder.csv", "not a regular file"),
        ("full.csv", "not a regular file"),
        ("n" * 300 + ".csv", "File name too long"),
        ("a\0.csv", "is not a valid file name"),
        ("/proc/run.csv", "No such file or directory"),
    ],
)
def test_an_output_that_cannot_be_is_refused(
    beside: Path, refused: Refused, output: str, words: str
) -> None:
    assert words in refused(*alone(beside), "-o", beside.parent / output)


@pytest.mark.parametrize("report", ["slot.ngc", "tools.toml", "run.csv"])
def test_a_report_onto_another_file_of_the_run_is_refused(
    code: Path, refused: Refused, report: str
) -> None:
    output = code.with_name("run.csv")
    told = refused(*alone(code), "-o", output, "--report", code.with_name(report))
    assert "name another file" in told


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_disk_that_fills_leaves_the_old_run(code: Path, suffix: str) -> None:
    path = code.with_name(f"run{suffix}")
    path.write_text("old", encoding="ascii")
    before = sorted(code.parent.iterdir())
    tools = code.with_name("tools.toml")
    with files_of_at_most(5_000), pytest.raises(WriteError, match=f"run{suffix}: .*too large"):
        simulate(
            *asked_simulation(
                code=CodeRequest(code=code, tools=tools, stock=STOCK),
                machine="vmc15",
                material="c45",
                rate=1_000.0,
                output=path,
            )
        )
    assert path.read_text(encoding="ascii") == "old"
    assert sorted(code.parent.iterdir()) == before


def long_program(path: Path, moves: int) -> None:
    """Code of many short moves, and a long wait after each thousand."""
    lines = (
        f"X{10.0 + number % 100 * 0.8:.1f} Y{10.0 + number // 100 % 50 * 0.5:.1f}\n"
        + ("G4 P900\nG1\n" if number % 1_000 == 999 else "")
        for number in range(moves)
    )
    text = START + "G1 F3000\n"
    path.write_text(text + "".join(lines) + END, encoding="ascii")


def test_an_interrupt_leaves_what_there_is(code: Path) -> None:
    long_program(code, 200_000)
    path = code.with_name("run.parquet")
    path.write_text("old", encoding="ascii")
    words = [*STEPNC, *alone(code, tools="", stock=""), "--rate=1000", "-o", str(path)]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        assert re.match(r"\[[#-]+\] +\d+%  \d+ s of machining", running.stderr.readline())
        running.send_signal(signal.SIGINT)
        *_, written, last = running.stderr.read().splitlines()
        assert ended(running) == INTERRUPTED
    partial = code.with_name("run.partial.parquet")
    rows = parquet.read_table(partial).num_rows
    assert last == "interrupted"
    assert written == f"written: {partial} ({rows} samples)"
    assert path.read_text(encoding="ascii") == "old"
    names = {each.name for each in code.parent.iterdir()}
    assert names == {code.name, "tools.toml", path.name, partial.name}


def test_memory_grows_by_the_moves_alone(code: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gathering, "ROWS", 4_096)
    output = code.with_name("run.csv")

    def peak(moves: int) -> int:
        long_program(code, moves)
        tracemalloc.start()
        request = CodeRequest(code=code)
        simulate(*asked_simulation(code=request, machine="vmc15", rate=5.0, output=output))
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(1_000)
    # A move is a row of 81 bytes, and for a while a value; its samples are in the file.
    assert peak(6_000) < peak(2_000) + 4_000 * 1_000


def test_many_moves_without_a_pause_are_run(code: Path) -> None:
    moves = 45_000
    code.write_text(START + "G1 F3000\n" + "X0\nX0.1\n" * (moves // 2) + END, encoding="ascii")
    request = asked_simulation(code=CodeRequest(code=code), machine="vmc15")
    run = simulate(*request)
    assert run.whole.duration > moves * 0.1 / 50.0


def test_errors_are_of_the_project(code: Path) -> None:
    code.write_text(START + CUT + "G0 X2000\n", encoding="ascii")
    tools = code.with_name("tools.toml")
    with pytest.raises(StepNcError) as caught:
        simulate(
            *asked_simulation(
                code=CodeRequest(code=code, tools=tools, stock=STOCK),
                machine="vmc15",
                material="c45",
            )
        )
    assert caught.value.__cause__.__class__.__name__ == "OutOfTravel"
