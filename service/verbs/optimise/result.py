"""What all results of ``optimise`` have in common, and its exit codes."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from service.verbs.result import Result

if TYPE_CHECKING:
    from service.along_path.run import FeedsAlongPath


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimiseResult(Result):
    """Base of the results of ``optimise``."""

    written: Path | None = None
    """File of the advised program; None when nothing was written."""
    along: "FeedsAlongPath | None" = None
    """Feeds along the paths; None if they were not requested."""
    is_advised: bool = True
    """Whether there is advice that is written, or would be without a dry run."""

    @property
    def time_before(self) -> float:
        """Time of the program as given, s."""
        raise NotImplementedError

    @property
    def time_after(self) -> float:
        """Time of the advised program, s."""
        raise NotImplementedError
