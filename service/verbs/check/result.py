"""Results of ``check``: contents and findings of a STEP-NC program, or of NC code."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isnan

from service.errors import BAD_INPUT, OK
from service.programs.needs import ProgramNeeds
from service.rendering.columns import Column, records
from service.rendering.text import YELLOW
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.verbs.check.uses import Use, UseName
from service.verbs.result import Result
from stepnc_model.errors import Finding
from stepnc_model.plurals import counted
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.units import mm_min_from_speed

MOST_INDENTED = 20
"""Deepest level of executables that the table still shows by indentation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExecutableRow:
    """Row of the workplan table: one executable with its operation and tool."""

    instance: str
    entity: str
    id: str
    level: int
    operation: str
    tool: str


EXECUTABLES: tuple[Column[ExecutableRow], ...] = (
    Column(key="instance", heading="instance", value=lambda row: row.instance, is_key=True),
    Column(
        heading="executable",
        value=lambda row: "  " * min(row.level, MOST_INDENTED) + row.entity.lower(),
    ),
    Column(key="entity", value=lambda row: row.entity),
    Column(key="id", heading="id", value=lambda row: row.id),
    Column(key="level", value=lambda row: row.level),
    Column(heading="operation", value=lambda row: row.operation),
    Column(heading="tool", value=lambda row: row.tool),
)

STEPS: tuple[Column[ResolvedWorkingstep], ...] = (
    Column(key="id", value=lambda step: step.id),
    Column(key="instance", value=lambda step: str(step.ref)),
    Column(key="operation", value=lambda step: step.operation_type),
    Column(key="tool", value=lambda step: str(step.tool_ref)),
)

USES: tuple[Column[Use], ...] = (
    Column(key="name", value=lambda use: use.name.value),
    Column(key="is_possible", value=lambda use: use.is_possible),
    Column(key="is_possible_with_material", value=lambda use: use.is_possible_with_material),
    Column(key="reason", value=lambda use: use.reason),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveCount:
    """Moves of one kind and tool."""

    tool: int
    """Number of the tool; -1 before the first tool call."""
    kind: str
    count: int
    length: float
    """Length of the moves whose ends are known, mm."""
    least_feed: float
    """Least feed, mm/s; NaN for rapids and where it is not known."""
    greatest_feed: float
    advisable: int
    """Number of moves whose feed may be advised."""
    splittable: int
    """Number of moves whose block may be split."""


COUNTS: tuple[Column[MoveCount], ...] = (
    Column(
        key="tool",
        heading="tool",
        value=lambda row: None if row.tool < 0 else row.tool,
        form="d",
        is_key=True,
    ),
    Column(key="kind", heading="moves", value=lambda row: row.kind, is_key=True),
    Column(key="count", heading="number", value=lambda row: row.count, form="d"),
    Column(key="length_mm", heading="length mm", value=lambda row: row.length, form=".0f"),
    Column(
        key="least_feed_mm_min",
        heading="least feed mm/min",
        value=lambda row: _feed(row.least_feed),
        form=".0f",
    ),
    Column(
        key="greatest_feed_mm_min",
        heading="greatest feed mm/min",
        value=lambda row: _feed(row.greatest_feed),
        form=".0f",
    ),
    Column(
        key="advisable", heading="feed may change", value=lambda row: row.advisable, form="d"
    ),
    Column(
        key="splittable", heading="may be split", value=lambda row: row.splittable, form="d"
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundTool:
    """Tool that comments of NC code describe."""

    number: int
    kind: str
    diameter: float
    """Diameter, mm."""
    teeth: int
    guessed: str
    """Which values are guessed, in words; empty: none."""
    line: int
    """Line of the comment."""


TOOLS: tuple[Column[FoundTool], ...] = (
    Column(key="number", heading="tool", value=lambda row: row.number, form="d", is_key=True),
    Column(key="kind", heading="kind", value=lambda row: row.kind),
    Column(
        key="diameter_mm", heading="diameter mm", value=lambda row: row.diameter, form=".4g"
    ),
    Column(key="teeth", heading="teeth", value=lambda row: row.teeth, form="d"),
    Column(key="guessed", heading="guessed", value=lambda row: row.guessed),
    Column(key="line", heading="line", value=lambda row: row.line, form="d"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeNeeds:
    """Setup that ``optimise`` finds in NC code, and what it still needs."""

    tools: tuple[FoundTool, ...] = ()
    stock: str = ""
    """Numbers of the stock that the code states or that its moves suggest; empty: none."""
    is_stock_guessed: bool = False
    missing: tuple[str, ...] = ()
    command: str = ""
    """Command with a name in capitals for everything that is missing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramContents(Result):
    """Contents and findings of a checked STEP-NC file."""

    name: str
    schemas: tuple[str, ...]
    instances: int
    program: Program | None
    findings: tuple[Finding, ...]
    uses: tuple[Use, ...] = ()
    """Uses of the program; none where it could not be read."""
    remarks: tuple[Finding, ...] = ()
    """Those of the findings that every command tells."""
    needs: ProgramNeeds | None = None
    """What the program lacks for advice; None where it could not be read."""

    @property
    def is_usable(self) -> bool:
        """True if feeds can be advised or NC code written, with a material if need be."""
        wanted = {UseName.CODE, UseName.ADVICE}
        return any(
            use.is_possible or use.is_possible_with_material
            for use in self.uses
            if use.name in wanted
        )

    @property
    def is_of_use(self) -> bool:
        """True if the program can be used for anything."""
        return any(use.is_possible or use.is_possible_with_material for use in self.uses)

    @property
    def exit_code(self) -> int:
        """Exit code of the command line; bad input if it can be used for nothing."""
        return OK if self.is_of_use else BAD_INPUT

    def view(self) -> ResultView:
        """Return the workplan, the findings, and what the program can be used for."""
        program = self.program
        schemas = ", ".join(self.schemas) or "none"
        return ResultView([
            TextLine(
                text=f"{self.name}: {counted(self.instances, 'instance')}, schemas {schemas}"
            ),
            Fact(key="program", value=self.name),
            Fact(key="schemas", value=list(self.schemas)),
            Fact(key="instances", value=self.instances),
            Fact(key="is_usable", value=self.is_usable),
            Fact(key="uses", value=records(USES, self.uses)),
            Table(
                key="executables", columns=EXECUTABLES, is_shown=program is not None,
                rows=() if program is None else tuple(_executables(program)),
            ),
            Table(
                key="workingsteps", columns=STEPS, is_shown=False,
                rows=() if program is None else program.workingsteps,
            ),
            Fact(key="missing", value=list(self.needs.missing) if self.needs else []),
            Fact(key="command", value=self.needs.command if self.needs else ""),
            Findings(findings=self.findings, reported=self.remarks),
            *self._use_lines(),
            *(TextLine(text=line) for line in _need_lines(self.needs)),
        ])  # fmt: skip

    def _use_lines(self) -> Iterator[TextLine]:
        if not self.uses:
            yield TextLine(text="cannot be used: see the errors above")
            return
        yield TextLine(text="usable for:")
        for use in self.uses:
            text = f"  {use.name.value}: {_answer(use)}"
            yield TextLine(text=text, colour="" if use.is_possible else YELLOW)


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeContents(Result):
    """Contents and findings of checked NC code."""

    name: str
    control: str
    hints: tuple[str, ...]
    """Pieces of the program that speak for the control; empty if it was named."""
    machine: str
    is_inch: bool
    blocks: int
    executed: int
    """Number of executed moves."""
    frames: tuple[str, ...]
    counts: tuple[MoveCount, ...]
    is_lossless: bool
    """Whether rewriting without advice gives the file byte for byte."""
    findings: tuple[Finding, ...]
    needs: CodeNeeds

    def view(self) -> ResultView:
        """Return the control, the moves by tool and kind, and what was not understood."""
        hints = f" (guessed from {', '.join(self.hints)})" if self.hints else ""
        return ResultView([
            TextLine(
                text=f"{self.name}: {self.control} {self.machine}{hints}, "
                f"{'inch' if self.is_inch else 'mm'}, {counted(self.blocks, 'block')}, "
                f"{counted(self.executed, 'executed move')}, frames {', '.join(self.frames)}"
            ),
            Fact(key="program", value=self.name),
            Fact(key="control", value=self.control),
            Fact(key="hints", value=list(self.hints)),
            Fact(key="machine", value=self.machine),
            Fact(key="units", value="inch" if self.is_inch else "mm"),
            Fact(key="blocks", value=self.blocks),
            Fact(key="executed_moves", value=self.executed),
            Fact(key="frames", value=list(self.frames)),
            Table(key="moves", columns=COUNTS, rows=self.counts),
            Table(
                key="tools", columns=TOOLS, rows=self.needs.tools,
                is_shown=bool(self.needs.tools),
            ),
            Fact(key="stock", value=self.needs.stock),
            Fact(key="is_stock_guessed", value=self.needs.is_stock_guessed),
            Fact(key="missing", value=list(self.needs.missing)),
            Fact(key="command", value=self.needs.command),
            Fact(key="is_lossless", value=self.is_lossless),
            Findings(findings=self.findings),
            TextLine(
                text="rewriting without advice gives the file byte for byte"
                if self.is_lossless
                else "rewriting does not give the file byte for byte: please report this"
            ),
            *(TextLine(text=line) for line in self._need_lines()),
        ])  # fmt: skip

    def _need_lines(self) -> Iterator[str]:
        """Say what optimise would take, what is missing, and the command to complete."""
        needs = self.needs
        if needs.stock:
            guessed = " (guessed from the cutting moves)" if needs.is_stock_guessed else ""
            yield f"stock: {needs.stock} mm{guessed}"
        if needs.missing:
            yield f"missing for optimise: {'; '.join(needs.missing)}"
        yield f"ready: {needs.command}"


def _need_lines(needs: ProgramNeeds | None) -> Iterator[str]:
    """Say what is missing for advice, and the command to complete."""
    if needs is not None and needs.missing:
        yield f"missing for optimise: {'; '.join(needs.missing)}"
        yield f"ready: {needs.command}"


def _answer(use: Use) -> str:
    """Say whether a use is possible, with the reason where it is not."""
    return "yes" if use.is_possible else f"no: {use.reason}"


def _executables(program: Program) -> Iterator[ExecutableRow]:
    steps = {int(step.ref): step for step in program.workingsteps}
    for each in program.executables:
        step = steps.get(int(each.ref))
        yield ExecutableRow(
            instance=str(each.ref),
            entity=each.keyword,
            id=each.id,
            level=each.level,
            operation=step.operation_type if step else "",
            tool=getattr(program.get(step.tool_ref), "its_id", "") if step else "",
        )


def _feed(speed: float) -> float | None:
    """Feed in mm/min, or None where it is not known."""
    return None if isnan(speed) else mm_min_from_speed(speed)
