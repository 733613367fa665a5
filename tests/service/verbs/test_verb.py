"""A verb is a folder: nothing else is touched to add one."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from service import verbs as package
from service.cli.main import main
from service.verbs.call import Verb, verbs

FOLDER = {
    "__init__.py": '"""Say a word, often.\n\nIt is said to nobody."""\n',
    "request.py": """
from dataclasses import dataclass
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated
from annotated_types import Interval
from service.requests.fields import About, FileUse, Request

@dataclass(frozen=True, slots=True, kw_only=True)
class SayRequest(Request):
    times: Annotated[int, Interval(ge=1, le=9), About("how often", flag="--times")] = 2

@dataclass(frozen=True, slots=True, kw_only=True)
class SayFiles(Request):
    word: Annotated[Path, About("the word", use=FileUse.INPUT, metavar="WORD")]

REQUEST, FILES = SayRequest, SayFiles
""",
    "run.py": """
from service.verbs.say.result import SayResult

def run(request, files, *, tell) -> SayResult:
    tell("thinking")
    return SayResult(words=[files.word.name] * request.times)
""",
    "result.py": """
from dataclasses import dataclass
from service.rendering.view import Fact, ResultView, TextLine
from service.verbs.result import Result

@dataclass(frozen=True, slots=True, kw_only=True)
class SayResult(Result):
    words: list[str]

    def view(self):
        return ResultView([
            Fact(key="words", value=self.words), TextLine(text=" ".join(self.words)),
        ])
""",
}


@pytest.fixture
def say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Verb]:
    """A verb in a folder of its own, beside those of the product."""
    folder = tmp_path / "say"
    folder.mkdir()
    for name, text in FOLDER.items():
        (folder / name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
    found = {**verbs(), "say": Verb(folder="say")}
    monkeypatch.setattr("service.cli.commands.verbs", lambda: found)
    yield Verb(folder="say")
    for name in [each for each in sys.modules if each.startswith("service.verbs.say")]:
        del sys.modules[name]


@pytest.mark.usefixtures("say")
def test_a_folder_is_a_command_with_help_bounds_text_and_json(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for words, code in (
        (["say", "hello"], 0),
        (["say", "hello", "--times", "1", "--json"], 0),
        (["say", "hello", "--times", "10"], 3),
        (["say", "--help"], 0),
    ):
        with pytest.raises(SystemExit) as end:
            main(words)
        assert end.value.code == code
    out, told = capsys.readouterr()
    assert out.startswith(
        'hello hello\n{\n  "words": [\n    "hello"\n  ]\n}\nusage: stepnc say'
    )
    assert "It is said to nobody." in out
    assert "how often (default: 2)" in out
    assert "times 10: it must be 1 to 9" in told


def test_names_of_two_words_have_their_group() -> None:
    review = verbs()["kbe.review"]
    assert (review.name, review.function, review.group) == ("kbe review", "kbe_review", "kbe")
    assert verbs()["cycletime"].name == "cycletime"
    assert list(verbs()) == sorted(verbs())
