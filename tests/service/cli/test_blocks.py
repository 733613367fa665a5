"""Commands on block rate and cycle time, as typed."""

from pathlib import Path

import pytest

from service.cli.main import main


def run(*words: object) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return int(ended.value.code or 0)


def test_blocktest_writes_nc_code(tmp_path: Path) -> None:
    output = tmp_path / "test.ngc"
    code = run("blocktest", "--machine", "vmc15", "-o", output, "--unit", "mm",
               "--spacing", "0.05,0.1", "--radius", "20", "--lines", "50")  # fmt: skip
    assert code == 0
    assert output.read_text().count("G4 P1") == 4


def test_bad_numbers_end_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = run("blocktest", "--machine", "vmc15", "-o", tmp_path / "a.ngc", "--spacing", "x")
    assert code == 3
    assert "spacing 'x': expected a number" in capsys.readouterr().err
