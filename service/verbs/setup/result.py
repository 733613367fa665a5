"""Result of ``setup``: the values of a draft, and what is missing."""

from dataclasses import dataclass
from pathlib import Path

from service.rendering.columns import Column
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.simulation.setup_draft import DraftRow
from service.verbs.result import Result
from stepnc_model.errors import Finding

VALUES: tuple[Column[DraftRow], ...] = (
    Column(key="name", heading="value", value=lambda row: row.name, is_key=True),
    Column(key="value", heading="is", value=lambda row: row.value),
    Column(key="sure", heading="how sure", value=lambda row: row.sure.value),
    Column(key="source", heading="from", value=lambda row: row.source, is_words=True),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupResult(Result):
    """Draft of the setup of an NC program."""

    name: str
    values: tuple[DraftRow, ...]
    text: str
    """Text of the draft."""
    written: Path | None
    missing: tuple[str, ...]
    """What ``optimise`` still needs, in words."""
    command: str
    findings: tuple[Finding, ...]

    def view(self) -> ResultView:
        """Return the values with their sources, and what is missing."""
        missing = "; ".join(self.missing)
        ready = (
            f"missing for optimise: {missing}" if missing else "nothing is missing for optimise"
        )
        return ResultView([
            Fact(key="program", value=self.name),
            Table(key="values", columns=VALUES, rows=self.values),
            Fact(key="written", value=None if self.written is None else str(self.written)),
            Fact(key="missing", value=list(self.missing)),
            Fact(key="command", value=self.command),
            Fact(key="text", value=self.text),
            Findings(findings=self.findings),
            TextLine(text=ready),
        ])  # fmt: skip
