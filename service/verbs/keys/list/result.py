"""Result of ``keys list``: keys without their secrets."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from service.rendering.columns import Column
from service.rendering.view import ResultView, Table
from service.storage.keys import Key
from service.verbs.result import Result


def _day(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).date().isoformat()


KEYS: tuple[Column[Key], ...] = (
    Column(key="id", heading="id", kind=str, value=lambda key: key.id),
    Column(key="owner", heading="for", kind=str, value=lambda key: key.name),
    Column(key="roles", heading="roles", value=lambda key: sorted(key.roles)),
    Column(key="created", heading="created", kind=str, value=lambda key: _day(key.created)),
    Column(
        key="state",
        heading="state",
        kind=str,
        value=lambda key: "valid" if key.revoked is None else f"revoked {_day(key.revoked)}",
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeysResult(Result):
    """Keys of the service, oldest first."""

    keys: Sequence[Key]

    def view(self) -> ResultView:
        """Return a line for each key."""
        return ResultView([Table(key="keys", columns=KEYS, rows=self.keys)])
