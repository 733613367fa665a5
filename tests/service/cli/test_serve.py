"""``stepnc serve`` and ``stepnc keys``: what cannot be is refused before anything starts."""

from pathlib import Path

import pytest

from service.cli.main import main
from service.storage import keys
from service.storage.folder import open_data_folder
from service.storage.keys import Role
from tests.every_case import every_case


def run(*words: object) -> object:
    """Exit code of ``stepnc``."""
    with pytest.raises(SystemExit) as stopped:
        main(list(map(str, words)))
    return stopped.value.code


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    monkeypatch.setenv("STEPNC_DATA", str(tmp_path / "data"))


@every_case(
    ("words", "told"),
    [
        (("--port", 70_000), "--port 70000"),
        (("--workers", 0), "--workers 0"),
        (("--jobs", 65), "--jobs 65"),
        (("--upload-mb", 0), "--upload-mb 0"),
        (("--rate", -1), "--rate -1"),
        (("--rate", "nan"), "--rate nan"),
        (("--tls-cert", "x.crt"), "given together"),
        (("--host", "0.0.0.0"), "requires keys"),
        (("--keys",), "requires keys"),
        (("--agent", "vmc15"), "NAME=URL"),
        (("--agent", "vmc15=ftp://x"), "http://HOST:PORT"),
        (("--agent", "x=http://x"), "--agent x=http://x: unknown machine 'x'; known:"),
    ],
)
def test_what_cannot_be_is_refused(
    words: tuple[object, ...], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("serve", *words) not in {0, None}
    assert told in capsys.readouterr().err


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
    assert run("keys", "revoke", key.id) == 0
    assert keys.known(data_folder, word) is None
    assert run("keys", "list") == 0
    assert "revoked" in capsys.readouterr().out
    assert run("keys", "revoke", key.id) not in {0, None}


def test_a_role_that_is_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("keys", "create", "--for", "Anna", "--role", "boss") == 2
    assert "invalid choice" in capsys.readouterr().err
    assert run("keys") == 2
