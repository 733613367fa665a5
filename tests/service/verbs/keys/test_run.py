"""``stepnc keys``: keys are created, listed and revoked."""

import json
from pathlib import Path

import pytest

from service.cli.main import main
from service.storage import keys
from service.storage.folder import open_data_folder
from service.storage.keys import Role


def run(*words: object) -> object:
    """Exit code of ``stepnc``."""
    with pytest.raises(SystemExit) as stopped:
        main(list(map(str, words)))
    return stopped.value.code


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STEPNC_DATA", str(tmp_path / "data"))


def test_a_key_is_created_listed_and_revoked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("keys", "create", "--for", "Anna", "--role", "operator") == 0
    out, told = capsys.readouterr()
    word = out.strip()
    assert "not shown again" in told
    data_folder = open_data_folder(tmp_path / "data")
    key = keys.known(data_folder, word)
    assert key is not None
    assert (key.name, key.roles) == ("Anna", frozenset({Role.OPERATOR, Role.VIEWER}))
    assert run("keys", "list") == 0
    shown = capsys.readouterr().out
    assert key.id in shown
    assert "valid" in shown
    assert word.rsplit("_", 1)[1] not in shown
    assert run("keys", "list", "--json") == 0
    [listed] = json.loads(capsys.readouterr().out)["keys"]
    assert (listed["owner"], listed["roles"]) == ("Anna", ["operator", "viewer"])
    assert run("keys", "revoke", key.id) == 0
    assert keys.known(data_folder, word) is None
    assert run("keys", "list") == 0
    assert "revoked" in capsys.readouterr().out
    assert run("keys", "revoke", key.id) not in {0, None}


def test_a_role_that_is_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("keys", "create", "--for", "Anna", "--role", "boss") == 3
    assert "unknown role 'boss'; known: viewer, planner, operator" in capsys.readouterr().err
    assert run("keys") == 2
