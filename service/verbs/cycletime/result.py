"""Result of ``cycletime``: times by workingstep and tool, and where time is lost."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.rendering.columns import Column
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.verbs.result import Result
from simulator.machine.block_times import BlockTimes, LossCause
from simulator.motion.model_name import ControlModelName
from simulator.spec import Machine
from stepnc_model.errors import Finding
from stepnc_model.units import mm_min_from_speed, ms_from_seconds

if TYPE_CHECKING:
    import plotly.graph_objects as go


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleRow:
    """Times of one tool in one workingstep, or of all, s."""

    workingstep: str
    tool: int | None
    blocks: int
    programmed: float
    by_rate: float
    predicted: float
    actual: float | None
    """Logged time; None where the log does not tell it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LosingStretch:
    """Consecutive blocks that lose time for the same reason."""

    workingstep: str
    first: int
    """Number of its first block or line."""
    last: int
    blocks: int
    spacing: float
    """Mean length of a block, mm."""
    feed: float
    """Mean programmed feed, mm/s."""
    reached: float
    """Mean predicted feed, mm/s."""
    lost: float
    """Time beyond the programmed one, s."""
    cause: LossCause


def _off(row: CycleRow) -> str:
    """Relative error of the prediction."""
    if not row.actual:
        return ""
    return f"{100.0 * (row.predicted / row.actual - 1.0):+.2f} %"


ROWS: tuple[Column[CycleRow], ...] = (
    Column(
        key="workingstep", heading="workingstep", is_key=True, is_words=True,
        value=lambda row: row.workingstep,
    ),
    Column(key="tool", heading="tool", form=".0f", value=lambda row: row.tool or None),
    Column(key="blocks", heading="blocks", form=".0f", value=lambda row: row.blocks),
    Column(
        key="theoretical_s", heading="theoretical s", form=".2f", help="length over feed",
        value=lambda row: row.programmed,
    ),
    Column(
        key="block_rate_s", heading="block rate s", form=".2f",
        help="at the feed that block rate and axes allow: the modified program",
        value=lambda row: row.by_rate,
    ),
    Column(
        key="predicted_s", heading="predicted s", form=".2f",
        help="with acceleration and corners by the model of the control",
        value=lambda row: row.predicted,
    ),
    Column(
        key="actual_s", heading="actual s", form=".2f", is_optional=True,
        value=lambda row: row.actual,
    ),
    Column(heading="predicted off", is_optional=True, value=_off),
)  # fmt: skip

STRETCHES: tuple[Column[LosingStretch], ...] = (
    Column(
        key="workingstep", heading="workingstep", is_optional=True, is_words=True,
        value=lambda row: row.workingstep,
    ),
    Column(
        key="first_block", heading="from", form=".0f", help="number of the block or line",
        value=lambda row: row.first,
    ),
    Column(key="last_block", heading="to", form=".0f", value=lambda row: row.last),
    Column(key="blocks", heading="blocks", form=".0f", value=lambda row: row.blocks),
    Column(
        key="spacing_mm", heading="spacing mm", form=".4g", help="mean length of a block",
        value=lambda row: row.spacing,
    ),
    Column(
        key="feed_mm_min", heading="feed mm/min", form=".0f",
        value=lambda row: mm_min_from_speed(row.feed),
    ),
    Column(
        key="reached_mm_min", heading="reached mm/min", form=".0f",
        value=lambda row: mm_min_from_speed(row.reached),
    ),
    Column(key="lost_s", heading="lost s", form=".2f", value=lambda row: row.lost),
    Column(key="cause", heading="held by", is_words=True, value=lambda row: row.cause.words),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CycleTimeResult(Result):
    """Result of ``cycletime``."""

    name: str
    machine: Machine
    control: ControlModelName
    times: BlockTimes
    rows: tuple[CycleRow, ...]
    """Rows by workingstep and tool in order of execution."""
    total: CycleRow
    stretches: tuple[LosingStretch, ...]
    """Stretches that lose most, in order of their loss."""
    hints: tuple[str, ...]
    findings: tuple[Finding, ...]
    log: str | None = None
    """Name of the log; None without one."""

    def kept(self, folder: Path) -> dict[str, Any]:
        """Return the record with the name of the log."""
        return {**Result.kept(self, folder), "log": self.log}

    def view(self) -> ResultView:
        """Return times by workingstep and tool, the blocks that lose most, and hints."""
        time, control = self.machine.block_time, self.control.value
        rate = "" if time is None else f", {ms_from_seconds(time):g} ms a block"
        return ResultView([
            TextLine(text=f"{self.name}: machine {self.machine.name}{rate}, control {control}"),
            Fact(key="program", value=self.name),
            Fact(key="machine", value=self.machine.name),
            Fact(key="control", value=control),
            Fact(key="block_time_ms", value=None if time is None else ms_from_seconds(time)),
            Table(key="rows", columns=ROWS, rows=self.rows, total=self.total),
            Table(
                key="stretches", columns=STRETCHES, rows=self.stretches,
                heading="blocks that lose most:",
            ),
            Fact(key="hints", value=self.hints),
            *(TextLine(text=f"hint: {hint}") for hint in self.hints),
            Findings(findings=self.findings),
        ])  # fmt: skip

    def figures(self) -> "tuple[go.Figure]":
        """Return the feed of each block: programmed, and what limits it."""
        from service.verbs.cycletime.figures import cycle_time_figure  # noqa: PLC0415 (plotly)

        return (cycle_time_figure(self.times),)

    def page(self) -> str:
        """Return a self-contained page with the feed of each block."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        return rendered(
            "cycletime.html.jinja",
            result=self,
            columns=ROWS,
            stretches=STRETCHES,
            figure=plot(self.plot(), "feeds"),
        )
