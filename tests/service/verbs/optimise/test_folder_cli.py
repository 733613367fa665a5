"""``optimise FOLDER`` as typed."""

import json
import shutil
from pathlib import Path

import pytest

from service.cli.main import optimise_main

PAPER = Path(__file__).parents[4] / "examples" / "parts" / "paper002.stpnc"


def optimise(*words: object) -> int:
    with pytest.raises(SystemExit) as end:
        optimise_main([str(each) for each in words])
    return int(end.value.code or 0)


def test_a_folder_has_a_row_for_each_program(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, output = tmp_path / "in", tmp_path / "out"
    folder.mkdir()
    shutil.copy(PAPER, folder)
    assert optimise(folder, "-o", output) == 0
    shown = capsys.readouterr().out.splitlines()
    assert shown[2].split()[:4] == ["paper002.stpnc", "advised", "1", "1"]
    (folder / "bad.stp").touch()
    assert optimise(folder, "-o", output, "--json") == 3
    found = json.loads(capsys.readouterr().out)
    assert [row["status"] for row in found["programs"]] == ["bad input", "advised"]
    assert found["made"] == 1
    assert found["programs"][1]["time_after_s"] < found["programs"][1]["time_before_s"]


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ((), "is a folder: name another folder with -o"),
        (("-o", "out", "--in-place"), "without --in-place"),
        (("-o", "out", "--nc", "linuxcnc"), "--nc and --workingstep are for one program"),
        (("-o", "out", "--cluster", "tcp://10.0.0.1:8786"), "only tls:// is taken"),
    ],
)
def test_options_that_a_folder_does_not_take_are_refused(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    problem: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "in"
    folder.mkdir()
    shutil.copy(PAPER, folder)
    assert optimise(folder, *options) == 3
    assert problem in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_single_program_takes_no_cluster(capsys: pytest.CaptureFixture[str]) -> None:
    assert optimise(PAPER, "--cluster", "tcp://127.0.0.1:1", "--dry-run") == 3
    assert "--cluster runs the programs of a folder" in capsys.readouterr().err
