"""Result of ``kbe add``: how many outcomes were new."""

from dataclasses import dataclass

from service.knowledge.verbs import RecordCount
from service.verbs.result import DoneResult


@dataclass(frozen=True, slots=True, kw_only=True)
class AddResult(DoneResult):
    """Outcomes that were added."""

    added: int
    """Number of those that were not recorded before."""
    outcomes: int

    @property
    def said(self) -> str:
        """Number of new outcomes, in words."""
        return f"added: {RecordCount(new=self.added, total=self.outcomes)}"
