"""Result of ``kbe backup``, ``restore`` and ``check``: what a knowledge base holds."""

from dataclasses import asdict, dataclass

from kbe.backup import Content
from service.rendering.view import Fact, ResultView, TextLine
from service.verbs.result import Result
from stepnc_model.plurals import counted


@dataclass(frozen=True, slots=True, kw_only=True)
class ContentResult(Result):
    """Numbers of entries in a knowledge base, and its fingerprint."""

    place: str
    """Location for display."""
    content: Content

    def view(self) -> ResultView:
        """Return two lines."""
        found = self.content
        return ResultView([
            Fact(key="place", value=self.place),
            *(Fact(key=key, value=value) for key, value in asdict(found).items()),
            TextLine(
                text=f"{self.place}: {counted(found.outcomes, 'outcome')}, "
                f"{counted(found.corrections, 'correction')}, "
                f"{counted(found.decisions, 'decision')}"
            ),
            TextLine(text=f"fingerprint {found.fingerprint}"),
        ])
