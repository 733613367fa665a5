"""The files of a run while it runs, as they are named in its job's folder."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from service.live.storage import storing


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveFolder:
    """Where a run tells, and is told."""

    path: Path

    @property
    def series(self) -> Path:
        """Rows, see :mod:`service.live.series`."""
        return self.path / "series.bin"

    @property
    def events(self) -> Path:
        """What happened, a line each."""
        return self.path / "events.jsonl"

    @property
    def orders(self) -> Path:
        """What is asked of the run, a line each."""
        return self.path / "orders.jsonl"

    @property
    def status(self) -> Path:
        """How it is now."""
        return self.path / "status.json"

    def write_status(self, status: Mapping[str, Any]) -> None:
        """Replace the status; readers see the old or the new. It need not outlive a crash.

        Raises
        ------
        StorageFull, Unavailable
            When it cannot be written; the old one stays.
        """
        partial = self.path / ".status.json"
        with storing(self.status.name):
            partial.write_text(json.dumps(status, ensure_ascii=False), encoding="utf-8")
            os.replace(partial, self.status)

    def read_status(self) -> dict[str, Any] | None:
        """How it is now; None: nothing was said yet."""
        try:
            found: dict[str, Any] = json.loads(self.status.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        return found
