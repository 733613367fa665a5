"""``stepnc serve``: what cannot be is refused before anything starts."""

from pathlib import Path

import pytest

from service.cli.main import main
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
        (("--port", 70_000), "port 70000"),
        (("--workers", 0), "workers 0"),
        (("--jobs", 65), "jobs 65"),
        (("--upload-mb", 0), "upload 0 MB"),
        (("--rate", -1), "rate -1"),
        (("--rate", "nan"), "rate nan"),
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
