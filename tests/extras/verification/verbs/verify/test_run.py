"""The command ``verify`` from end to end."""

from pathlib import Path

import pytest

from benchmarks.verification import BRACKET, offset
from service.cli.main import main
from service.errors import BAD_INPUT, LIMIT_EXCEEDED
from tests.extras.verification.runs import fast_log, program


def test_an_offset_ends_with_the_exit_code_of_limits(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    moved = offset(0.3).make(fast_log(), program())
    path = moved.write(tmp_path / "log.parquet", program())
    options = ["--program", str(BRACKET), "--machine", "vmc15", "--cell-mm", "0.5"]
    with pytest.raises(SystemExit) as ended:
        main(["verify", str(path), *options])
    assert ended.value.code == LIMIT_EXCEEDED
    assert "FINISH POCKET" in capsys.readouterr().out


def test_an_empty_log_is_bad_input(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("", encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["verify", str(path), "--program", str(BRACKET), "--machine", "vmc15"])
    assert ended.value.code == BAD_INPUT
