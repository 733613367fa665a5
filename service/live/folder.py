"""Files of a live run in the folder of its job."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from service.live.storage import storing

FORMER = {"is_over": "is_overloaded"}
"""Keys of a status written by earlier versions, with their current names."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveFolder:
    """Folder through which a run reports and takes orders."""

    path: Path

    @property
    def series(self) -> Path:
        """File of rows, see :mod:`service.live.series`."""
        return self.path / "series.bin"

    @property
    def events(self) -> Path:
        """File of events, one per line."""
        return self.path / "events.jsonl"

    @property
    def orders(self) -> Path:
        """File of orders to the run, one per line."""
        return self.path / "orders.jsonl"

    @property
    def status(self) -> Path:
        """File with the latest status snapshot."""
        return self.path / "status.json"

    def write_status(self, status: Mapping[str, Any]) -> None:
        """Replace the status atomically; it need not survive a crash.

        Raises
        ------
        StorageFull, Unavailable
            When it cannot be written; the old status stays.
        """
        partial = self.path / ".status.json"
        with storing(self.status.name):
            partial.write_text(json.dumps(status, ensure_ascii=False), encoding="utf-8")
            os.replace(partial, self.status)

    def read_status(self) -> dict[str, Any] | None:
        """Return the latest status snapshot; None before the first one."""
        try:
            found: dict[str, Any] = json.loads(self.status.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        return {FORMER.get(key, key): value for key, value in found.items()}
