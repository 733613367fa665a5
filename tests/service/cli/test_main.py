"""The command line: exit codes, what goes to stdout and what to stderr, and when."""

import argparse
import json
import os
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest

from service.cli import commands
from service.cli.main import main, optimise_main

ROOT = Path(__file__).parents[3]
PARTS = ROOT / "examples" / "parts"
VMC = (ROOT / "simulator" / "data" / "machines" / "vmc15.toml").read_text(encoding="utf-8")
CORPUS = ROOT.parent / "shared" / "corpus"
PAPER = PARTS / "paper002.stpnc"

OK, BAD_INPUT, INFEASIBLE, INTERRUPTED = 0, 3, 4, 130
OPTIMISE = "from service.cli.main import optimise_main; optimise_main()"
STEPNC = "from service.cli.main import main; main()"
SECONDS = 30.0


@pytest.fixture
def part(tmp_path: Path) -> Path:
    path = tmp_path / "part.stpnc"
    path.write_bytes(PAPER.read_bytes())
    return path


def optimise(*arguments: object) -> object:
    """Exit code of ``optimise``."""
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(each) for each in arguments])
    return stopped.value.code


def stepnc(*arguments: object) -> object:
    """Exit code of ``stepnc``."""
    with pytest.raises(SystemExit) as stopped:
        main([str(each) for each in arguments])
    return stopped.value.code


def command(code: str, *arguments: object) -> list[str]:
    """A command in a process of its own."""
    return [sys.executable, "-c", code, *map(str, arguments)]


def test_data_goes_to_stdout_and_messages_to_stderr(
    part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert optimise(part, "--machine", "paper002") == OK
    out, told = capsys.readouterr()
    assert "123.8 -> 290.0" in out
    assert "written: " not in out
    assert told.splitlines()[0].startswith("material: ")
    assert told.splitlines()[-1] == f"written: {part.with_name('part.optimised.stpnc')}"


def test_json_is_all_there_is_on_stdout(part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert optimise(part, "--machine", "paper002", "--json") == OK
    plan = json.loads(capsys.readouterr().out)
    assert plan["program"] == "part.stpnc"
    assert plan["workingsteps"][0]["active_limit"] == "motor_power"


def test_a_dry_run_writes_nothing(part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert optimise(part, "--dry-run") == OK
    assert [path.name for path in part.parent.iterdir()] == ["part.stpnc"]
    assert "written" not in capsys.readouterr().err


def test_limits_that_conflict_are_exit_code_4_and_the_rest_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    weak = tmp_path / "weak.toml"
    text = VMC.replace("max_cutting_force_n = 8_000", "max_cutting_force_n = 700")
    weak.write_text(text, encoding="utf-8")
    output = tmp_path / "out.stpnc"
    some = ("--workingstep", "DRILL HOLE 1", "--workingstep", "CENTRE HOLE 1")
    code = optimise(PARTS / "bracket.stpnc", "--machine", weak, *some, "-o", output)
    assert code == INFEASIBLE
    assert output.is_file()
    shown = capsys.readouterr().out
    assert "DRILL HOLE 1: infeasible: cutting force allows" in shown
    conflict = "(at most 700 N, × 1.263 for the spread of k_c), feed per tooth against rubbing"
    assert conflict in shown


def test_stepnc_optimise_is_optimise(part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert stepnc("optimise", part, "--dry-run", "--json") == OK
    one = capsys.readouterr().out
    assert optimise(part, "--dry-run", "--json") == OK
    assert capsys.readouterr().out == one


def test_check_tells_whether_a_program_is_usable(
    part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert stepnc("check", part) == OK
    assert capsys.readouterr().out.endswith("  advice: yes\n")
    text = part.read_text(encoding="ascii").replace(
        "#1=PROJECT('PAPER 002',#2", "#1=PROJECT('',$"
    )
    part.write_text(text, encoding="ascii")
    assert stepnc("check", part, "--json") == BAD_INPUT
    assert json.loads(capsys.readouterr().out)["is_usable"] is False


def test_convert_writes_the_other_profile(
    part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert optimise(part) == OK
    output = part.with_name("standard.stpnc")
    written = part.with_name("part.optimised.stpnc")
    assert stepnc("convert", written, "--profile", "standard", "-o", output) == OK
    assert output.is_file()
    assert not capsys.readouterr().out.endswith("standard.stpnc\n")


@pytest.mark.parametrize("kind", ["machines", "materials"])
def test_libraries_are_listed_and_an_unknown_name_is_refused(
    kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert stepnc(kind) == OK
    assert "paper002" in capsys.readouterr().out
    assert stepnc(kind, "paper002") == OK
    assert "source: " in capsys.readouterr().out
    assert stepnc(kind, "unobtanium") == BAD_INPUT
    out, told = capsys.readouterr()
    assert not out
    assert told.startswith(f"error: unknown {kind[:-1]} 'unobtanium'; ")


@pytest.mark.skipif(not CORPUS.is_dir(), reason="../shared/corpus is not here")
@pytest.mark.parametrize("form", [(), ("--json",)])
def test_every_public_program_is_checked_without_a_crash(
    form: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    for path in sorted(CORPUS.glob("*/*")):
        code = stepnc("check", path, *form)
        out, told = capsys.readouterr()
        assert code in {OK, BAD_INPUT}
        assert "Traceback" not in told
        assert bool(out) or told.startswith("error: ")


def test_help_answers_without_what_is_slow() -> None:
    code = (
        "import sys\n"
        "from service.cli.main import optimise_main\n"
        "try: optimise_main(['--help'])\n"
        "finally: print(sorted({'numpy', 'cvxpy', 'plotly', 'lxml'} & set(sys.modules)))"
    )
    answer = subprocess.run(
        command(code), capture_output=True, text=True, timeout=SECONDS, check=True
    )
    assert "--dry-run" in answer.stdout
    assert answer.stdout.endswith("[]\n")


@pytest.mark.parametrize(
    "arguments", [("materials",), ("optimise", str(PAPER), "--dry-run", "--json")]
)
def test_a_reader_who_leaves_is_not_told_off(arguments: tuple[str, ...]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    answer = subprocess.run(
        command(STEPNC, *arguments),
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    os.close(writing)
    assert answer.returncode == OK
    assert "Traceback" not in answer.stderr
    assert "Broken pipe" not in answer.stderr


def test_an_interrupt_while_it_works_writes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "long.stpnc"
    path.write_text(long_program(), encoding="ascii")
    with subprocess.Popen(
        command(OPTIMISE, path), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as running:
        assert running.stderr is not None
        assert running.stderr.readline().startswith("material: ")
        running.send_signal(signal.SIGINT)
        out, told = running.communicate(timeout=SECONDS)
    assert running.returncode == INTERRUPTED
    assert told == "interrupted\n"
    assert not out
    assert [each.name for each in tmp_path.iterdir()] == ["long.stpnc"]


def long_program(steps: int = 5_000) -> str:
    """The paper's program with its workingstep many times over."""
    ids = range(1_000, 1_000 + steps)
    lines = [f"#{each}=MACHINING_WORKINGSTEP('{each}',#22,#30,#40,$);" for each in ids]
    elements = ",".join(f"#{each}" for each in ids)
    text = PAPER.read_text(encoding="ascii").replace("(#3),$,#20", f"({elements}),$,#20")
    return text.replace("ENDSEC;\nEND-ISO", "\n".join([*lines, "ENDSEC;", "END-ISO"]))


def test_a_pipe_has_no_colours_whatever_no_color_says(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for wish in ("", "1"):
        monkeypatch.setenv("NO_COLOR", wish)
        assert stepnc("check", PARTS / "bracket.stpnc") == OK
        assert "\x1b" not in capsys.readouterr().out


def test_a_fault_of_something_else_is_not_told_as_one_of_stdout(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A network that is away has no reason and no file."""

    def work(error: OSError, _: argparse.Namespace) -> int:
        raise error

    for error, said in (
        (TimeoutError(), "error: TimeoutError\n"),
        (
            PermissionError(13, "Permission denied", "a.txt"),
            "error: a.txt: Permission denied\n",
        ),
    ):
        options = argparse.Namespace(command="check", work=partial(work, error))
        assert commands._run(options) == BAD_INPUT
        assert capsys.readouterr().err == said
