"""The commands ``stepnc kbe …``: what a user sees, in SQLite and in PostgreSQL."""

import getpass
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kbe.store import open_store
from service.cli.main import main
from service.knowledge.verbs import record
from stepnc_model.outcome import ProcessOutcome
from tests.kbe.conftest import (  # fixtures are found by their names  # noqa: F401
    UrlMaker,
    new_server,
    postgres_place,
    postgres_url,
)

OK, BAD_INPUT, INTERRUPTED = 0, 3, 130

MINE = ("--machine", "vmc15", "--material", "C45", "--tool", "ENDMILL 18")


@pytest.fixture(autouse=True)
def _own_place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.delenv("STEPNC_KB", raising=False)
    monkeypatch.delenv("COLUMNS", raising=False)


def kbe(*words: object) -> object:
    """Exit code of ``stepnc kbe``."""
    with pytest.raises(SystemExit) as stopped:
        main(["kbe", *map(str, words)])
    return stopped.value.code


def told(capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    """What went to stdout and to stderr."""
    out, error = capsys.readouterr()
    return out, error


def test_a_list_is_newest_first(
    kb: str, shop_outcomes: tuple[ProcessOutcome, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert kbe("list", "--kb", kb, "--limit", 3) == OK
    out, error = told(capsys)
    lines = out.splitlines()
    assert not error
    assert [line.split()[2] for line in lines[2:5]] == [shop_outcomes[-1].run] * 3
    assert shop_outcomes[-1].workingstep in lines[2]
    assert lines[-1].startswith("3 of 1200 outcomes")


def test_the_environment_names_the_place(
    kb: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("STEPNC_KB", kb)
    assert kbe("list", "--json", "--run", "000005") == OK
    assert json.loads(told(capsys)[0])["total"] == 6


def test_a_run_and_a_correction_are_shown(kb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert kbe("show", "000005", "--kb", kb) == OK
    assert told(capsys)[0].count("Ra µm") == 6
    assert kbe("show", "000005", "--kb", kb, "--json") == OK
    assert len(json.loads(told(capsys)[0])["outcomes"]) == 6
    assert kbe("review", "--kb", kb, *MINE) == OK
    assert kbe("show", "1", "--kb", kb, "--json") == OK
    shown = told(capsys)[0]
    assert '"standing": "proposed"' in shown
    assert kbe("show", "2", "--kb", kb) == BAD_INPUT
    assert "no run or correction '2'; list them" in told(capsys)[1]


def test_the_table_is_text_json_and_a_page(
    kb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert kbe("table", "--kb", kb, "--only", "violated", "--sort", "force") == OK
    out, error = told(capsys)
    assert "Geometrical data" in out.splitlines()[0]
    assert "violated" in out
    assert not error
    assert kbe("table", "--kb", kb, "--by", "kind", "--json") == OK
    assert json.loads(told(capsys)[0])["by"] == "kind"
    page = tmp_path / "table.html"
    assert kbe("table", "--kb", kb, "-o", page) == OK
    out, error = told(capsys)
    assert not out
    assert error == f"written: {page}\n"
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_a_narrow_screen_gets_blocks(
    kb: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert kbe("table", "--kb", kb) == OK
    out = told(capsys)[0]
    assert max(map(len, out.splitlines())) <= 100
    assert out.count("Machine_ID") > 1
    assert "\x1b" not in out


def test_a_summary_is_made_by_the_database(kb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert kbe("table", "--kb", kb, "--summary", "--machine", "vmc15") == OK
    assert "planar_face" in told(capsys)[0]
    assert kbe("table", "--kb", kb, "--summary", "--format", "html") == BAD_INPUT
    assert "CSV, JSON, Parquet" in told(capsys)[1]


def walk(place: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Review, accept, withdraw; as a user does it."""
    assert kbe("review", "--kb", place, *MINE) == OK
    out, error = told(capsys)
    assert out.startswith("1  vmc15 / C45 / ENDMILL 18: proposed\n")
    assert not error
    assert kbe("review", "--kb", place, *MINE, "--json") == OK
    [again] = json.loads(told(capsys)[0])["contexts"]
    assert (again["change"], again["correction"]["id"]) == ("unchanged", 1)
    assert kbe("accept", 1, "--kb", place, "--by", "A. Smith") == OK
    out, error = told(capsys)
    assert "in force" in out
    assert "A. Smith" in out
    assert not error
    assert kbe("withdraw", 1, "--kb", place) == OK
    out, error = told(capsys)
    assert "withdrawn" in out
    by = getpass.getuser()
    told_text = f"decision recorded for login '{by}'; use --by NAME for another person\n"
    assert error == told_text
    assert kbe("corrections", "--kb", place, "--json") == OK
    [entry] = json.loads(told(capsys)[0])["corrections"]
    assert (entry["standing"], entry["decided_by"]) == ("withdrawn", getpass.getuser())


def test_the_walk_of_a_review(kb: str, capsys: pytest.CaptureFixture[str]) -> None:
    walk(kb, capsys)


def test_the_walk_of_a_review_in_postgresql(
    postgres_place: UrlMaker,  # noqa: F811
    shop_outcomes: tuple[ProcessOutcome, ...],
    capsys: pytest.CaptureFixture[str],
) -> None:
    place = postgres_place()
    record(place, shop_outcomes[:300])
    walk(place, capsys)


def test_postgresql_shows_and_exports_what_sqlite_does(
    postgres_place: UrlMaker,  # noqa: F811
    kb: str,
    shop_outcomes: tuple[ProcessOutcome, ...],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    place = postgres_place()
    record(place, shop_outcomes)
    shown = []
    for each, name in ((kb, "one"), (place, "other")):
        assert kbe("list", "--kb", each, "--limit", 20) == OK
        assert kbe("table", "--kb", each, "--format", "csv") == OK
        shown.append(told(capsys)[0])
        file = tmp_path / f"{name}.parquet"
        assert kbe("export", "outcomes", "--kb", each, "-o", file) == OK
        told(capsys)
    one, other = shown
    assert [line.split(",")[:20] for line in one.splitlines()] == [
        line.split(",")[:20] for line in other.splitlines()
    ]
    assert pq.read_table(tmp_path / "one.parquet") == pq.read_table(tmp_path / "other.parquet")


def test_a_store_moves_from_sqlite_to_postgresql(
    postgres_place: UrlMaker,  # noqa: F811
    kb: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    copy, place = tmp_path / "copy.db", postgres_place()
    assert kbe("backup", copy, "--kb", kb, "--json") == OK
    assert kbe("restore", copy, "--kb", place, "--json") == OK
    assert kbe("check", "--kb", place, "--json") == OK
    made, filled, checked = (
        json.loads(each + "}") for each in told(capsys)[0].split("}\n")[:3]
    )
    assert made["fingerprint"] == filled["fingerprint"] == checked["fingerprint"]
    assert checked["outcomes"] == 1200


def test_automatic_acceptance_keeps_its_bounds(
    kb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    strict = ("--auto-accept", "--least-confidence", "99.9%", "--by", "A. Smith")
    assert kbe("review", "--kb", kb, *MINE, *strict) == OK
    assert "needs a person's decision: confidence" in told(capsys)[0]
    usual = ("--auto-accept", "--greatest-change", "25%", "--by", "A. Smith")
    assert kbe("review", "--kb", kb, *MINE, *usual, "--json") == OK
    [found] = json.loads(told(capsys)[0])["contexts"]
    assert found["change"] == "accepted"
    assert found["correction"]["decided_by"] == "A. Smith (automatically)"


@pytest.mark.parametrize("what", ["outcomes", "corrections", "table"])
@pytest.mark.parametrize("suffix", ["csv", "json", "parquet"])
def test_everything_is_exported_in_every_format(
    what: str, suffix: str, kb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / f"{what}.{suffix}"
    assert kbe("export", what, "--kb", kb, "--run", "000005", "-o", file) == OK
    out, error = told(capsys)
    assert not out
    assert f"written: {file}" in error
    assert file.stat().st_size > 0


def test_only_the_table_is_a_page(
    kb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "page.html"
    assert kbe("export", "table", "--kb", kb, "-o", file) == OK
    assert kbe("export", "outcomes", "--kb", kb, "-o", file) == BAD_INPUT
    assert "outcomes and corrections cannot be written as html" in told(capsys)[1]


@pytest.mark.parametrize("verb", [("table",), ("export", "outcomes")])
def test_an_ending_that_says_nothing_is_asked_about(
    verb: tuple[str, ...], kb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file.xlsx"
    assert kbe(*verb, "--kb", kb, "-o", file) == BAD_INPUT
    assert "end the name with .csv, .json, .html, .parquet, .txt, or name" in told(capsys)[1]
    assert not file.exists()
    assert kbe(*verb, "--kb", kb, "-o", file, "--format", "csv") == OK
    assert file.read_text(encoding="utf-8").startswith("machine,")


def test_a_table_of_nothing_is_a_file_all_the_same(
    kb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for suffix in ("txt", "csv", "json", "html", "parquet"):
        file = tmp_path / f"table.{suffix}"
        assert kbe("table", "--kb", kb, "--machine", "lathe", "-o", file) == OK
        assert "no outcome matches the selection" in told(capsys)[1]
        assert file.stat().st_size > 0


def test_who_has_no_login_is_asked_for_a_name(
    kb: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("LOGNAME", "USER", "LNAME", "USERNAME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os, "getuid", lambda: 4_000_000)
    assert kbe("accept", 1, "--kb", kb) == BAD_INPUT
    assert "give the name of the person who decides with --by NAME" in told(capsys)[1]


def test_an_export_that_is_asked_to_end_leaves_what_was_there(
    kb: str, tmp_path: Path, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    for number in range(1, 11):
        record(kb, [replace(each, sequence=number) for each in shop_outcomes])
    file = tmp_path / "outcomes.json"
    file.write_text("before", encoding="ascii")
    code = (
        "import os, signal\n"
        "from service.verbs.kbe.export import run as export\n"
        "from service.cli.main import main\n"
        "rows = export.file_rows\n"
        "def asked(columns, outcomes):\n"
        "    for number, row in enumerate(rows(columns, outcomes)):\n"
        "        if number == 5000: os.kill(os.getpid(), signal.SIGTERM)\n"
        "        yield row\n"
        "export.file_rows = asked\n"
        "main()"
    )
    words = ("kbe", "export", "outcomes", "--kb", kb, "-o", str(file))
    answer = subprocess.run(
        [sys.executable, "-c", code, *words],
        capture_output=True, text=True, timeout=120.0, check=False,
    )  # fmt: skip
    assert (answer.returncode, answer.stderr) == (INTERRUPTED, "interrupted\n")
    assert file.read_text(encoding="ascii") == "before"
    assert sorted(each.name for each in tmp_path.iterdir() if each.suffix == ".json") == [
        "outcomes.json"
    ]


@pytest.mark.parametrize(
    "words",
    [("list",), ("table",), ("table", "--summary"), ("review",), ("corrections",)],
)
def test_an_empty_knowledge_base_is_helpful(
    words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    open_store(str(tmp_path / "empty.db")).close()
    for place in ((), ("--kb", tmp_path / "empty.db")):
        assert kbe(*words, *place) == OK
        out, error = told(capsys)
        assert not out
        assert "yet; `stepnc " in error
    assert not (tmp_path / "data").exists()
    json_words = (*words, "--json")
    assert kbe(*json_words) == OK
    assert json.loads(told(capsys)[0])


def test_filters_that_leave_nothing_say_what_there_is(
    kb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert kbe("list", "--kb", kb, "--machine", "lathe") == OK
    out, error = told(capsys)
    assert not out
    assert "machines hmc8, vmc15, vmc22; materials AlMgSi1, C45; tools DRILL 8.5" in error
