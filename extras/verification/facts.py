"""Rows of a verification: greatest deviations by workingstep, tolerance bands, resolution.

Surface of a verified part as a file, and a bounded number of its places as a map.

A map has the worst places and others evenly spread: of each cube of space the worst. What it
leaves out is counted.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from extras.verification.model.deviation import (
    SurfaceKind,
    SurfacePlaces,
    arc_uncertainty,
    corner_uncertainty,
    rounding_uncertainty,
    smallest_arc,
)
from extras.verification.model.surface import EXACT
from extras.verification.run import Verification
from service.files import write_atomically
from simulator.motion.segments import Bools, Floats, Ints

BANDS = (0.005, 0.01, 0.0254, 0.05, 0.1, 0.2, 0.5)
"""Half widths of the tolerance bands, mm."""

RAW = "raw part"
"""Name of the surface that the program does not cut."""

UNSEEN = (
    "deflection of tool, holder and workpiece: --with-deflection adds the predicted deflection "
    "of the tool",
    "the true radius, length, runout and wear of tools",
    "thermal growth of spindle and workpiece, and geometric errors beyond the scales",
    "backlash and lag that the scales do not measure, and chatter between samples",
    "how the workpiece was clamped: an offset of the whole part looks like another zero",
)
"""What position feedback cannot see."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviationSpot:
    """Greatest deviation of one sign on a surface."""

    size: float
    """Size of the deviation, mm."""
    uncertainty: float
    """mm"""
    least: float
    """Size that the deviation has at least, mm; not positive where it may be none."""
    position: tuple[float, float, float]
    """mm"""
    block: int
    """Block of the program that makes the surface there; 0: none."""
    time: float
    """Time of the nearest sample, s; NaN: none came near."""
    cut_by: str
    """Workingstep that the log shows then; empty: unknown."""

    @property
    def is_beyond(self) -> bool:
        """True if the deviation exceeds its uncertainty, or is certain by the samples alone."""
        return self.least > 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceDeviation:
    """Greatest gouge and excess on the walls or floors of a workingstep."""

    workingstep: str
    feature: str
    tool: int
    """Number of the tool; 0: unknown."""
    kind: SurfaceKind
    gouge: DeviationSpot
    excess: DeviationSpot
    area: float
    """Area of the surface, mm²."""
    beyond: float
    """Share of the area whose deviation exceeds its uncertainty."""

    nominal: tuple[float, float] | None
    """Least and greatest deviation of the logged surface from the nominal feature, mm: excess
    positive. None without a feature."""

    bent: float | None
    """Predicted deflection of the tool away from the wall, mm, which the log does not see: it
    comes on top of the excess. None where it is unknown."""

    @property
    def worse(self) -> DeviationSpot:
        """The one of both that exceeds its uncertainty by more."""
        pair = (self.gouge, self.excess)
        return max(pair, key=lambda spot: spot.least)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToleranceBand:
    """Share of the surface whose deviation is within ± a width."""

    width: float
    """Half width of the band, mm."""
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LogResolution:
    """Resolution of a log normal to a surface, mm."""

    step: float
    """Way of the tool between samples."""
    straight: float
    arc: float
    """On the smallest arc of the program."""
    radius: float
    """Radius of that arc; infinite without an arc, or without a program."""
    corner: float
    """At square corners."""


def surface_deviations(verification: Verification) -> Iterator[SurfaceDeviation]:
    """Yield the greatest deviations by workingstep, walls before floors."""
    places = verification.places
    for index in range(-1, len(verification.steps)):
        for is_wall in (True, False):
            rows = (places.workingstep == index) & (places.is_wall == is_wall)
            if rows.any():
                yield _surface(verification, index, is_wall, rows)


def _surface(
    verification: Verification, index: int, is_wall: bool, rows: Bools
) -> SurfaceDeviation:
    places, nominal = verification.places[rows], verification.nominal[rows]
    against = (places.deviation + nominal)[np.isfinite(nominal)]
    whole = float(places.area.sum())
    step = verification.steps[index] if index >= 0 else None
    return SurfaceDeviation(
        workingstep=step.workingstep if step else RAW,
        feature=step.feature if step else "",
        tool=step.tool if step else 0,
        kind=_kind(verification, is_wall),
        gouge=_spot(verification, places, -1.0),
        excess=_spot(verification, places, 1.0),
        area=whole,
        nominal=(float(against.min()), float(against.max())) if len(against) else None,
        bent=verification.bent.get(step.workingstep) if step and is_wall else None,
        beyond=float(places.area[places.is_beyond].sum()) / whole,
    )


def _kind(verification: Verification, is_wall: bool) -> SurfaceKind:
    if verification.is_turned:
        return SurfaceKind.FACE if is_wall else SurfaceKind.DIAMETER
    return SurfaceKind.WALL if is_wall else SurfaceKind.FLOOR


def _spot(verification: Verification, places: SurfacePlaces, sign: float) -> DeviationSpot:
    """Deviation of a sign with the greatest least size, or the nearest to its uncertainty."""
    size = np.maximum(sign * places.deviation, 0.0)
    least = np.where(size > 0.0, places.least, -places.uncertainty)
    row = int(least.argmax())
    x, y, z = places.position[row].tolist()
    by = int(places.cut_by[row])
    return DeviationSpot(
        size=float(size[row]),
        uncertainty=float(places.uncertainty[row]),
        least=float(least[row]),
        position=(x, y, z),
        block=int(places.block[row]),
        time=float(places.time[row]),
        cut_by=verification.steps[by].workingstep if by >= 0 else "",
    )


def tolerance_bands(verification: Verification) -> tuple[ToleranceBand, ...]:
    """Shares of the surface within bands of the deviation, by area."""
    places = verification.places
    whole, size = float(places.area.sum()), np.abs(places.deviation)
    return tuple(
        ToleranceBand(width=width, share=float(places.area[size <= width].sum()) / whole)
        for width in BANDS
    )


def log_resolution(verification: Verification) -> LogResolution:
    """Resolution of the log, from its usual step, its rounding and the limit of the method."""
    facts = verification.facts
    rounding = rounding_uncertainty(facts) + EXACT
    radius = inf if verification.path is None else smallest_arc(verification.path)
    return LogResolution(
        step=verification.step,
        straight=rounding,
        arc=rounding + arc_uncertainty(verification.step, radius),
        radius=radius,
        corner=rounding + corner_uncertainty(verification.step),
    )


COARSER = 1.25
"""Factor of the size of cubes while there are too many."""

FINEST = 0.3
"""Least factor of their size while there are far too few."""

ENOUGH = 0.6
"""Share of the places to show that is enough."""

MOST_TRIES = 24
"""Sizes of cubes that are tried; the first is at most 200 times too small."""

LEAST = "least_mm"
"""Column of the size that a deviation has at least."""

NUMBERS = ("x_mm", "y_mm", "z_mm", "deviation_mm", "uncertainty_mm", LEAST, "time_s")

TURNED = b"is_turned"
"""Key in the file's metadata: whether the part is turned."""

DECIMALS = 4
"""Decimals of the numbers of a map: 0.1 µm."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfaceMap:
    """P places on the surface of a part, of which some may be left out."""

    is_turned: bool
    """Whether positions are radius, 0 and z."""
    columns: dict[str, Floats | Ints]
    """Columns of the places, (P,) each; ``workingstep`` and ``kind`` as places in the names."""
    workingsteps: tuple[str, ...]
    kinds: tuple[str, ...]
    left_out: int
    """Number of places that are left out."""
    left_out_beyond: float
    """Greatest amount by which a deviation among them exceeds its uncertainty, mm; 0: none."""


def write_surface(path: Path, verification: Verification) -> None:
    """Write all places of a verification as Parquet.

    Raises
    ------
    WriteError
        When the disk refuses.
    """
    places = verification.places
    numbers = (
        *places.position.T, places.deviation, places.uncertainty, places.least, places.time,
    )  # fmt: skip
    columns: dict[str, pa.Array] = {
        name: pa.array(values.astype(np.float32))
        for name, values in zip(NUMBERS, numbers, strict=True)
    }
    columns["block"] = pa.array(places.block.astype(np.int32))
    names = [*(step.workingstep for step in verification.steps), RAW]
    steps = np.where(places.workingstep < 0, len(names) - 1, places.workingstep)
    columns["workingstep"] = _words(steps, names)
    kinds = (
        (SurfaceKind.DIAMETER, SurfaceKind.FACE)
        if verification.is_turned
        else (SurfaceKind.FLOOR, SurfaceKind.WALL)
    )
    columns["kind"] = _words(places.is_wall.astype(np.int64), [kind.value for kind in kinds])
    table = pa.table(columns).replace_schema_metadata({
        TURNED: str(int(verification.is_turned))
    })
    sink = pa.BufferOutputStream()
    parquet.write_table(table, sink, compression="zstd")
    write_atomically(path, sink.getvalue())


def _words(rows: Ints, names: list[str]) -> pa.DictionaryArray:
    return pa.DictionaryArray.from_arrays(pa.array(rows.astype(np.int32)), pa.array(names))


def read_map(path: Path, *, most: int) -> SurfaceMap:
    """Read at most a number of places of a file that :func:`write_surface` has written.

    Raises
    ------
    FileNotFoundError
        When the file does not exist.
    """
    table = parquet.read_table(path)
    if LEAST not in table.column_names:  # maps of earlier versions
        table = table.append_column(LEAST, _beyond(table))
    position = np.column_stack([table.column(name).to_numpy() for name in NUMBERS[:3]])
    beyond = table.column(LEAST).to_numpy()
    rows = shown_rows(position, beyond, most=most)
    omitted = np.delete(beyond, rows)
    names: dict[str, tuple[str, ...]] = {}
    columns: dict[str, Floats | Ints] = {}
    for name in ("workingstep", "kind"):
        words = table.column(name).combine_chunks()
        words = words.chunk(0) if isinstance(words, pa.ChunkedArray) else words
        names[name] = tuple(words.dictionary.to_pylist())
        columns[name] = words.indices.to_numpy()[rows]
    for name in NUMBERS:
        values = table.column(name).to_numpy()[rows].astype(np.float64)
        columns[name] = np.round(values, DECIMALS)
    columns["block"] = table.column("block").to_numpy()[rows]
    return SurfaceMap(
        is_turned=bool(int(table.schema.metadata[TURNED])),
        columns=columns,
        workingsteps=names["workingstep"],
        kinds=names["kind"],
        left_out=len(omitted),
        left_out_beyond=float(omitted.max(initial=0.0)),
    )


def _beyond(table: pa.Table) -> pa.Array:
    """By how much the size of each deviation exceeds its uncertainty, mm."""
    size = np.abs(table.column("deviation_mm").to_numpy())
    return pa.array(size - table.column("uncertainty_mm").to_numpy())


def shown_rows(position: Floats, beyond: Floats, *, most: int) -> Ints:
    """Rows of at most a number of places: the worst, and the worst of each cube of space.

    Half of them may be the worst of all, if so many exceed their uncertainty.

    Parameters
    ----------
    position : (N, 3) array, mm
    beyond : (N,) array, mm
        By how much the size of each deviation exceeds its uncertainty.
    most : int
    """
    count = len(beyond)
    if count <= most:
        return np.arange(count)
    seen = min(int(np.sum(beyond > 0.0)), most // 2)
    worst = np.argpartition(beyond, count - seen - 1)[count - seen :]
    even = _evenly(position, np.argsort(beyond, kind="stable")[::-1], most=most - seen)
    return np.unique(np.concatenate((worst, even)))


def _evenly(position: Floats, order: Ints, *, most: int) -> Ints:
    """Rows of at most a number of places, the first in an order of each cube of space.

    Cubes get larger until there are few enough, and smaller while there are far too few: places
    lie on surfaces, or on a profile.
    """
    low, spans = position.min(axis=0), np.ptp(position, axis=0) + 1e-6
    area = 2.0 * (spans[0] * spans[1] + spans[1] * spans[2] + spans[2] * spans[0])
    size, found = float(np.sqrt(area / most)), order[:1]
    for _ in range(MOST_TRIES):
        cells = np.floor((position[order] - low) / size).astype(np.int64)
        wide, deep = cells[:, 1].max() + 1, cells[:, 2].max() + 1
        keys = (cells[:, 0] * wide + cells[:, 1]) * deep + cells[:, 2]
        _, first = np.unique(keys, return_index=True)
        if len(first) > most:
            size *= COARSER
            if len(found) > 1:
                break
        else:
            found = order[first]
            if len(found) > ENOUGH * most:
                break
            size *= max(float(np.sqrt(len(found) / most)), FINEST)
    return found
