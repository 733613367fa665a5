"""What an extra declares is found by the name of its file, without an import in the core."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import extras
from service import extra_parts
from service.extra_parts import declared
from service.verbs import call


@pytest.fixture
def say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An extra of its own, beside none."""
    for file, text in {
        "say/jobs.py": 'WORK = (("say", "extras.say.job:run"),)\n',
        "say/verbs/shout/request.py": "REQUEST = FILES = int\n",
        "hear/__init__.py": "",
    }.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(text, encoding="utf-8")
    monkeypatch.setattr(extras, "__path__", [str(tmp_path)])
    monkeypatch.setattr(extra_parts, "EXTRAS", tmp_path)
    monkeypatch.setattr(call, "EXTRAS", tmp_path)
    call.verbs.cache_clear()
    yield
    call.verbs.cache_clear()
    for name in [each for each in sys.modules if each.startswith("extras.say")]:
        del sys.modules[name]


@pytest.mark.usefixtures("say")
def test_what_an_extra_declares_is_found() -> None:
    assert list(declared("jobs", "WORK")) == [("say", "extras.say.job:run")]
    assert list(declared("jobs", "STORED")) == list(declared("rest", "ROUTES")) == []


@pytest.mark.usefixtures("say")
def test_a_verb_of_an_extra_is_found_beside_those_of_the_core() -> None:
    found = call.verbs()
    assert list(found) == sorted(found)
    assert found["shout"].module("run") == "extras.say.verbs.shout.run"
    assert found["optimise"].module("run") == "service.verbs.optimise.run"
