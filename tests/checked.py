"""Contents of a STEP-NC program, as ``check`` returns them."""

from pathlib import Path

import stepnc
from service.verbs.check.result import ProgramContents


def check(path: Path, **words: object) -> ProgramContents:
    """Check a STEP-NC program; words as of :func:`stepnc.check`."""
    found = stepnc.check(path, **words)  # type: ignore[arg-type]
    assert isinstance(found, ProgramContents)
    return found
