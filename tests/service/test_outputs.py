"""Outputs keep off each other's places, and traps in a program end soon."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from service.cli.main import main, optimise_main

PARTS = Path(__file__).parents[2] / "examples" / "parts"


@dataclass(frozen=True, slots=True)
class Answer:
    """What a command did."""

    code: object
    error: str


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Callable[..., Answer]:
    """Run a command in this process."""

    def run(command: Callable[[Sequence[str]], None], *arguments: str) -> Answer:
        with pytest.raises(SystemExit) as stopped:
            command(arguments)
        told = capsys.readouterr().err
        assert "Traceback" not in told
        return Answer(stopped.value.code, told)

    return run


Call = Callable[..., Answer]


class TestPlacesOfOutputs:
    """No output takes the place of another file."""

    def test_a_report_over_the_input_is_refused(self, tmp_path: Path, call: Call) -> None:
        part = tmp_path / "part.stpnc"
        part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
        before = part.read_bytes()
        answer = call(optimise_main, str(part), "--machine", "paper002", "--report", str(part))
        assert answer.code == 3
        assert "name another file" in answer.error
        assert part.read_bytes() == before
        assert list(tmp_path.iterdir()) == [part]

    def test_a_report_in_no_folder_stops_before_anything_is_written(
        self, tmp_path: Path, call: Call
    ) -> None:
        output, report = tmp_path / "out.stpnc", tmp_path / "no" / "r.html"
        part = str(PARTS / "paper002.stpnc")
        answer = call(
            optimise_main, part, "--machine", "paper002",
            "-o", str(output), "--report", str(report),
        )  # fmt: skip
        assert answer.code == 3
        assert "the folder does not exist" in answer.error
        assert list(tmp_path.iterdir()) == []

    def test_what_is_no_regular_file_is_not_replaced(self, tmp_path: Path, call: Call) -> None:
        pipe = tmp_path / "pipe"
        os.mkfifo(pipe)
        part = str(PARTS / "paper002.stpnc")
        answer = call(optimise_main, part, "--machine", "paper002", "-o", str(pipe))
        assert answer.code == 3
        assert "is not a regular file" in answer.error
        assert pipe.is_fifo()

    def test_in_place_through_a_link_changes_its_target(
        self, tmp_path: Path, call: Call
    ) -> None:
        target, link = tmp_path / "target.stpnc", tmp_path / "link.stpnc"
        target.write_bytes((PARTS / "paper002.stpnc").read_bytes())
        link.symlink_to(target)
        answer = call(optimise_main, str(link), "--machine", "paper002", "--in-place")
        assert answer.code == 0
        assert link.is_symlink()
        assert b"optimisation:mode:" in target.read_bytes()

    def test_names_that_no_system_takes_are_refused(self, tmp_path: Path, call: Call) -> None:
        part = str(PARTS / "paper002.stpnc")
        long = str(tmp_path / ("x" * 300))
        for arguments in ((part, "-o", long), ("\0.stpnc",)):
            answer = call(optimise_main, *arguments, "--machine", "paper002")
            assert answer.code == 3
        assert call(optimise_main, part, "-o", "", "--machine", "paper002").code == 2


def test_workplans_that_name_each_other_twice_end_soon(tmp_path: Path, call: Call) -> None:
    levels = 40
    plans = "\n".join(
        f"#{1000 + n}=WORKPLAN('x',(#{1001 + n},#{1001 + n}),$,$,$);" for n in range(levels)
    )
    data = (PARTS / "paper002.stpnc").read_text(encoding="utf-8")
    data = data.replace("(#3),$,#20,$", "(#1000),$,#20,$")
    last = f"\n#{1000 + levels}=WORKPLAN('x',(#3),$,$,$);"
    part = tmp_path / "part.stpnc"
    part.write_text(data.replace("\n#10=", f"\n{plans}{last}\n#10=", 1), encoding="utf-8")
    answer = call(optimise_main, str(part), "--dry-run")
    assert answer.code == 3
    assert "more than 100000 executables" in answer.error


@pytest.mark.parametrize("seconds", ["nan", "-5", "inf"])
def test_a_tool_change_that_takes_no_time_is_refused(seconds: str, call: Call) -> None:
    part = str(PARTS / "paper002.stpnc")
    answer = call(optimise_main, part, "--dry-run", f"--tool-change-s={seconds}")
    assert answer.code == 3
    assert "tool change" in answer.error


def test_every_machine_is_valid_json(call: Call) -> None:
    for name in ("paper002", "paper003", "vmc15", "lathe22"):
        assert call(main, "machines", name, "--json").code == 0
