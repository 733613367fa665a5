"""Designs of experiments: which settings, and which program, machine and material, a row has.

A row depends on the design and its own number alone, so that a data set can be made longer, or
in pieces, and has the same rows. Uniform: independent draws. Latin hypercube: within each block
of ``BLOCK`` rows every setting takes each of ``BLOCK`` equal parts of its range once. Full
factorial: all combinations of levels, the last factor varying fastest. Units mm/s, rev/s, mm.
A tool diameter replaces that of the program's tool; flank wear is that of each tool at the
start.

References
----------
.. [1] M. D. McKay, R. J. Beckman, W. J. Conover, "A Comparison of Three Methods for Selecting
   Values of Input Variables in the Analysis of Output from a Computer Code", Technometrics 21
   (1979), pp. 239-245.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import count, islice
from math import prod

import numpy as np

from extras.factory.model.streams import Streams
from simulator.motion.segments import Floats
from stepnc_model.editing.cut_settings import CutSettings

BLOCK = 100
"""Rows of one Latin hypercube."""

FACTORS, CATEGORIES = 8, 3
"""Factors of a design; the first three are categories."""


class DesignKind(StrEnum):
    """Kind of a design of experiments."""

    UNIFORM = "uniform"
    LATIN_HYPERCUBE = "latin-hypercube"
    FULL_FACTORIAL = "full-factorial"


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorRange:
    """Range of a setting, from 0 on.

    Raises
    ------
    ValueError
        If it does not rise.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.low < self.high:
            raise ValueError(f"range {self.low:g} to {self.high:g} must rise from 0 on")


@dataclass(frozen=True, slots=True, kw_only=True)
class RowSettings:
    """Settings of one part; None where the program's own value stays."""

    cut: CutSettings
    tool_diameter: float | None = None
    """mm"""
    flank_wear: float | None = None
    """Flank wear of each tool when the program starts, mm; None: sharp."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignRow:
    """One row of a design."""

    number: int
    """From 0."""
    program: int
    """Place among the programs."""
    machine: int
    material: int
    settings: RowSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class ExperimentDesign:
    """Factors of an experiment: categories, and ranges of settings; None: the program's own."""

    kind: DesignKind
    seed: int
    programs: int = 1
    """Number of programs among which a row chooses."""
    machines: int = 1
    materials: int = 1
    feed: FactorRange | None = None
    """mm/s"""
    spindle_speed: FactorRange | None = None
    """Size of the spindle speed, rev/s; the spindle turns clockwise, which is negative."""
    depth: FactorRange | None = None
    """mm"""
    tool_diameter: FactorRange | None = None
    """mm"""
    flank_wear: FactorRange | None = None
    """mm"""
    levels: int = 1
    """Values of each setting in a full factorial."""

    @property
    def size(self) -> int | None:
        """Number of rows that the design has; None: as many as are asked for."""
        return prod(self._counts) if self.kind is DesignKind.FULL_FACTORIAL else None

    @property
    def ends(self) -> tuple[RowSettings, RowSettings]:
        """Least and greatest settings of the design."""
        low, high = (self._settings([place] * len(self._ranges)) for place in (0.0, 1.0))
        return low, high

    def rows(self, first: int, last: int) -> Iterator[DesignRow]:
        """Rows from number ``first`` to before ``last``.

        Raises
        ------
        ValueError
            If the design has fewer rows.
        """
        if self.size is not None and last > self.size:
            raise ValueError(f"{last} rows exceed {self.size}, all combinations of the design")
        for number, places in zip(range(first, last), self._places(first), strict=False):
            yield self._row(number, places)

    @property
    def _ranges(self) -> tuple[FactorRange | None, ...]:
        """Ranges of the settings, in the order of the factors."""
        return (self.feed, self.spindle_speed, self.depth, self.tool_diameter, self.flank_wear)

    @property
    def _counts(self) -> tuple[int, ...]:
        """Values of each factor of a full factorial."""
        settings = (1 if each is None else self.levels for each in self._ranges)
        return (self.programs, self.machines, self.materials, *settings)

    def _places(self, first: int) -> Iterator[Floats]:
        """Places of the rows from a number on, each from 0 to 1 for all factors."""
        match self.kind:
            case DesignKind.UNIFORM:
                return (self._stream(row, "row").random(FACTORS) for row in count(first))
            case DesignKind.LATIN_HYPERCUBE:
                start, skipped = divmod(first, BLOCK)
                rows = (place for block in count(start) for place in self._block(block))
                return islice(rows, skipped, None)
            case DesignKind.FULL_FACTORIAL:
                return (self._combination(row) for row in count(first))

    def _stream(self, number: int, purpose: str) -> np.random.Generator:
        return Streams(seed=self.seed, replication=number).generator("design", purpose)

    def _block(self, number: int) -> Floats:
        """Latin hypercube of one block, (BLOCK, FACTORS)."""
        stream = self._stream(number, "block")
        parts = np.stack([stream.permutation(BLOCK) for _ in range(FACTORS)], axis=1)
        places: Floats = (parts + stream.random(parts.shape)) / BLOCK
        return places

    def _combination(self, row: int) -> Floats:
        """Places of one combination: middles of categories, equal steps of settings."""
        places = np.zeros(FACTORS)
        for factor in reversed(range(FACTORS)):
            size = self._counts[factor]
            row, value = divmod(row, size)
            is_category = factor < CATEGORIES
            places[factor] = (value + 0.5) / size if is_category else value / max(1, size - 1)
        return places

    def _row(self, number: int, places: Floats) -> DesignRow:
        program, machine, material, *settings = places.tolist()
        return DesignRow(
            number=number,
            program=int(program * self.programs),
            machine=int(machine * self.machines),
            material=int(material * self.materials),
            settings=self._settings(settings),
        )

    def _settings(self, places: list[float]) -> RowSettings:
        """Settings at places of their ranges."""
        feed, turning, depth, diameter, wear = map(_within, self._ranges, places)
        return RowSettings(
            cut=CutSettings(
                feed=feed,
                spindle_speed=None if turning is None else -turning,
                depth=depth,
            ),
            tool_diameter=diameter,
            flank_wear=wear,
        )


def _within(setting: FactorRange | None, place: float) -> float | None:
    """Value at a place of a range."""
    if setting is None:
        return None
    return setting.low + place * (setting.high - setting.low)
