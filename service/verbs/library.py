"""Results of ``machines`` and ``materials``: the entries of the library, or one of them."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from service.rendering.columns import Column, plain
from service.rendering.view import Fact, ResultView, Table, TextLine
from service.verbs.result import Result
from simulator.spec import Machine, WorkMaterial

EntryFact = tuple[str, str]
"""Name and value of what matters to a planner."""

FACTS: tuple[Column[EntryFact], ...] = (
    Column(heading="what", value=lambda fact: fact[0]),
    Column(heading="value", value=lambda fact: fact[1]),
)


def entry_record(entry: Machine | WorkMaterial) -> dict[str, Any]:
    """Return a machine or material for JSON, in canonical units (mm, s, N, W, rev/s)."""
    found: dict[str, Any] = plain(asdict(entry))
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class ListingResult(Result):
    """All machines or all materials."""

    kind: str
    columns: tuple[Column[Any], ...]
    entries: Sequence[Machine | WorkMaterial]

    def view(self) -> ResultView:
        """Return a row for each entry."""
        return ResultView([Table(key=self.kind, columns=self.columns, rows=self.entries)])

    def record(self) -> Any:
        """Return the entries as a JSON array, as clients know it."""
        return self.view().record()[self.kind]


@dataclass(frozen=True, slots=True, kw_only=True)
class EntryResult(Result):
    """One machine or material."""

    entry: Machine | WorkMaterial
    facts: Sequence[EntryFact]

    def view(self) -> ResultView:
        """Return what matters to a planner, and where it comes from; all, for programs."""
        entry = self.entry
        return ResultView([
            *(Fact(key=key, value=value) for key, value in entry_record(entry).items()),
            TextLine(text=f"{entry.name}: {entry.title}"),
            Table(columns=FACTS, rows=self.facts),
            TextLine(text=f"source: {entry.source}"),
            *(TextLine(text=f"remark: {remark}") for remark in entry.remarks),
        ])
