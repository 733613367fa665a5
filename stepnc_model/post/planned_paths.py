"""Tool paths with planned feeds, from the neutral blocks whose feeds were planned.

Each move of a tool path becomes one neutral block (:mod:`stepnc_model.post.neutral`); here the
moves get the feeds of their blocks back, as factors on the feed of their technology.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import nextafter

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.post.block_feeds import BlockPart, Numbered
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    DrillingCycle,
    Linear,
    MachineType,
    Pause,
    ProgramStart,
    Rapid,
    Rate,
    RigidTap,
    ThreadingMove,
)
from stepnc_model.post.modal_state import conditions
from stepnc_model.post.neutral import unsplit
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.explicit.operation import path_frames
from stepnc_model.toolpath.explicit.planned_path import MovePart, PlannedMove, PlannedPath
from stepnc_model.toolpath.path import Dwell, Feed, Function, Move, MoveType, Step, ToolPath

NOT_WRITTEN = "its tool path is not written"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedPaths:
    """Tool paths of a program with planned feeds."""

    paths: tuple[PlannedPath, ...]
    findings: tuple[Finding, ...]
    """Reasons why paths of other workingsteps with planned feeds cannot be written."""


def planned_paths(
    program: Program,
    items: Sequence[ToolPath | Function],
    blocks: Iterable[Numbered],
    feeds: Mapping[int, tuple[BlockPart, ...]],
) -> PlannedPaths:
    """Tool paths of the workingsteps that have planned feeds and a form in the file.

    Drilling cycles have none: their feed stays that of the technology.

    Parameters
    ----------
    items : sequence of ToolPath and Function
        Paths and functions in execution order.
    blocks : iterable of (int, Block)
        Blocks of these paths, with the numbers by which their feeds were planned.
    feeds : mapping
        Parts by the number of their block; a block without an entry keeps its feed.

    Raises
    ------
    SchemaError, PostError
        If a placement, a tool or a technology cannot be used.
    """
    steps = {int(step.ref): step for step in program.workingsteps}
    uses = Counter(int(step.operation_ref) for step in program.workingsteps)
    machine, groups = _grouped(blocks)
    tool_paths = [item for item in items if isinstance(item, ToolPath)]
    paths: list[PlannedPath] = []
    findings: list[Finding] = []
    for path, group in zip(tool_paths, groups, strict=True):
        step = steps.get(int(path.workingstep))
        if step is None or path.cycles or not any(number in feeds for number, _ in group):
            continue
        frames = path_frames(program, step)
        reason = _reason_against(path, copies=len(frames), uses=uses[int(step.operation_ref)])
        factors = _Factors(program, step, machine)
        planned = None if reason else _steps(path, group, feeds, factors)
        if planned is None:
            reason = reason or "its moves and blocks do not match"
            message = f"'{path.id}': {NOT_WRITTEN}: {reason}"
            findings.append(program.finding(Severity.NOTE, message, step.operation_ref))
            continue
        paths.append(
            PlannedPath(step=step, frame=frames[0], start=path.start, steps=tuple(planned))
        )
    return PlannedPaths(paths=tuple(paths), findings=tuple(findings))


def _grouped(blocks: Iterable[Numbered]) -> tuple[MachineType, list[list[Numbered]]]:
    """Type of the machine, and the blocks of each workingstep."""
    machine = MachineType.MILL
    groups: list[list[Numbered]] = []
    for number, block in blocks:
        if isinstance(block, ProgramStart):
            machine = block.machine
        elif isinstance(block, Comment) and block.workingstep:
            groups.append([])
        elif groups and _is_step(block):
            groups[-1].append((number, block))
    return machine, groups


def _is_step(block: Block) -> bool:
    """True if a block comes from a move or a dwell of a tool path."""
    if isinstance(block, Rapid):
        return not block.is_way
    kinds = (Linear, Circular, ThreadingMove, DrillingCycle, RigidTap, Pause)
    return isinstance(block, kinds)


def _reason_against(path: ToolPath, *, copies: int, uses: int) -> str:
    """Reason why a path has no form in the file; empty if it has one."""
    if copies != 1:
        return f"the file would repeat it at each of the {copies} places of the pattern"
    if uses != 1:
        return f"{uses} workingsteps share the operation"
    if not all(isinstance(step, (Move, Dwell)) for step in path.steps):
        return "it changes the spindle on the way"
    feeds = [move.feed for move in path.moves if move.feed is not None]
    if any(feed.is_synchronised or feed.speed_ratio != 1.0 for feed in feeds):
        return "its feed is bound to the spindle, or the spindle changes on the way"
    return ""


class _Factors:
    """Factors of feeds on those of their technologies; keeps the feeds of the latter."""

    def __init__(
        self, program: Program, step: ResolvedWorkingstep, machine: MachineType
    ) -> None:
        self._program, self._step, self._machine = program, step, machine
        self._rates: dict[Ref[Entity], Rate | None] = {}

    def factor(self, technology: Ref[Entity], rate: Rate, value: float) -> float | None:
        """Greatest factor of a feed that is not above a value; None if it has none."""
        if technology not in self._rates:
            self._rates[technology] = self._rate(Feed(technology=technology))
        whole = self._rates[technology]
        if whole is None or whole.mode is not rate.mode:
            return None
        factor = value / whole.value
        while self._value(Feed(technology=technology, ratio=factor)) > value:
            factor = nextafter(factor, 0.0)
        return factor

    def _rate(self, feed: Feed) -> Rate | None:
        return conditions(self._program, feed, self._step.tool_ref, self._machine).rate

    def _value(self, feed: Feed) -> float:
        """Feed as it is read from the file."""
        found = self._rate(feed)
        return 0.0 if found is None else found.value


def _steps(
    path: ToolPath,
    group: Sequence[Numbered],
    feeds: Mapping[int, tuple[BlockPart, ...]],
    factors: _Factors,
) -> list[PlannedMove | Dwell] | None:
    """Moves and pauses with their factors; None if blocks and moves do not match."""
    steps = list(_merged(path))
    if len(steps) != len(group):
        return None
    found: list[PlannedMove | Dwell] = []
    for step, (number, block) in zip(steps, group, strict=True):
        planned = _step(step, block, feeds.get(number), factors)
        if planned is None:
            return None
        found.append(planned)
    return found


def _merged(path: ToolPath) -> Iterator[Step]:
    """Steps as blocks have them; a move that touches material anywhere counts as contact."""
    rest = iter(path.steps)
    for step in unsplit(path.start, path.steps):
        touches = False
        for one in rest:
            if isinstance(one, Move) and isinstance(step, Move):
                touches = touches or one.type is MoveType.CONTACT
                if one.end == step.end:
                    break
            elif one is step:
                break
        if touches and isinstance(step, Move):
            yield replace(step, type=MoveType.CONTACT)
        else:
            yield step


def _step(
    step: Step, block: Block, parts: tuple[BlockPart, ...] | None, factors: _Factors
) -> PlannedMove | Dwell | None:
    """Move or pause of one block; None if they do not match."""
    if isinstance(step, Dwell) and isinstance(block, Pause):
        return Dwell(seconds=block.seconds)
    if not isinstance(step, Move) or not isinstance(block, (Rapid, Linear, Circular)):
        return None
    if step.end != block.end or (step.feed is None) is not isinstance(block, Rapid):
        return None
    if step.feed is None or isinstance(block, Rapid):
        return PlannedMove(move=step)
    rate = block.rate
    planned = tuple(_move_parts(step.feed, rate, parts, factors))
    return PlannedMove(move=step, parts=planned) if planned else None


def _move_parts(
    feed: Feed, rate: Rate, parts: tuple[BlockPart, ...] | None, factors: _Factors
) -> Iterator[MovePart]:
    """Parts of a move; none if its feed is no factor on that of its technology."""
    rows = parts or (BlockPart(end=1.0, rate=rate.value),)
    values = [factors.factor(feed.technology, rate, row.rate) for row in rows]
    for row, factor in zip(rows, values, strict=True):
        if factor is not None:
            yield MovePart(end=row.end, factor=factor)
