"""Sources of monitors, as they are typed."""

import pytest

from service.monitor.source import MonitorSource, source_of, sources_of
from stepnc_model.errors import StepNcError
from tests.every_case import every_case


def test_a_source_has_a_machine_and_an_address() -> None:
    url = "http://127.0.0.1:5000/vmc15?a=b"
    assert source_of(f"vmc15={url}") == MonitorSource(name="vmc15", url=url)
    assert source_of(" mill = 192.168.0.7:5000 ").url == "192.168.0.7:5000"


@every_case(
    ("word", "told"),
    [
        ("vmc15", "expected NAME=URL"),
        ("=http://x", "expected NAME=URL"),
        ("vmc15=", "expected NAME=URL"),
        ("vmc15=ftp://x", "expected http://HOST:PORT"),
        ("vmc15=http://x:99999", "vmc15: http://x:99999: Port out of range"),
        ("vmc15=http://me:secret@x", "must not contain a user or password"),
        ("vmc15=me:secret@x:5000", "must not contain a user or password"),
    ],
)
def test_other_words_are_refused(word: str, told: str) -> None:
    with pytest.raises(StepNcError, match=told):
        source_of(word)


def test_a_machine_has_one_agent() -> None:
    assert len(sources_of(["a=http://x", "b=http://x"])) == 2
    with pytest.raises(StepNcError, match="--agent a: this machine has two agents"):
        sources_of(["a=http://x", "a=http://y"])
