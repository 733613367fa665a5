"""Result of ``keys create``: the key, which is not stored and not shown again."""

from dataclasses import dataclass

from service.rendering.view import Fact, ResultView, TextLine
from service.verbs.result import Result


@dataclass(frozen=True, slots=True, kw_only=True)
class NewKeyResult(Result):
    """A new key."""

    key: str

    def view(self) -> ResultView:
        """Return the key."""
        return ResultView([Fact(key="key", value=self.key), TextLine(text=self.key)])
