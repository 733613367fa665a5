"""The options of ``stepnc kbe``: what is asked wrongly, and what starting costs."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from service.cli.main import main
from tests.every_case import every_case

OK, USAGE, BAD_INPUT = 0, 2, 3
SECONDS = 30.0

VERBS = (
    "list", "show", "table", "review", "accept", "withdraw", "corrections", "export",
    "backup", "restore", "check", "add", "write",
)  # fmt: skip


def kbe(*words: object) -> object:
    """Exit code of ``stepnc kbe``."""
    with pytest.raises(SystemExit) as stopped:
        main(["kbe", *map(str, words)])
    return stopped.value.code


def test_without_a_verb_help_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert kbe() == USAGE
    out = capsys.readouterr().out
    assert "examples:" in out
    for verb in VERBS:
        assert re.search(rf"^    {verb}\b", out, re.MULTILINE)


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert kbe(verb, "--help") == OK
    assert "--kb PLACE" in capsys.readouterr().out


@every_case(
    ("code", "words"),
    [
        (USAGE, ("lst",)),
        (USAGE, ("list", "--colour", "red")),
        (BAD_INPUT, ("list", "--limit", "-1")),
        (USAGE, ("list", "--limit", "many")),
        (BAD_INPUT, ("list", "--since", "yesterday")),
        (BAD_INPUT, ("list", "--until", "2026-02-30")),
        (USAGE, ("list", "--machine", "\udcff")),
        (BAD_INPUT, ("table", "--only", "good")),
        (BAD_INPUT, ("table", "--sort", "colour")),
        (BAD_INPUT, ("table", "--by", "tool")),
        (BAD_INPUT, ("table", "--format", "pdf")),
        (BAD_INPUT, ("table", "--format", "csv", "--json")),
        (BAD_INPUT, ("review", "--least-confidence", "2")),
        (BAD_INPUT, ("review", "--greatest-change", "nan")),
        (USAGE, ("review", "--fewest-outcomes", "1.5")),
        (USAGE, ("accept",)),
        (USAGE, ("accept", "first")),
        (BAD_INPUT, ("accept", "0")),
        (BAD_INPUT, ("withdraw", "1", "99999999999999999999")),
        (BAD_INPUT, ("export", "everything", "-o", "x.csv")),
        (USAGE, ("export", "outcomes")),
        (USAGE, ("backup",)),
        (USAGE, ("show",)),
    ],
)
def test_what_is_asked_wrongly_is_refused(
    code: int, words: tuple[str, ...], kb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert kbe(*words, "--kb", kb) == code
    out, told = capsys.readouterr()
    assert not out
    assert "error: " in told
    assert "Traceback" not in told


def test_help_answers_without_the_database() -> None:
    code = (
        "import sys\n"
        "from service.cli.main import main\n"
        "try: main(sys.argv[1:])\n"
        "except SystemExit: pass\n"
        "slow = {'sqlalchemy', 'alembic', 'numpy', 'plotly', 'pyarrow', 'scipy'}\n"
        "print(sorted(slow & set(sys.modules)))"
    )
    for words, loaded in (
        (("--help",), "[]"),
        (("kbe", "--help"), "[]"),
        (("kbe", "table", "--help"), "[]"),
    ):
        answer = subprocess.run(
            [sys.executable, "-c", code, *words],
            capture_output=True, text=True, timeout=SECONDS, check=True,
        )  # fmt: skip
        assert answer.stdout.endswith(f"{loaded}\n")


def test_a_listing_loads_no_mathematics(shop_file: Path) -> None:
    code = (
        "import sys\n"
        "from service.cli.main import main\n"
        "try: main(sys.argv[1:])\n"
        "except SystemExit as stop: print(stop.code)\n"
        "slow = {'alembic', 'numpy', 'plotly', 'pyarrow', 'scipy'}\n"
        "print(sorted(slow & set(sys.modules)))"
    )
    words = ("kbe", "list", "--limit", "1", "--kb", str(shop_file))
    answer = subprocess.run(
        [sys.executable, "-c", code, *words],
        capture_output=True, text=True, timeout=SECONDS, check=True,
    )  # fmt: skip
    assert answer.stdout.endswith("0\n[]\n")
