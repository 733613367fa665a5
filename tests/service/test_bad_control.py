"""Rude options, files and interrupts for ``control``: one sentence, exit code 3, no file."""

import re
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from pyarrow import parquet

from kbe.store import open_store
from service.cli.interrupts import INTERRUPTED
from service.cli.main import main
from service.control.run import control
from service.errors import BAD_INPUT
from stepnc_model.errors import WriteError
from tests.asking import AskedControl
from tests.every_case import every_case
from tests.full_disk import files_of_at_most
from tests.service.waiting import ended

PARTS = Path(__file__).parents[2] / "examples" / "parts"
SLOT = PARTS / "paper003_case1.stpnc"
USAGE = 2

# A shell that starts the tests in the background lets them ignore interrupts.
STEPNC = [
    sys.executable,
    "-c",
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from service.cli.main import main; main()",
]

Refused = Callable[..., str]


@pytest.fixture
def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Refused:
    """Run a command that must refuse in one line and leave no file; that line."""

    def run(*words: object) -> str:
        before = sorted(tmp_path.iterdir())
        with pytest.raises(SystemExit) as stopped:
            main(["control", *map(str, words)])
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


@every_case(
    ("words", "message"),
    [
        ([], "name a STEP-NC program, or NC code with --nc"),
        (["nowhere.stpnc"], "No such file"),
        ([PARTS], "is a folder"),
        (["a\0b"], "valid file name"),
        ([SLOT, "--machine", "titanic"], "machine 'titanic'"),
        ([SLOT, "--material", "butter"], "unknown material 'butter'"),
        ([SLOT, "--law", "pid"], "law 'pid'"),
        ([SLOT, "--mode", "EC"], "mode 'EC'"),
        ([SLOT, "--sensor", "ear"], "sensor 'ear'"),
        ([SLOT, "--control", "magic"], "control 'magic'"),
        ([SLOT, "--units", "ell"], "units 'ell'"),
        ([SLOT, "--seed", "-1"], "seed -1"),
        (
            [SLOT, "--look-ahead", "-3"],
            "look-ahead -3",
        ),
        ([SLOT, "--force", "nan"], "force nan N"),
        ([SLOT, "--force", "inf"], "force inf N"),
        ([SLOT, "--force", "10"], "it must be above 10 N, the noise of the dynamometer"),
        ([SLOT, "--force", "-5"], "force -5 N"),
        ([SLOT, "--band", "20"], "band '20'"),
        ([SLOT, "--band", "nan,120"], "band 'nan,120'"),
        ([SLOT, "--band", "a,b"], "band 'a,b'"),
        ([SLOT, "--band", "120,20"], "band from 120 %"),
        ([SLOT, "--band", "-20,120"], "band from -20 %"),
        (
            [SLOT, "--disturb", "luck:1@2s"],
            "disturbance 'luck:1@2s': unknown kind 'luck'; known: ",
        ),
        ([SLOT, "--disturb", "depth:+50%"], "add a time"),
        ([SLOT, "--disturb", "material:butter@1s"], "unknown material 'butter'"),
        ([SLOT, "--disturb", "depth:nan@1s"], "'nan' is not a number"),
        ([SLOT, "--deviation-mm", "nan"], "deviation nan mm"),
        (
            [PARTS / "shaft.stpnc", "--machine", "vmc15"],
            "is a turning tool",
        ),
        ([PARTS / "paper002.stpnc", "--machine", "paper002"], "no data for its axes"),
    ],
)
def test_what_cannot_be_is_refused(refused: Refused, words: list[object], message: str) -> None:
    assert message in refused(*words)


def test_nc_code_alone_is_refused(
    refused: Refused, controlled: Callable[..., AskedControl]
) -> None:
    code = controlled()[1].code
    assert code is not None
    told = refused("--nc", code.code, "--machine", "vmc15", "--material", "c45")
    assert "control needs a STEP-NC program: NC code states no cutting limits" in told


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("run.txt", "a run is written as .parquet or .csv"),
        ("nowhere/run.csv", "the folder does not exist"),
        ("part.csv", "name another file"),
        ("folder.csv", "is not a regular file"),
    ],
)
def test_an_output_that_cannot_be_is_refused(
    refused: Refused, tmp_path: Path, output: str, words: str
) -> None:
    part = tmp_path / "part.csv"
    part.write_bytes(SLOT.read_bytes())
    (tmp_path / "folder.csv").mkdir()
    assert words in refused(part, "--machine", "vmc15", "-o", tmp_path / output)


def test_a_report_over_the_program_or_the_output_is_refused(
    refused: Refused, tmp_path: Path
) -> None:
    part, output = tmp_path / "part.stpnc", tmp_path / "run.csv"
    part.write_bytes(SLOT.read_bytes())
    assert "name another file" in refused(part, "--report", part)
    assert "name another file" in refused(part, "-o", output, "--report", output)
    assert "folder does not exist" in refused(part, "--report", tmp_path / "x" / "run.html")


@pytest.mark.parametrize("option", ["--seed", "--look-ahead", "--force"])
def test_words_for_numbers_are_a_matter_of_usage(
    capsys: pytest.CaptureFixture[str], option: str
) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["control", str(SLOT), option, "many"])
    assert stopped.value.code == USAGE
    assert f"argument {option}" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_disk_that_fills_leaves_the_old_run(
    controlled: Callable[..., AskedControl], tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"run{suffix}"
    path.write_text("old", encoding="ascii")
    with files_of_at_most(2_000), pytest.raises(WriteError, match=f"run{suffix}: .*too large"):
        control(*controlled(output=path))
    assert path.read_text(encoding="ascii") == "old"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_leaves_what_there_is(tmp_path: Path, number: signal.Signals) -> None:
    path = tmp_path / "run.parquet"
    path.write_text("old", encoding="ascii")
    part = PARTS / "bracket.stpnc"
    words = [*STEPNC, "control", str(part), "--machine", "vmc15", "-o", str(path)]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        while "workingstep: FINISH FACE" not in (line := running.stderr.readline()):
            assert line, "the run ended before the interrupt"
        running.send_signal(number)
        *_, written, last = running.stderr.read().splitlines()
        assert ended(running) == INTERRUPTED
    partial = tmp_path / "run.partial.parquet"
    rows = parquet.read_table(partial).num_rows
    assert last == "interrupted"
    assert written == f"written: {partial} ({rows} rows)"
    assert path.read_text(encoding="ascii") == "old"
    assert {each.name for each in tmp_path.iterdir()} == {path.name, partial.name}


@pytest.mark.parametrize("option", ["-o", "--report"])
def test_no_output_replaces_the_knowledge_base(
    refused: Refused, tmp_path: Path, option: str
) -> None:
    base = tmp_path / "kb.csv"
    with open_store(str(base)):
        pass
    before = base.read_bytes()
    told = refused(PARTS / "paper002.stpnc", "--kb", base, option, base)
    assert "name another file" in told
    assert base.read_bytes() == before


def test_a_knowledge_base_without_a_folder_is_refused_before_the_run(
    refused: Refused, tmp_path: Path
) -> None:
    told = refused(PARTS / "paper002.stpnc", "--kb", tmp_path / "none" / "kb.db")
    assert "the folder does not exist" in told


def test_an_endless_machine_file_is_refused(refused: Refused) -> None:
    told = refused(PARTS / "paper002.stpnc", "--machine", "/dev/zero")
    assert "is a device" in told or "unknown machine" in told
