"""Response bodies of cycle times."""

from pydantic import ConfigDict, Field

from service.rest.views import FindingView, View


class CycleRowView(View):
    """Times of one tool in one workingstep, or of all."""

    workingstep: str
    tool: int | None
    blocks: int
    theoretical_s: float = Field(description="length over feed")
    block_rate_s: float = Field(description="at the feed that block rate and axes allow")
    predicted_s: float = Field(description="with acceleration and corners")
    actual_s: float | None = Field(description="as logged; null: the log does not tell it")


class LosingStretchView(View):
    """Consecutive blocks that lose time for the same reason."""

    workingstep: str
    first_block: int
    last_block: int
    blocks: int
    spacing_mm: float = Field(description="mean length of a block")
    feed_mm_min: float
    reached_mm_min: float
    lost_s: float
    cause: str


class CycleTimeView(View):
    """Cycle time of a program, as ``stepnc cycletime --json`` prints it."""

    model_config = ConfigDict(extra="allow", frozen=True)

    program: str
    log: str | None
    machine: str
    control: str
    block_time_ms: float | None = Field(description="null: the block rate limits nothing")
    rows: list[CycleRowView]
    total: CycleRowView
    stretches: list[LosingStretchView] = Field(description="those that lose most, first")
    hints: list[str]
    findings: list[FindingView]
