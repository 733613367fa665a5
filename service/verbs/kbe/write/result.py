"""Result of ``kbe write``: what was written into the program."""

from dataclasses import dataclass
from pathlib import Path

from service.verbs.result import DoneResult


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteResult(DoneResult):
    """Numbers of outcomes and corrections written to a file."""

    written: Path
    run: str
    outcomes: int
    corrections: int

    @property
    def said(self) -> str:
        """Summary in one line."""
        return (
            f"written: {self.written} (outcomes {self.outcomes}, corrections "
            f"{self.corrections}, run {self.run})"
        )
