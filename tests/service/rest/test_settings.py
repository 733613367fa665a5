"""What the service is told goes from process to process."""

import json

import pytest

from service.errors import Unavailable
from service.monitor.source import MonitorSource
from service.rest.settings import VARIABLE, Settings, handed_on


@pytest.fixture(autouse=True)
def _own_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "{}")


def test_what_is_handed_on_arrives() -> None:
    told = Settings(
        data="/srv/ü", host="0.0.0.0", port=1, names=("a", "b"), needs_keys=True, rate=2.5,
        agents=(MonitorSource(name="vmc15", url="http://127.0.0.1:5000/vmc15"),),
    )  # fmt: skip
    told.hand_on()
    assert handed_on() == told


def test_settings_of_another_version_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, json.dumps({"data": "x", "of_tomorrow": 1}))
    assert handed_on() == Settings(data="x")


def test_a_process_that_nobody_started_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE)
    with pytest.raises(Unavailable, match="stepnc serve"):
        handed_on()


def test_loopback_is_known_by_its_names() -> None:
    assert Settings(data="x").is_loopback
    assert Settings(data="x", host="::1").is_loopback
    assert not Settings(data="x", host="0.0.0.0").is_loopback
    assert str(Settings(data="x/y").root) == "x/y"
