"""Kept engagements of a tool path, read again where path and stock are the same.

A plan runs a program several times, and only feeds change between most of the runs. A path is
marched in groups of rows; what a group meets and leaves is kept under a digest of all that its
march reads: tool, rows, the cells within reach, the outlines of the moves that cleared them,
the last outlines, and where the tool cut last. Another path or stock therefore has another
digest, and nothing has to be thrown away. The answer is that of the march to the last bit.

Where a group ends follows from the ends of its rows alone, so behind a block that was split the
groups are those of the whole block again. Units mm.
"""

from dataclasses import dataclass
from hashlib import blake2b
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Floats, Segments
from simulator.removal.march import marched
from simulator.removal.rim import FORGETTING, RECENT
from simulator.removal.trial import Box, RemovalTask, box_of, row_boxes

GROUP = 512
"""Mean number of rows in a group; a power of 2."""

MOST_BYTES = 1 << 28
"""Memory for marches; beyond it no more are kept."""

MIXER = np.uint64(0x9E3779B97F4A7C15)
"""Odd number near 2⁶⁴ over the golden ratio, whose multiples spread evenly (Fibonacci hashing:
D. E. Knuth, The Art of Computer Programming, vol. 3, 6.4)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KeptMarch:
    """Engagements of a group of rows, and the stock that it left."""

    lines: Floats
    """Lines of its stations, with rows counted from the first of the group."""
    findings: Floats
    """Findings of its rows."""
    cells: NDArray[np.uint8]
    """Bits of the cells of its box, row by row: 1 where it lowered the stock."""
    heights: Floats
    """Their heights, mm."""
    owner: NDArray[np.int16]
    """Moves that lowered them, counted from the first of the group."""
    records: Floats
    """Outlines of its moves."""
    last: Floats
    """Position at which the tool cut last."""

    @property
    def size(self) -> int:
        """Memory, bytes."""
        arrays = self.lines, self.findings, self.cells, self.heights, self.owner, self.records
        return sum(each.nbytes for each in arrays)


class KeptMarches:
    """Marches of the runs of a program by the digests of what they read. Running state.

    Parameters
    ----------
    most : int
        Memory for them, bytes.
    is_once : bool
        Whether a march is forgotten when it has been read again, for a path that runs twice.
    """

    def __init__(self, most: int = MOST_BYTES, *, is_once: bool = False) -> None:
        self.again = 0
        """Number of rows that were read again."""
        self._most, self._is_once = most, is_once
        self._kept: dict[bytes, KeptMarch] = {}

    def marched(
        self, task: RemovalTask, segments: Segments, rows: Floats, out: Floats, findings: Floats
    ) -> list[Floats]:
        """Cut row after row like :func:`simulator.removal.march.marched`.

        Parameters
        ----------
        rows : (N, 13) array
            Their rows.
        out : (L, COLUMNS) array
            Room for lines.
        findings : (N, FINDINGS) array
            Findings, accumulated in place.

        Returns
        -------
        list of array
            Lines of the stations, with rows counted from the first.
        """
        parts: list[Floats] = []
        for begin, end in pairwise(_group_ends(rows)):
            group = segments[begin:end]
            lines = self._group(task, group, rows[begin:end], out, findings[begin:end]).copy()
            lines[:, 0] += begin
            parts.append(lines)
        return parts

    def _group(
        self, task: RemovalTask, segments: Segments, rows: Floats, out: Floats, findings: Floats
    ) -> Floats:
        """Cut a group of rows, or read again what it meets."""
        reach = _reach(task)
        box = box_of(task.grid, segments, reach)
        # What is cut far apart takes less time to march than its box takes to read.
        if _cells(box) > int(row_boxes(task.grid, segments, reach).sum()):
            return marched(task, rows, segments.length, out, findings)
        before = _Before(task, rows, box)
        kept = self._kept.get(before.digest)
        if kept is None:
            kept = before.after(marched(task, rows, segments.length, out, findings), findings)
            if before.remembers(len(kept.records)) and kept.size <= self._most:
                self._most -= kept.size
                self._kept[before.digest] = kept
        elif before.remembers(len(kept.records)):
            self.again += len(rows)
            before.put(kept, findings)
            if self._is_once:
                self._most += self._kept.pop(before.digest).size
        else:
            return marched(task, rows, segments.length, out, findings)
        return kept.lines


class _Before:
    """Stock within reach of a group of rows, before it is cut."""

    def __init__(self, task: RemovalTask, rows: Floats, box: Box) -> None:
        self.grid, self.past, self.box = task.grid, task.past, box
        self.heights = self.grid.heights[box].copy()
        self.next = int(self.past.next[0])
        # A move that is forgotten clears like none; where the stock ends follows from its size.
        none = min(self.next, FORGETTING) + 1
        ages = np.minimum(np.int32(self.next) - self.grid.owner[box], np.int32(none))
        is_seen = np.zeros(none + 1, dtype=np.bool_)
        is_seen[ages] = True
        is_seen[none] = False
        is_seen[1 : min(self.next, RECENT) + 1] = True
        known = np.flatnonzero(is_seen)
        self.oldest = int(known[-1]) if len(known) else 0
        names = np.cumsum(is_seen, dtype=np.int32)
        names[none] = 0
        hashed = blake2b(_setting(task, box), digest_size=16)
        for each in (
            rows,
            self.past.last,
            self.heights,
            names[ages],
            self.past.records[(self.next - known) % FORGETTING],
        ):
            hashed.update(np.ascontiguousarray(each).data.cast("B") if each.size else b"")
            hashed.update(each.size.to_bytes(8, "little"))
        self.digest = hashed.digest()

    def remembers(self, moves: int) -> bool:
        """True if the outlines that a group may use are remembered while it makes moves."""
        return self.oldest + moves <= FORGETTING

    def after(self, lines: Floats, findings: Floats) -> KeptMarch:
        """Engagements and changed cells of the march."""
        heights, owner = self.grid.heights[self.box], self.grid.owner[self.box]
        cells = heights != self.heights
        made = int(self.past.next[0]) - self.next
        return KeptMarch(
            lines=lines,
            findings=findings.copy(),
            cells=np.packbits(cells),
            heights=heights[cells],
            owner=(owner[cells] - np.int32(self.next)).astype(np.int16),
            records=self.past.records[(self.next + np.arange(made)) % FORGETTING],
            last=self.past.last.copy(),
        )

    def put(self, kept: KeptMarch, findings: Floats) -> None:
        """Leave the stock as the march left it, with its findings."""
        bits = np.unpackbits(kept.cells, count=self.heights.size)
        cells = bits.view(np.bool_).reshape(self.heights.shape)
        self.grid.heights[self.box][cells] = kept.heights
        self.grid.owner[self.box][cells] = np.int32(self.next) + kept.owner
        made = len(kept.records)
        self.past.records[(self.next + np.arange(made)) % FORGETTING] = kept.records
        self.past.next[0] += made
        self.past.last[:] = kept.last
        findings[:] = kept.findings


def _group_ends(rows: Floats) -> list[int]:
    """Rows at which groups begin, and the number of rows."""
    bits = np.ascontiguousarray(rows[:, 3:6]).view(np.uint64)
    mixed = np.zeros(len(rows), dtype=np.uint64)
    for axis in range(3):
        mixed = (mixed ^ bits[:, axis]) * MIXER
    is_last = mixed >> np.uint64(64 - GROUP.bit_length() + 1) == 0
    ends = np.flatnonzero(is_last[:-1]) + 1
    return [0, *ends.tolist(), len(rows)]


def _reach(task: RemovalTask) -> float:
    """Distance from its axis within which a tool with its holder may meet material, mm."""
    holder = task.how.holder.radius if np.isfinite(task.how.overhang) else 0.0
    return float(max(task.tool.profile.radius, holder))


def _cells(box: Box) -> int:
    """Number of cells of a box."""
    return (box[0].stop - box[0].start) * (box[1].stop - box[1].start)


def _setting(task: RemovalTask, box: Box) -> bytes:
    """Tool, settings, and place of the box in the stock, as bytes."""
    grid, tool, how = task.grid, task.tool, task.how
    numbers = (
        *tool.profile, tool.sine, tool.side, how.step, how.least, how.shank, how.coarse,
        *how.shape, *how.neck, *how.holder, how.overhang, how.tip_sine, *grid[2:],
        *grid.heights.shape, box[0].start, box[0].stop, box[1].start, box[1].stop,
    )  # fmt: skip
    return np.array(numbers, dtype=np.float64).tobytes()
