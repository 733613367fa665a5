"""Machining cycles of a program as a function of its cutting settings, interpolated.

Layers change stepwise with the depth, so each number of layers has a table of its own; the
depths at which it changes are found from the tool paths, by bisection, and no run is needed for
that. Within a table the runs lie on the points of a Chebyshev grid in 1/feed, spindle speed
and, where it matters, depth. Time, total energy, peak power, profile and the motors' energy of
every movement are polynomials through them.

Exact: the layers, and every value at the points of the grid. Interpolated: all values between
them. Points that are on no grid are run as well, and a table is refined until time and energy
agree with them within half the tolerance; if they do not, the table is refused. The peak power
is a maximum, which may have an edge where another movement becomes the greatest: its error is
told and not bounded. The tolerance is tested at the points that were run; it is no proof for
all others.

Because the values are linear in the polynomials, so is the energy with a random deviation: the
factors of the movements of a part are multiplied with the coefficients of their energies.
Units mm, s, J, W, rev/s.

References
----------
.. [1] L. N. Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, chs. 2-4:
   interpolation in Chebyshev points.
"""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from extras.factory.model.cycle import MOST_DRAWN, PartCycle
from simulator.errors import SimulationError
from simulator.motion.segments import Floats, Ints
from simulator.spec import PowerDeviation
from stepnc_model.editing.cut_settings import CutSettings

TOLERANCE = 0.01
"""Greatest permitted relative error of time and energy at points that are on no grid."""

ORDERS = (2, 3, 4, 6, 8)
"""Orders of the polynomials in each setting that are tried, one after another."""

HELD_OUT = 12
"""Number of points of each table that are run and not used for it."""

HELD_SHARE = 0.5
"""Share of the tolerance that these few points may use; others may be off by more."""

DEPTHS = 9
"""Number of depths whose layers are compared first. The number of layers falls with the depth,
so that between two depths with equal layers there are no others."""

NARROW = 1e-6
"""Width of a range of depths, over the whole range, that is not divided further."""

SAME = 1e-9
"""Relative difference below which the depth counts as without influence."""

Runs = Callable[[CutSettings], PartCycle]
Layers = Callable[[float], Hashable]


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingRange:
    """Range of one setting, both ends included.

    Raises
    ------
    ValueError
        Unless 0 < low ≤ high.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        if not 0.0 < self.low <= self.high < float("inf"):
            raise ValueError(f"range {self.low:g} to {self.high:g} must be positive and rise")


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsDesign:
    """Settings for which a table is made; None: the program's own value."""

    feed: SettingRange | None = None
    """Feed, mm/s."""
    spindle_speed: SettingRange | None = None
    """Size of the spindle speed, rev/s."""
    depth: SettingRange | None = None
    """Depth of one pass, mm."""
    is_clockwise: bool = True
    """Whether the spindle turns clockwise, which is a negative speed."""

    def settings(self, row: Floats) -> CutSettings:
        """Settings of one row of 1/feed, spindle speed and depth; NaN for none."""
        slowness, speed, depth = (None if np.isnan(each) else float(each) for each in row)
        sense = -1.0 if self.is_clockwise else 1.0
        return CutSettings(
            feed=None if slowness is None else 1.0 / slowness,
            spindle_speed=None if speed is None else sense * speed,
            depth=depth,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CycleValues:
    """Values of the cycles of N parts."""

    time: Floats
    """Machining time, (N,), s."""
    energy: Floats
    """Electrical energy without deviation, (N,), J."""
    peak_power: Floats
    """Greatest total power, (N,), W."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LayerTable:
    """Polynomials of the cycles with one number of layers."""

    low: Floats
    """Lower ends of 1/feed, spindle speed and depth, (3,)."""
    high: Floats
    orders: tuple[int, int, int]
    """Orders of the polynomials; 0 where a setting does not matter."""
    values: Floats
    """Coefficients of time, energy and peak power, (B, 3)."""
    profile: Floats
    """Coefficients of the energy profile, (B, K + 1)."""
    traverse: Floats
    """Coefficients of the motors' energies in rapid movements, (B, T)."""
    feed: Floats
    """Coefficients of the motors' energies in feed movements, (B, F)."""

    def basis(self, points: Floats) -> Floats:
        """Products of Chebyshev polynomials at N points, (N, B)."""
        return _basis(_scaled(points, self.low, self.high), self.orders)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CycleTable:
    """Interpolated machining cycles of one program on one machine."""

    design: SettingsDesign
    tables: tuple[LayerTable, ...]
    """Tables by number of layers, with rising depths."""
    bounds: Floats
    """Depths at which the layers change, (C - 1,), mm, rounded down by at most ``NARROW`` of
    the range: a depth that divides the whole depth has the layers of greater depths."""
    runs: int
    """Number of runs of the virtual machine that were made."""
    time_error: float
    """Greatest relative error of the time at the points held out."""
    energy_error: float
    """Greatest relative error of the energy at the points held out."""
    peak_error: float
    """Greatest relative error of the peak power at the points held out."""

    def values(self, feed: Floats, spindle_speed: Floats, depth: Floats) -> CycleValues:
        """Time, energy and peak power of N parts.

        Parameters
        ----------
        feed : (N,) array, mm/s
        spindle_speed : (N,) array, rev/s
            Of either sign; its size counts.
        depth : (N,) array, mm
            Settings that the design leaves to the program are not looked at.

        Raises
        ------
        ValueError
            If a setting is outside the design.
        """
        points, which = self._points(feed, spindle_speed, depth)
        found = np.zeros((len(points), 3))
        for row, table in enumerate(self.tables):
            at = slice(None) if len(self.tables) == 1 else np.flatnonzero(which == row)
            found[at] = table.basis(points[at]) @ table.values
        time, energy, peak = found.T
        return CycleValues(time=time, energy=energy, peak_power=peak)

    def drawn_energies(
        self,
        feed: Floats,
        spindle_speed: Floats,
        depth: Floats,
        *,
        deviation: PowerDeviation,
        rng: np.random.Generator,
    ) -> Floats:
        """Energies of N parts whose movements deviate at random and independently.

        The sum over the movements is exact; their energies are interpolated.

        Parameters
        ----------
        feed, spindle_speed, depth : (N,) array
            As in :meth:`values`.
        rng : numpy.random.Generator

        Returns
        -------
        (N,) array, J
        """
        points, which = self._points(feed, spindle_speed, depth)
        energies = np.zeros(len(points))
        for row, table in enumerate(self.tables):
            widths = np.concatenate(
                (deviation.traverse * table.traverse, deviation.feed * table.feed), axis=1
            )
            every = np.flatnonzero(which == row)
            size = max(1, MOST_DRAWN // max(1, widths.shape[1]))
            for first in range(0, len(every), size):
                at = every[first : first + size]
                basis = table.basis(points[at])
                factors = rng.uniform(-1.0, 1.0, (len(at), widths.shape[1]))
                drawn = np.einsum("nb,nb->n", basis, factors @ widths.T)
                energies[at] = basis @ table.values[:, 1] + drawn
        return energies

    def cycle(self, settings: CutSettings) -> PartCycle:
        """Cycle of one part, with its profile and the energies of its movements.

        Raises
        ------
        ValueError
            If a setting is outside the design.
        """
        row = [
            np.array([np.nan if value is None else value])
            for value in (settings.feed, settings.spindle_speed, settings.depth)
        ]
        points, which = self._points(*row)
        table = self.tables[int(which[0])]
        basis = table.basis(points)[0]
        time, energy, peak = (float(each) for each in basis @ table.values)
        return PartCycle(
            time=time,
            energy=energy,
            peak_power=peak,
            traverse_energies=basis @ table.traverse,
            feed_energies=basis @ table.feed,
            profile=np.maximum.accumulate(np.clip(basis @ table.profile, 0.0, 1.0)),
        )

    def _points(
        self, feed: Floats, spindle_speed: Floats, depth: Floats
    ) -> tuple[Floats, Ints]:
        """Points of the tables, (N, 3), and the table of each, (N,)."""
        design = self.design
        points = np.zeros((len(feed), 3))
        for column, name, value, within in (
            (0, "feed", feed, design.feed),
            (1, "spindle speed", np.abs(spindle_speed), design.spindle_speed),
            (2, "depth", depth, design.depth),
        ):
            if within is None:
                points[:, column] = np.nan
                continue
            is_within = (value >= within.low * (1.0 - SAME)) & (
                value <= within.high * (1.0 + SAME)
            )
            if not is_within.all():
                bad = float(value[~is_within][0])
                raise ValueError(f"{name} {bad:g} is outside {within.low:g} to {within.high:g}")
            points[:, column] = 1.0 / value if column == 0 else value
        which = np.searchsorted(self.bounds, points[:, 2], side="left")
        return points, which if design.depth is not None else np.zeros(len(feed), np.int64)


def cycle_table(
    design: SettingsDesign, run: Runs, layers: Layers, *, tolerance: float = TOLERANCE
) -> CycleTable:
    """Interpolate machining cycles from runs over a design of settings.

    Parameters
    ----------
    run : callable
        Runs the virtual machine with given settings.
    layers : callable
        What tells the layers of a depth apart, such as the number of moves of the tool path.
    tolerance : float
        Greatest permitted relative error of time and energy at points held out.

    Raises
    ------
    SimulationError
        If no order of the polynomials keeps half the tolerance, with the errors found.
    """
    ranges = _layer_ranges(design.depth, layers)
    built = [_layer_table(design, within, run, tolerance) for within in ranges]
    return CycleTable(
        design=design,
        tables=tuple(each.table for each in built),
        bounds=np.array([within.high for within in ranges[:-1] if within is not None]),
        runs=sum(each.runs for each in built),
        time_error=max(each.errors[0] for each in built),
        energy_error=max(each.errors[1] for each in built),
        peak_error=max(each.errors[2] for each in built),
    )


def _layer_ranges(
    depth: SettingRange | None, layers: Layers
) -> tuple[SettingRange | None, ...]:
    """Ranges of the depth within which the layers stay the same, rising."""
    if depth is None:
        return (None,)
    width = depth.high - depth.low
    known: dict[float, Hashable] = {}

    def of(value: float) -> Hashable:
        if value not in known:
            known[value] = layers(value)
        return known[value]

    ends = [depth.low]
    pairs = list(pairwise(np.linspace(depth.low, depth.high, DEPTHS).tolist()))
    while pairs:
        low, high = pairs.pop(0)
        if low == high or of(low) == of(high):
            continue
        if high - low <= NARROW * width:
            ends += [low, high]
        else:
            middle = 0.5 * (low + high)
            pairs[:0] = [(low, middle), (middle, high)]
    ends.append(depth.high)
    return tuple(
        SettingRange(low=low, high=high)
        for low, high in zip(ends[::2], ends[1::2], strict=True)
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BuiltTable:
    """A table with what it cost and how well it holds."""

    table: LayerTable
    runs: int
    errors: tuple[float, float, float]
    """Greatest relative errors of time, energy and peak power at the points held out."""


def _layer_table(
    design: SettingsDesign, depth: SettingRange | None, run: Runs, tolerance: float
) -> BuiltTable:
    """Table of one number of layers, refined until it holds."""
    cube = _Cube(design=design, depth=depth, run=run)
    held = cube.held_out()
    truth = np.array([[each.time, each.energy, each.peak_power] for each in held.cycles])
    errors = np.full(3, np.inf)
    for order in ORDERS:
        table = cube.table(order)
        found = table.basis(held.points) @ table.values
        errors = np.abs(found / truth - 1.0).max(axis=0)
        if (errors[:2] <= HELD_SHARE * tolerance).all():
            time, energy, peak = (float(each) for each in errors)
            return BuiltTable(table=table, runs=len(cube.known), errors=(time, energy, peak))
    shown = "" if depth is None else f" at depths of {depth.low:.4g} to {depth.high:.4g} mm"
    raise SimulationError(
        f"cycles cannot be interpolated{shown}: {len(held.cycles)} points held out differ by "
        f"up to {100.0 * errors[0]:.2g} % in time and {100.0 * errors[1]:.2g} % in energy, at "
        f"most {100.0 * HELD_SHARE * tolerance:g} % are allowed; narrow the ranges of the "
        "settings"
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeldOutPoints:
    """Points that no grid has, and their cycles."""

    points: Floats
    cycles: tuple[PartCycle, ...]


class _Cube:
    """Runs over a box of 1/feed, spindle speed and depth. Running state."""

    def __init__(
        self, *, design: SettingsDesign, depth: SettingRange | None, run: Runs
    ) -> None:
        self.known: dict[tuple[float, ...], PartCycle] = {}
        self._design, self._run = design, run
        feed, speed = design.feed, design.spindle_speed
        spans = (
            None if feed is None else (1.0 / feed.high, 1.0 / feed.low),
            None if speed is None else (speed.low, speed.high),
            None if depth is None else (depth.low, depth.high),
        )
        ends = [(np.nan, np.nan) if span is None else span for span in spans]
        self.low, self.high = np.array(ends).T
        self._free = [span is not None and span[1] > span[0] for span in spans]
        self._free[2] = self._free[2] and self._depth_matters()

    def cycle(self, point: Floats) -> PartCycle:
        """Cycle at one point, run once."""
        key = tuple(float(each) for each in point)
        if key not in self.known:
            self.known[key] = self._run(self._design.settings(point))
        return self.known[key]

    def held_out(self) -> HeldOutPoints:
        """Points drawn in the box, the same each time."""
        rng = np.random.Generator(np.random.Philox(20180401))
        points = self.low + rng.random((HELD_OUT, 3)) * (self.high - self.low)
        if not any(self._free):
            points = points[:1]
        return HeldOutPoints(points=points, cycles=tuple(self.cycle(point) for point in points))

    def table(self, order: int) -> LayerTable:
        """Polynomials of an order through the runs on their Chebyshev grid."""
        orders = tuple(order if free else 0 for free in self._free)
        grid = np.meshgrid(*(_nodes(each) for each in orders), indexing="ij")
        scaled = np.stack([each.ravel() for each in grid], axis=1)
        points = 0.5 * (self.low + self.high) + 0.5 * scaled * (self.high - self.low)
        cycles = [self.cycle(point) for point in points]
        counts = {(len(each.traverse_energies), len(each.feed_energies)) for each in cycles}
        if len(counts) > 1:
            shown = ", ".join(f"{rapid} + {feed}" for rapid, feed in sorted(counts))
            raise SimulationError(
                f"cycles cannot be interpolated: runs with the same layers have {shown} rapid "
                "and feed movements"
            )
        first, second, third = orders
        basis = _basis(scaled, (first, second, third))

        def fitted(values: list[Floats]) -> Floats:
            solved = np.linalg.solve(basis, np.array(values))
            return solved.astype(np.float64)

        return LayerTable(
            low=self.low,
            high=self.high,
            orders=(first, second, third),
            values=fitted([
                np.array([each.time, each.energy, each.peak_power]) for each in cycles
            ]),
            profile=fitted([each.profile for each in cycles]),
            traverse=fitted([each.traverse_energies for each in cycles]),
            feed=fitted([each.feed_energies for each in cycles]),
        )

    def _depth_matters(self) -> bool:
        """True if the depth changes the cycle while the layers stay the same."""
        middle = 0.5 * (self.low + self.high)
        ends = [
            self.cycle(np.array([middle[0], middle[1], depth]))
            for depth in (self.low[2], self.high[2])
        ]
        one, other = (np.array([each.time, each.energy]) for each in ends)
        return bool((np.abs(one - other) > SAME * np.abs(one)).any())


def _nodes(order: int) -> Floats:
    """Chebyshev points of the second kind on -1 to 1, ends included; 0 for order 0."""
    if order == 0:
        return np.zeros(1)
    nodes: Floats = np.cos(np.pi * np.arange(order + 1) / order).astype(np.float64)
    return nodes


def _scaled(points: Floats, low: Floats, high: Floats) -> Floats:
    """Points on -1 to 1 in each setting; 0 where a setting has no range."""
    span = high - low
    width = np.where(span > 0.0, span, 1.0)
    scaled = np.where(span > 0.0, (2.0 * points - low - high) / width, 0.0)
    return np.clip(scaled, -1.0, 1.0)


def _basis(scaled: Floats, orders: tuple[int, int, int]) -> Floats:
    """Products of Chebyshev polynomials of three settings, (N, B)."""
    parts = [
        np.polynomial.chebyshev.chebvander(scaled[:, column], order)
        for column, order in enumerate(orders)
    ]
    products = parts[0][:, :, None, None] * parts[1][:, None, :, None]
    products = products * parts[2][:, None, None, :]
    size = (orders[0] + 1) * (orders[1] + 1) * (orders[2] + 1)
    basis: Floats = products.reshape(len(scaled), size)
    return basis
