"""Remaining stock as a file: the height map of a mill, or the radii of a lathe.

A NumPy archive (``.npz``) of arrays without Python objects: ``version``, ``bounds`` (x, y and z
of the low and of the high corner, and the radius of a bar or 0, mm), and ``heights`` (X, Y), or
``outer`` and ``inner`` (C,), mm. Coordinates are those of the setup in which it was cut.
"""

from collections.abc import Mapping
from io import BytesIO
from zipfile import ZipFile

import numpy as np

from simulator.errors import LibraryError
from simulator.motion.segments import Floats
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.zmap import MOST_CELLS, HeightGrid, zmap_of_heights
from stepnc_model.programs.program import Stock
from stepnc_model.zip_member import DAMAGES, read_member

VERSION = 1

MOST_BYTES = 16 * MOST_CELLS
"""Greatest size of the arrays of a file, bytes."""

FARTHEST = 1e5
"""Greatest distance of a stock from zero, mm."""

SLACK = 1e-6
"""Distance by which heights and radii may lie beyond the bounds, mm."""

LEAST_RADIUS = 0.01
"""Radius of the bounds of a bar of which nothing is left, mm."""

BOUNDS = 7


def stock_bytes(stock: MillingStock | TurningStock) -> bytes:
    """Content of a file that keeps a stock."""
    into, version = BytesIO(), np.array([float(VERSION)])
    if isinstance(stock, MillingStock):
        grid = stock.map.grid
        np.savez_compressed(
            into, version=version, bounds=_bounds_of(grid), heights=grid.heights
        )
    else:
        np.savez_compressed(
            into,
            version=version,
            bounds=_bounds_of_bar(stock),
            outer=stock.outer,
            inner=stock.inner,
        )
    return into.getvalue()


def _bounds_of_bar(stock: TurningStock) -> Floats:
    radius, half = max(float(stock.outer.max()), LEAST_RADIUS), 0.5 * stock.cell
    low, high = float(stock.z[0]) - half, float(stock.z[-1]) + half
    return np.array([-radius, -radius, low, radius, radius, high, radius])


def _bounds_of(grid: HeightGrid) -> Floats:
    columns, rows = grid.heights.shape
    high = grid.x + columns * grid.dx, grid.y + rows * grid.dy
    return np.array([grid.x, grid.y, grid.bottom, *high, grid.top, grid.radius])


def kept_stock(data: bytes, name: str) -> tuple[Stock, MillingStock | TurningStock]:
    """Read a stock that an earlier run kept.

    Parameters
    ----------
    data : bytes
        Content of the file.
    name : str
        Name of the file, for messages.

    Returns
    -------
    bounds : Stock
        Box or bar around it.
    stock : MillingStock or TurningStock

    Raises
    ------
    LibraryError
        If the file is damaged, of another version, or has values out of their bounds.
    """
    arrays = _arrays(data, name)
    version = float(_array(arrays, "version", (1,), name)[0])
    if version != VERSION:
        message = f"version {version:g} of a kept stock; only {VERSION} can be read"
        raise LibraryError(message, path=name, key="version")
    bounds = _bounds(_array(arrays, "bounds", (BOUNDS,), name), name)
    if "heights" in arrays:
        return bounds, _milled(arrays["heights"], bounds, name)
    return bounds, _turned(arrays, bounds, name)


def _arrays(data: bytes, name: str) -> dict[str, Floats]:
    """Arrays of an archive; each is checked before room is made for it."""
    found: dict[str, Floats] = {}
    try:
        with ZipFile(BytesIO(data)) as archive:
            size = sum(each.file_size for each in archive.infolist())
            if size > MOST_BYTES:
                message = f"arrays of {size} bytes; at most {MOST_BYTES} are accepted"
                raise LibraryError(message, path=name)
            for each in archive.infolist():
                content = read_member(archive, each, most=each.file_size)
                found[each.filename.removesuffix(".npy")] = _parsed(content)
    except DAMAGES as error:
        raise LibraryError(f"is not a kept stock: {error}", path=name) from error
    return found


def _parsed(content: bytes) -> Floats:
    """Array of 64-bit numbers from the form of ``numpy.lib.format``."""
    stream = BytesIO(content)
    if np.lib.format.read_magic(stream) != (1, 0):
        raise ValueError("an array of an unknown version")
    shape, is_transposed, kind = np.lib.format.read_array_header_1_0(stream)
    values = content[stream.tell() :]
    if (
        kind != np.float64
        or is_transposed
        or len(values) != 8 * int(np.prod(shape, dtype=object))
    ):
        raise ValueError("an array that is not of 64-bit numbers, row by row")
    return np.frombuffer(values, dtype=np.float64).reshape(shape).copy()


def _array(arrays: Mapping[str, Floats], key: str, shape: tuple[int, ...], name: str) -> Floats:
    """Array of a shape, all finite."""
    if key not in arrays:
        raise LibraryError(f"missing; the file has {', '.join(arrays)}", path=name, key=key)
    array = arrays[key]
    if array.shape != shape:
        message = f"shape {array.shape}; expected {shape}"
        raise LibraryError(message, path=name, key=key)
    if not np.isfinite(array).all():
        raise LibraryError("a value is not finite", path=name, key=key)
    return array


def _bounds(values: Floats, name: str) -> Stock:
    low, high, radius = values[:3].tolist(), values[3:6].tolist(), float(values[6])
    for axis, one, other in zip("xyz", low, high, strict=True):
        if not -FARTHEST <= one < other <= FARTHEST:
            message = (
                f"{axis} from {one:g} to {other:g} mm must ascend, within {FARTHEST:g} mm of "
                "zero"
            )
            raise LibraryError(message, path=name, key="bounds")
    if not 0.0 <= radius <= FARTHEST:
        message = f"radius {radius:g} mm must be 0 to {FARTHEST:g} mm"
        raise LibraryError(message, path=name, key="bounds")
    return Stock(low=tuple(low), high=tuple(high), radius=radius or None)


def _milled(heights: Floats, bounds: Stock, name: str) -> MillingStock:
    if heights.ndim != 2 or not 0 < heights.size <= MOST_CELLS:
        message = f"shape {heights.shape}; expected two sides with at most {MOST_CELLS} cells"
        raise LibraryError(message, path=name, key="heights")
    _require_between(heights, bounds.low[2], bounds.high[2], name=name, key="heights")
    return MillingStock(zmap_of_heights(heights, bounds))


def _turned(arrays: Mapping[str, Floats], bounds: Stock, name: str) -> TurningStock:
    outer = arrays.get("outer", np.empty(0))
    if outer.ndim != 1 or not len(outer) or bounds.radius is None:
        message = "missing; expected heights, or outer and inner radii of a bar"
        raise LibraryError(message, path=name, key="outer")
    inner = _array(arrays, "inner", outer.shape, name)
    _require_between(outer, 0.0, bounds.radius, name=name, key="outer")
    _require_between(outer - inner, 0.0, bounds.radius, name=name, key="outer - inner")
    _require_between(inner, 0.0, bounds.radius, name=name, key="inner")
    try:
        bar = TurningStock(bounds, (bounds.high[2] - bounds.low[2]) / len(outer))
    except ValueError as error:
        raise LibraryError(str(error), path=name, key="outer") from error
    bar.take(BarRadii(outer=outer, inner=inner))
    return bar


def _require_between(values: Floats, low: float, high: float, *, name: str, key: str) -> None:
    """Refuse values beyond their bounds, or that are not finite."""
    beyond = ~((values >= low - SLACK) & (values <= high + SLACK))
    if beyond.any():
        value = float(values[beyond][0])
        message = f"{value:g} mm is not between {low:g} and {high:g} mm"
        raise LibraryError(message, path=name, key=key)
