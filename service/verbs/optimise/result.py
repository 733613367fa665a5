"""Common base of the results of ``optimise``, and its exit codes."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import orjson

from service.files import write_atomically, write_lines
from service.storage.results import CURVES, FEEDS, NC_CODE
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
    code: Path | None = None
    """File of NC code that was written; None: none was."""
    control: str | None = None
    """Control of the NC code; None: none was asked for."""
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

    @property
    def name(self) -> str:
        """Name of the program."""
        raise NotImplementedError

    def kept(self, folder: Path) -> dict[str, Any]:
        """Write feeds and curves along the paths, and name the NC code as it is served."""
        if self.along is not None:
            from service.along_path.curves import curves_record  # noqa: PLC0415 (numpy)
            from service.along_path.output import profile_lines  # noqa: PLC0415 (numpy)

            write_lines(folder / FEEDS, profile_lines(self.along))
            curves = orjson.dumps(curves_record(self.along), option=orjson.OPT_SERIALIZE_NUMPY)
            write_atomically(folder / CURVES, curves)
        if self.code is not None:
            self.code.replace(folder / NC_CODE)
        return {
            **self.record(),
            "program": self.name,
            "is_written": self.written is not None,
            "nc_control": self.control,
        }
