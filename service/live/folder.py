"""The files of a run while it runs, as they are named in its job's folder."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from service.live.storage import storing

FORMER = {"is_over": "is_overloaded"}
"""keys of a status as earlier versions wrote them"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveFolder:
    """Folder through which a run reports and takes orders."""

    path: Path

    @property
    def series(self) -> Path:
        """Rows, see :mod:`service.live.series`."""
        return self.path / "series.bin"

    @property
    def events(self) -> Path:
        """Events, a line each."""
        return self.path / "events.jsonl"

    @property
    def orders(self) -> Path:
        """Orders to the run, a line each."""
        return self.path / "orders.jsonl"

    @property
    def status(self) -> Path:
        """Latest status snapshot."""
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
        """Latest status snapshot; None: there is none yet."""
        try:
            found: dict[str, Any] = json.loads(self.status.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        return {FORMER.get(key, key): value for key, value in found.items()}
