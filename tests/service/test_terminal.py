"""What a file says cannot steer a terminal, and closed or narrow streams are no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from service.terminal import clean, tell

PARTS = Path(__file__).parents[2] / "examples" / "parts"
OPTIMISE = Path(sys.executable).with_name("optimise")


def test_control_characters_are_shown_and_not_sent() -> None:
    assert clean("a\x1b[31mred\x07\nb µm") == "a�[31mred�\nb µm"


def test_a_name_with_a_line_feed_makes_no_line_of_its_own(
    capsys: pytest.CaptureFixture[str],
) -> None:
    tell("left out: 'A\nerror: B'")
    assert capsys.readouterr().err == "left out: 'A error: B'\n"


def run(
    *arguments: str, shell: str = "", **environment: str
) -> subprocess.CompletedProcess[str]:
    command = f'"{OPTIMISE}" "$@" {shell}'
    return subprocess.run(
        ["/bin/sh", "-c", command, "sh", *arguments],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | environment,
    )


PAPER002 = (str(PARTS / "paper002.stpnc"), "--machine", "paper002", "--dry-run")


@pytest.mark.parametrize("shell", [">/dev/full", ">&-"])
def test_an_output_that_takes_nothing_is_no_traceback(shell: str) -> None:
    answer = run(*PAPER002, shell=shell)
    assert "Traceback" not in answer.stderr
    assert answer.returncode == (3 if "full" in shell else 0)


def test_a_locale_without_greek_is_no_traceback() -> None:
    answer = run(
        str(PARTS / "paper002.stpnc"), "--dry-run", "--pareto", PYTHONIOENCODING="ascii"
    )
    assert answer.returncode == 0, answer.stderr
    assert "\\xb5m" in answer.stdout
