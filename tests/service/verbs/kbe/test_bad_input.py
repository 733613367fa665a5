"""What the commands ``stepnc kbe …`` refuse, and that nothing is lost by it."""

import shutil
from pathlib import Path

import pytest

from tests.every_case import every_case
from tests.rights import Capability, without
from tests.service.verbs.kbe.test_run import (  # fixtures are found by their names  # noqa: F401
    BAD_INPUT,
    _own_place,
    kbe,
    told,
)

READ = (
    ("list",), ("show", "1"), ("table",), ("review",), ("accept", "1"), ("corrections",),
    ("export", "outcomes", "-o", "x.csv"), ("backup", "copy.db"), ("check",),
)  # fmt: skip


@every_case("words", READ)
def test_a_name_that_is_wrong_makes_no_file(
    words: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert kbe(*words, "--kb", tmp_path / "none.db") == BAD_INPUT
    out, error = told(capsys)
    assert not out
    assert error.splitlines()[-1].startswith(f"error: {tmp_path / 'none.db'}: there is no such")
    assert list(tmp_path.iterdir()) == []


@every_case("words", READ)
def test_a_file_that_is_something_else_says_so(
    words: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    damaged = tmp_path / "part.db"
    damaged.write_bytes(b"ISO-10303-21;\n" * 1000)
    assert kbe(*words, "--kb", damaged) == BAD_INPUT
    out, error = told(capsys)
    assert not out
    assert "damaged, or not a knowledge base" in error
    assert [each.name for each in tmp_path.iterdir()] == ["part.db"]


def test_a_torn_file_fails_its_check(kb: str, capsys: pytest.CaptureFixture[str]) -> None:
    bytes_ = Path(kb).read_bytes()
    half = len(bytes_) // 2 // 4096 * 4096
    Path(kb).write_bytes(bytes_[:half] + b"\xff" * 8192 + bytes_[half + 8192 :])
    assert kbe("check", "--kb", kb) == BAD_INPUT
    assert "damaged" in told(capsys)[1]


def test_an_unknown_correction_is_refused(kb: str, capsys: pytest.CaptureFixture[str]) -> None:
    for verb in ("accept", "withdraw"):
        assert kbe(verb, 7, "--kb", kb, "--by", "A. Smith") == BAD_INPUT
        assert "has no correction 7; list them: stepnc kbe corrections" in told(capsys)[1]


def test_an_address_that_is_none_keeps_its_password(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for place in ("mysql://me:secret@host/db", "postgresql://me:secret@127.0.0.1:1/db"):
        assert kbe("list", "--kb", place) == BAD_INPUT
        out, error = told(capsys)
        assert not out
        assert "secret" not in error


def test_a_folder_that_may_not_be_written_stays_as_it_is(
    tmp_path: Path, shop_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "shut"
    folder.mkdir()
    shutil.copy(shop_file, folder / "kb.db")
    (folder / "kb.db").chmod(0o444)
    folder.chmod(0o555)
    with without(Capability.DAC_OVERRIDE):
        for words in (
            ("review", "--kb", folder / "kb.db"),
            ("restore", folder / "kb.db", "--kb", folder / "new.db"),
            ("backup", folder / "copy.db", "--kb", folder / "kb.db"),
            ("export", "outcomes", "--kb", folder / "kb.db", "-o", folder / "o.parquet"),
            ("export", "outcomes", "--kb", folder / "kb.db", "-o", folder / "o.csv"),
        ):
            assert kbe(*words) == BAD_INPUT, words
            out, error = told(capsys)
            assert not out
            assert error.startswith("error: ")
            assert str(folder) in error
    assert [each.name for each in folder.iterdir()] == ["kb.db"]


def test_times_the_wrong_way_round_are_refused(
    kb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--since", "2026-03-06", "--until", "2026-03-05")
    assert kbe("list", "--kb", kb, *words) == BAD_INPUT
    assert "is not before until" in told(capsys)[1]
