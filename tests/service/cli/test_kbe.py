"""The options of ``stepnc kbe``: what is asked wrongly, and what starting costs."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from kbe.evaluation import RowFilter, SortKey
from service.cli.kbe import ONLY, SORT
from service.cli.main import main
from tests.every_case import every_case

OK, USAGE, BAD_INPUT = 0, 2, 3
SECONDS = 30.0

VERBS = (
    "list", "show", "table", "review", "accept", "withdraw", "corrections", "export",
    "backup", "restore", "check",
)  # fmt: skip


def kbe(*words: object) -> object:
    """Exit code of ``stepnc kbe``."""
    with pytest.raises(SystemExit) as stopped:
        main(["kbe", *map(str, words)])
    return stopped.value.code


def test_the_words_of_options_are_those_of_the_evaluation() -> None:
    assert {each.replace("-", " ") for each in ONLY} == set(RowFilter)
    assert {each.replace("-", " ") for each in SORT} == set(SortKey)


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
    "words",
    [
        ("lst",),
        ("list", "--colour", "red"),
        ("list", "--limit", "-1"),
        ("list", "--limit", "many"),
        ("list", "--since", "yesterday"),
        ("list", "--until", "2026-02-30"),
        ("list", "--machine", "\udcff"),
        ("table", "--only", "good"),
        ("table", "--sort", "colour"),
        ("table", "--by", "tool"),
        ("table", "--format", "pdf"),
        ("table", "--format", "csv", "--json"),
        ("review", "--least-confidence", "2"),
        ("review", "--greatest-change", "nan"),
        ("review", "--fewest-outcomes", "1.5"),
        ("accept",),
        ("accept", "first"),
        ("export", "everything", "-o", "x.csv"),
        ("export", "outcomes"),
        ("backup",),
        ("show",),
    ],
)
def test_what_is_asked_wrongly_is_exit_code_2(
    words: tuple[str, ...], kb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert kbe(*words, "--kb", kb) == USAGE
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
