"""Where the knowledge base is."""

from pathlib import Path

import pytest

from service.knowledge.place import (
    VARIABLE,
    is_usual,
    make_folder,
    named_place,
    require_apart,
    usual_file,
    usual_place,
)
from stepnc_model.errors import StepNcError, WriteError
from tests.every_case import every_case


@pytest.fixture(autouse=True)
def _nothing_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


def test_the_option_goes_before_the_environment_and_that_before_the_usual_file(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    usual = str(tmp_path / "data" / "stepnc" / "knowledge.db")
    assert named_place("") is None
    assert usual_place("") == usual
    monkeypatch.setenv(VARIABLE, "shop.db")
    assert named_place("") == usual_place("") == "shop.db"
    assert named_place("mine.db") == usual_place("mine.db") == "mine.db"
    monkeypatch.setenv(VARIABLE, "")
    assert named_place("") is None


@pytest.mark.parametrize("folder", ["", "relative/folder"])
def test_without_an_absolute_data_folder_it_is_below_the_home(
    folder: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", folder)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert usual_file() == tmp_path / ".local" / "share" / "stepnc" / "knowledge.db"


def test_only_the_folder_of_the_usual_file_is_made(tmp_path: Path) -> None:
    usual = usual_place("")
    assert is_usual(usual)
    make_folder(usual)
    make_folder(usual)
    assert Path(usual).parent.is_dir()
    named = tmp_path / "typing mistake" / "shop.db"
    assert not is_usual(str(named))
    make_folder(str(named))
    assert not named.parent.exists()


def test_a_folder_that_cannot_be_made_says_so(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file in the way", encoding="ascii")
    with pytest.raises(WriteError, match="name another file with --kb"):
        make_folder(usual_place(""))


def test_who_has_no_home_is_asked_for_a_place(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("no home")

    monkeypatch.delenv("XDG_DATA_HOME")
    monkeypatch.setattr(Path, "home", homeless)
    with pytest.raises(StepNcError, match="--kb FILE"):
        usual_place("")
    assert not is_usual("shop.db")


@every_case("ending", ["", "-wal", "-shm"])
@every_case("prefix", ["", "sqlite:///"])
def test_no_output_may_be_the_knowledge_base(tmp_path: Path, prefix: str, ending: str) -> None:
    place = tmp_path / "kb.db"
    output = tmp_path / f"kb.db{ending}"
    output.write_bytes(b"kept")
    with pytest.raises(WriteError, match="is the knowledge base"):
        require_apart(f"{prefix}{place}", None, output)
    assert output.read_bytes() == b"kept"
    require_apart(f"{prefix}{place}", tmp_path / "other.db", None)
    require_apart(None, output)
    require_apart("postgresql://host/kb.db", output)
