"""Rewriting of an NC program: only F words change, and blocks are divided.

After each changed stretch the programmed feed is put in force again, for blocks that have no
advice and no F word of their own. The order of execution decides: a block in a subprogram that
would need another feed for each call refuses the advice before it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from stepnc_model.nc.advice import BlockAdvice, RewrittenCode, UnchangedBlock, least_of
from stepnc_model.nc.block_edit import (
    BlockForm,
    cycle_feed_token,
    feed_token,
    split_block,
    with_cycle_feed,
    with_feed,
    with_mark,
)
from stepnc_model.nc.fed_blocks import DEFINED_CYCLES, FedBlocks, cycle_feed_blocks
from stepnc_model.nc.feed_rows import feed_rows
from stepnc_model.nc.moves import (
    REASONS,
    UNADVISED,
    UNSPLIT,
    FeedMode,
    ModalSetting,
    MoveFlag,
    MoveKind,
)
from stepnc_model.nc.number_style import style_of
from stepnc_model.nc.program import NcProgram
from stepnc_model.nc.split import MovePiece, WordScale, divided
from stepnc_model.nc.token import TokenKind, tokens
from stepnc_model.nc.written_lines import WrittenLines, line_ends
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.arc import length as length_of
from stepnc_model.units import mm_min_from_speed

SAME = 1e-6
"""Greatest distance of two executions of a block that is split, mm."""

EQUAL = 1e-6
"""Relative difference below which two feeds are the same."""


@dataclass(slots=True, kw_only=True)
class _Plan:
    """Change of one block."""

    advice: BlockAdvice
    row: int
    """First row of the block among the moves."""
    setting: ModalSetting
    pieces: Sequence[MovePiece] = ()
    """Pieces of a block that is divided; none of one that stays whole."""
    feeds: list[str] = field(default_factory=list)
    """Number of the F word of each piece, or of the whole block."""
    needs: bool = False
    """Whether the feed in force before the block differs in one execution."""


@dataclass(slots=True)
class _Trace:
    """Result of following the feed in force through the program."""

    restored: dict[int, int] = field(default_factory=dict)
    """Block whose F word is to be put in force again before each of these blocks."""
    refused: dict[int, str] = field(default_factory=dict)


def rewrite(
    program: NcProgram, advice: Iterable[BlockAdvice], *, mark: bool = False
) -> RewrittenCode:
    """Write advised feeds into an NC program.

    Parameters
    ----------
    program : NcProgram
    advice : iterable of BlockAdvice
        Several on one block, such as one for each call, give its least feed at every place.
    mark : bool
        Whether changed blocks get a comment with the reason.

    Returns
    -------
    RewrittenCode
        New bytes, with the blocks that did not get what was advised and the reasons.

    Raises
    ------
    ValueError
        If advice names a block that the program does not have.
    """
    return _Rewriting(program, least_of(advice), mark=mark).result()


class _Rewriting:
    """Rewriting of one program."""

    def __init__(
        self, program: NcProgram, advice: dict[int, BlockAdvice], *, mark: bool
    ) -> None:
        self.program, self.moves, self.mark = program, program.moves, mark
        self.style = style_of(program.text, program.dialect, unit=program.unit)
        self.unchanged: list[UnchangedBlock] = []
        self._fed = FedBlocks(program, np.array(sorted(advice), np.int64))
        self._numbers: dict[tuple[float, float, FeedMode], str] = {}
        self._feed_words: dict[int, str | None] = {}
        self.cycle_feeds: dict[int, str] = {}
        """Number of the new feed of blocks that give defined cycles their feed."""
        self.plans: dict[int, _Plan] = {}
        feeding = frozenset(cycle_feed_blocks(self.moves, program.dialect).tolist())
        for block in sorted(advice):
            if block in feeding:
                self._plan_cycle(advice[block])
                continue
            plan = self._planned(advice[block])
            if plan is not None:
                self.plans[block] = plan

    def result(self) -> RewrittenCode:
        """Follow the feed through the program, then put the bytes together."""
        trace = self._traced()
        while trace.refused:
            for block, reason in trace.refused.items():
                del self.plans[block]
                self._leave(block, reason)
            trace = self._traced()
        return self._assembled(trace)

    # Plans of the blocks.

    def _planned(self, advice: BlockAdvice) -> _Plan | None:
        block = advice.block
        if not 0 <= block < len(self.program.text):
            raise ValueError(
                f"block {block}: the program has {len(self.program.text)} blocks, from 0"
            )
        rows = self._fed.rows(block)
        reason = "" if self._fed.is_plain(block) else self._hindrance(rows)
        if reason:
            self._leave(block, reason)
            return None
        row = int(rows[0])
        setting = self.moves.settings[int(self.moves.rows["setting"][row])]
        plan = _Plan(advice=advice, row=row, setting=setting)
        feed = min(advice.feeds)
        if len(set(advice.feeds)) > 1:
            pieces = self._divided(advice, rows)
            if len(pieces) > 1:
                plan.pieces = pieces
            elif pieces:
                feed = pieces[0].feed
        if plan.pieces:
            plan.feeds = [self._number(rows, plan, each.feed, each.length) for each in pieces]
        else:
            plan.feeds = [self._number(rows, plan, feed, None)]
        if any(float(text) <= 0.0 for text in plan.feeds):
            self._leave(block, "the advised feed is below the resolution of its F word")
            return None
        return plan

    def _divided(self, advice: BlockAdvice, rows: NDArray[np.int64]) -> list[MovePiece]:
        """Pieces of a block with several feeds; none if it may not be divided."""
        block = advice.block
        why = self._joining(rows)
        if why:
            self._leave(block, why, is_unsplit=True)
            return []
        first = self.moves.move(int(rows[0]))
        by_radius = first.kind is MoveKind.ARC and self._is_by_radius(block)
        scale = self._scale(first.setting)
        pieces = divided(first, advice.ends, advice.feeds, scale=scale, by_radius=by_radius)
        if len(pieces) == 1:
            self._leave(
                block,
                "too short for its pieces, or an arc that cannot be divided",
                is_unsplit=True,
            )
        return pieces

    def _plan_cycle(self, advice: BlockAdvice) -> None:
        """Plan one feed for the cycles that a block gives their feed."""
        block = advice.block
        rows = np.flatnonzero(
            (self.moves.fed_by == block) & np.isin(self.moves.kind, (MoveKind.LINE,))
        )
        flags = MoveFlag(int(np.bitwise_or.reduce(self.moves.flags[rows])))
        if flags & UNADVISED:
            self._leave(block, _named(flags & UNADVISED))
            return
        if not self.moves.is_advisable[rows].all():
            self._leave(block, "a start or end of its cycles is not known")
            return
        if cycle_feed_token(self.program.text.block(block), self.program.dialect) is None:
            self._leave(block, "the feed of its cycles is no number")
            return
        first = self.moves.move(int(rows[0]))
        number = self._plain_number(rows, first.setting, min(advice.feeds))
        if float(number) > 0.0:
            self.cycle_feeds[block] = number

    def _hindrance(self, rows: NDArray[np.int64]) -> str:
        """Reason why the feed of a block is left alone, or an empty string."""
        if not len(rows):
            return "the block does not move at a feed"
        if (self.moves.kind[rows] == MoveKind.UNKNOWN).any():
            return "the block is not understood"
        flags = MoveFlag(int(np.bitwise_or.reduce(self.moves.flags[rows])))
        if flags & UNADVISED:
            return _named(flags & UNADVISED)
        if not self.moves.is_advisable[rows].all():
            return "its start or end is not known"
        settings = set(self.moves.rows["setting"][rows].tolist())
        modes = {self.moves.settings[each].mode for each in settings}
        if len(modes) > 1:
            return "its executions have feeds in different modes"
        if FeedMode.PER_REVOLUTION in modes and not 0.0 < self.moves.fastest(rows) < inf:
            return "the spindle speed is not known or not limited"
        if self.program.dialect in DEFINED_CYCLES and flags & MoveFlag.CYCLE:
            return "the feed of a cycle stands in its definition, or before its call"
        return ""

    def _joining(self, rows: NDArray[np.int64]) -> str:
        """Reason why a block stays in one piece, or an empty string."""
        flags = MoveFlag(int(np.bitwise_or.reduce(self.moves.flags[rows])))
        if flags & UNSPLIT:
            return _named(flags & UNSPLIT)
        if not self.moves.is_known[rows].all():
            return "its start is not known"
        start, end = self.moves.start[rows], self.moves.end[rows]
        centre, turn = self.moves.centre[rows], self.moves.turn[rows]
        settings = {self.moves.settings[index] for index in self.moves.rows["setting"][rows]}
        if all(each.is_relative and not each.is_centre_absolute for each in settings):
            # Distances mean the same wherever they begin.
            start, end, centre = start - start, end - start, centre - start
        same = (
            (np.abs(start - start[0]).max() < SAME)
            and (np.abs(end - end[0]).max() < SAME)
            and (np.isnan(turn[0]) or np.abs(turn - turn[0]).max() < SAME)
            and (np.isnan(centre[0]).any() or np.abs(centre - centre[0]).max() < SAME)
        )
        return "" if same else "its executions begin or end at different places"

    def _leave(self, block: int, reason: str, *, is_unsplit: bool = False) -> None:
        line = self.program.text.line(block)
        self.unchanged.append(
            UnchangedBlock(block=block, line=line, reason=reason, is_unsplit=is_unsplit)
        )

    def _scale(self, setting: ModalSetting) -> WordScale:
        return WordScale(unit=setting.unit, is_diameter=setting.is_diameter, style=self.style)

    def _is_by_radius(self, block: int) -> bool:
        """True if an arc of the block is given by its radius."""
        text, dialect = self.program.text.block(block), self.program.dialect
        found = [t for t in tokens(text, dialect) if t.kind in {TokenKind.WORD, TokenKind.NAME}]
        return any(t.name in {"R", "CR"} for t in found)

    def _number(
        self, rows: NDArray[np.int64], plan: _Plan, feed: float, length: float | None
    ) -> str:
        """Number of the F word of a piece of some length, or of the whole block.

        It serves the execution that allows least.
        """
        if plan.setting.mode is FeedMode.INVERSE_TIME:
            if length is None:
                move = self.moves.move(plan.row)
                length = length_of(move.start, move)
            value = mm_min_from_speed(feed) / length if length else inf
            return self.style.feed(min(value, 1e6), FeedMode.INVERSE_TIME)
        return self._plain_number(rows, plan.setting, feed)

    def _plain_number(self, rows: NDArray[np.int64], setting: ModalSetting, feed: float) -> str:
        """Number of an F word per minute or per revolution, for a feed in mm/s."""
        if setting.mode is FeedMode.PER_REVOLUTION:
            feed = feed / self.moves.fastest(rows)
        else:
            feed = mm_min_from_speed(feed)
        # Feeds are rounded: a long program has few different ones.
        key = feed, setting.unit, setting.mode
        if key not in self._numbers:
            self._numbers[key] = self.style.feed(feed / setting.unit, setting.mode)
        return self._numbers[key]

    # The feed in force.

    def _traced(self) -> _Trace:
        """Follow the feed in force through all moves, as it will be."""
        trace = _Trace()
        for each in self.plans.values():
            each.needs = False
        changed, changed_by, may_lack = None, -1, False
        for row in feed_rows(self.moves):
            if row.flags & MoveFlag.FRESH_FEED:
                may_lack = self._is_skippable(row.fed_by)
                if changed is not None and may_lack:
                    # Where the operator skips its F word, the feed before it is in force.
                    self._put_back(trace, row.fed_by, changed_by, changed)
                changed = None
            if row.kind in {MoveKind.RAPID, MoveKind.DWELL}:
                continue
            plan = self.plans.get(row.block)
            if plan is not None:
                before = self._in_force(changed, row.fed_by)
                plan.needs |= may_lack or not _is_equal(before, plan.feeds[0])
                changed = None if row.is_inverse else row.block
                changed_by, may_lack = row.fed_by, False
            elif changed is not None and not row.is_inverse:
                if not (row.flags & MoveFlag.OWN_FEED and row.fed_by == row.block):
                    is_macro = bool(row.flags & MoveFlag.MACRO_FEED)
                    self._put_back(trace, row.block, row.fed_by, changed, is_macro=is_macro)
                changed = None
        return trace

    def _is_skippable(self, block: int) -> bool:
        """True if the operator may skip a block of the file."""
        text = self.program.text.block(block) if block >= 0 else ""
        return "/" in text and any(
            token.kind is TokenKind.SKIP for token in tokens(text, self.program.dialect)
        )

    def _in_force(self, changed: int | None, fed_by: int) -> str | None:
        """Number of the F word that is in force before a block."""
        if changed is not None:
            return self.plans[changed].feeds[-1]
        return self._feed_word(fed_by)

    def _feed_word(self, block: int) -> str | None:
        """Number of the F word of a block of the file; None without one."""
        if block < 0:
            return None
        if block not in self._feed_words:
            if block in self.cycle_feeds:
                return self.cycle_feeds[block]
            token = feed_token(self.program.text.block(block), self.program.dialect)
            is_number = token is not None and token.kind is TokenKind.WORD
            self._feed_words[block] = token.value if token is not None and is_number else None
        return self._feed_words[block]

    def _put_back(
        self, trace: _Trace, block: int, fed_by: int, changed: int, *, is_macro: bool = False
    ) -> None:
        """Note that a block needs the programmed feed, or refuse the advice before it."""
        programmed = self._feed_word(fed_by)
        if programmed is None:
            if fed_by >= 0 or is_macro:
                trace.refused[changed] = "a later block needs a feed that is not known"
            return
        if _is_equal(programmed, self.plans[changed].feeds[-1]):
            return
        known = trace.restored.get(block)
        if known is not None and not _is_equal(self._feed_word(known), programmed):
            trace.refused[changed] = "a later block is called with different feeds"
            return
        trace.restored[block] = fed_by

    # The new bytes.

    def _assembled(self, trace: _Trace) -> RewrittenCode:
        # Views, so that what stays is copied once.
        text, data = self.program.text, memoryview(self.program.text.data)
        parts: list[bytes | memoryview] = []
        lines = WrittenLines()
        behind = changed = added = 0
        for block in sorted({*self.plans, *self.cycle_feeds, *trace.restored}):
            old = text.block(block)
            if block in self.cycle_feeds:
                new = self._cycle_fed(block, old, trace.restored.get(block))
                changed += new != old
            elif block in self.plans:
                new = self._changed(self.plans[block], old)
                pieces = self.plans[block].pieces
                changed += new != old
                if pieces:
                    added += len(pieces) - 1
                    lines.divide(text.line(block), [piece.length for piece in pieces])
            else:
                new = self._restored(block, old, trace.restored[block])
            if block not in self.plans and line_ends(new) > line_ends(old):
                lines.put_before(text.line(block))
            begin, end = int(text.starts[block]), int(text.starts[block + 1])
            parts += (data[behind:begin], new.encode("latin-1"))
            behind = end
        parts.append(data[behind:])
        return RewrittenCode(
            data=b"".join(parts),
            changed=changed,
            added=added,
            restored=len(trace.restored),
            unchanged=tuple(sorted(self.unchanged, key=lambda each: each.block)),
            lines=lines,
        )

    def _changed(self, plan: _Plan, text: str) -> str:
        """Text of a block with its new feeds."""
        dialect, gap = self.program.dialect, self.style.gap
        own = feed_token(text, dialect)
        head = plan.feeds[0]
        is_own = own is not None and own.kind is TokenKind.WORD
        if (is_own and own is not None and _is_equal(own.value, head)) or (
            own is None and not plan.needs
        ):
            head = ""
        if not plan.pieces:
            new = with_feed(text, head, dialect=dialect, gap=gap) if head else text
        else:
            feeds = [
                head,
                *(
                    ""
                    if _is_equal(a, b) and plan.setting.mode is not FeedMode.INVERSE_TIME
                    else b
                    for a, b in zip(plan.feeds, plan.feeds[1:], strict=False)
                ),
            ]
            new = split_block(text, plan.pieces, feeds, self._form(plan))
        said = (plan.advice.note, plan.advice.reason if self.mark else "")
        if new != text and any(said):
            new = _marked_first(new, ", ".join(filter(None, said)), dialect)
        return new

    def _cycle_fed(self, block: int, text: str, fed_by: int | None) -> str:
        """Text of a block that gives cycles their feed."""
        dialect = self.program.dialect
        token = cycle_feed_token(text, dialect)
        feed = self.cycle_feeds[block]
        is_same = token is not None and _is_equal(token.value, feed)
        new = text if is_same else with_cycle_feed(text, feed, dialect=dialect)
        return new if fed_by is None else self._restored(block, new, fed_by)

    def _form(self, plan: _Plan) -> BlockForm:
        move, setting = self.moves.move(plan.row), plan.setting
        moving = {axis for axis in range(3) if abs(move.end[axis] - move.start[axis]) > 0.0}
        arc: tuple[int, ...] = ()
        if move.arc is not None:
            arc = tuple(sorted(move.arc.plane.axes[:2]))
            moving |= set(arc)
        return BlockForm(
            dialect=self.program.dialect,
            style=self.style,
            scale=self._scale(setting),
            is_relative=setting.is_relative,
            is_centre_absolute=setting.is_centre_absolute,
            axes=tuple(sorted(moving)),
            arc=arc,
        )

    def _restored(self, block: int, text: str, fed_by: int) -> str:
        """Text of a block with the programmed feed before or in it."""
        dialect, gap = self.program.dialect, self.style.gap
        source = self.program.text.block(fed_by)
        token = feed_token(source, dialect)
        assert token is not None
        word = source[token.start : token.end]
        kinds = self.moves.kind[self._fed.rows(block)]
        if (
            len(kinds)
            and (kinds != MoveKind.UNKNOWN).all()
            and feed_token(text, dialect) is None
            and not self._is_skippable(block)
        ):
            return with_feed(text, word, dialect=dialect, gap=gap)
        head = f"L{gap}" if dialect is Dialect.HEIDENHAIN else ""
        return f"{head}{word}{self.style.newline}{text}"


def _marked_first(text: str, reason: str, dialect: Dialect) -> str:
    """Several lines with a comment in the first."""
    first, newline, rest = text.partition("\n")
    return with_mark(first + newline, reason, dialect=dialect) + rest


def _is_equal(one: str | None, other: str | None) -> bool:
    """True if two numbers of F words are the same feed."""
    if one is None or other is None:
        return False
    a, b = float(one), float(other)
    return abs(a - b) <= EQUAL * max(abs(a), abs(b))


def _named(flags: MoveFlag) -> str:
    """Reasons that flags stand for."""
    return ", ".join(text for flag, text in REASONS.items() if flags & flag)
