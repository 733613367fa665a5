"""Picture of tool paths, coloured by the type of each move."""

import io
from collections.abc import Iterator, Sequence
from itertools import groupby
from math import ceil

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stepnc_model.program import Stock
from stepnc_model.toolpath.path import MoveType, Point, ToolPath, points_along

COLOURS = {
    MoveType.RAPID: "#9aa0a6",
    MoveType.APPROACH: "#e8710a",
    MoveType.RETRACT: "#a142f4",
    MoveType.NO_CONTACT: "#12b5cb",
    MoveType.CONTACT: "#1a56b0",
}
"""Colours of moves: grey for rapids, warm colours for approach and retract, blue for cuts."""

STEP = 0.05
"""Angle between two drawn points of an arc, in rad."""

COLUMNS = 4

View = tuple[int, int]
"""Axes drawn to the right and upwards."""

LEAST_EXTENT = 1.0
"""Smallest extent of a path seen from above, in mm; smaller ones are drawn from the front."""

MOST_PANELS = 40
"""Most workingsteps that get a panel each; with more, only the overall view is drawn."""


def path_png(
    paths: Sequence[ToolPath], stock: Stock | None, clamps: Sequence[Point] = (), *, title: str
) -> bytes:
    """Draw the program from above, or along the lathe's axis, and each workingstep alone."""
    shown = [path for path in paths if path.moves]
    panels = shown if len(shown) <= MOST_PANELS else []
    rows = ceil(len(panels) / COLUMNS)
    mpl.use("Agg")
    figure = Figure(figsize=(16.0, 6.5 + 3.6 * rows), layout="constrained")
    grid = figure.add_gridspec(rows + 2, COLUMNS)
    overall = figure.add_subplot(grid[:2, :])
    for path in shown:
        _draw(overall, path, (2, 0) if path.is_turning else (0, 1))
    _stock(overall, stock, is_turning=any(path.is_turning for path in shown))
    across, up = (2, 0) if any(path.is_turning for path in shown) else (0, 1)
    xs, ys = [clamp[across] for clamp in clamps], [clamp[up] for clamp in clamps]
    overall.plot(xs, ys, "x", color="#5f6368", markersize=9, markeredgewidth=2)
    overall.set_title(title)
    used = [kind for kind in MoveType if any(_has(path, kind) for path in shown)]
    handles = [Line2D([], [], color=COLOURS[kind], label=kind.value) for kind in used]
    handles.append(Line2D([], [], color="#5f6368", linestyle="--", label="stock"))
    if clamps:
        clamp = Line2D([], [], color="#5f6368", marker="x", linestyle="", label="clamping")
        handles.append(clamp)
    overall.legend(handles=handles, loc="upper right")
    for index, path in enumerate(panels):
        axes = figure.add_subplot(grid[2 + index // COLUMNS, index % COLUMNS])
        _draw(axes, path)
        axes.set_title(path.id, fontsize=9)
        axes.tick_params(labelsize=7)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return buffer.getvalue()


def _has(path: ToolPath, kind: MoveType) -> bool:
    return any(move.type is kind for move in path.moves)


def _draw(axes: Axes, path: ToolPath, view: View | None = None) -> None:
    """Draw the moves of a path grouped by type, cuts on top."""
    across, up = view or _view(path)
    for kind, points in _runs(path):
        order = 3 if kind is MoveType.CONTACT else 2
        axes.plot(
            [point[across] for point in points],
            [point[up] for point in points],
            color=COLOURS[kind],
            linewidth=0.9,
            zorder=order,
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"{'xyz'[across]}, mm", fontsize=8)
    axes.set_ylabel(f"{'xyz'[up]}, mm", fontsize=8)


def _view(path: ToolPath) -> View:
    """View of a path: lathe along the axis, mill from above, vertical paths from the front."""
    if path.is_turning:
        return 2, 0
    ends = [path.start, *(move.end for move in path.moves)]
    is_upright = all(
        max(end[axis] for end in ends) - min(end[axis] for end in ends) < LEAST_EXTENT
        for axis in (0, 1)
    )
    return (0, 2) if is_upright else (0, 1)


def _runs(path: ToolPath) -> Iterator[tuple[MoveType, list[Point]]]:
    """Yield the points of consecutive moves of the same type."""
    for kind, group in groupby(path.segments(), key=lambda pair: pair[1].type):
        points: list[Point] = []
        for start, move in group:
            if not points:
                points.append(start)
            points += points_along(start, move, step=STEP)
        yield kind, points


def _stock(axes: Axes, stock: Stock | None, *, is_turning: bool) -> None:
    """Draw the outline of the raw part."""
    if stock is None:
        return
    (x0, y0, z0), (x1, y1, z1) = stock.low, stock.high
    corners = (
        [(z0, 0.0), (z1, 0.0), (z1, x1), (z0, x1)]
        if is_turning
        else [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    )
    ring = [*corners, corners[0]]
    axes.plot(
        [x for x, _ in ring],
        [y for _, y in ring],
        color="#5f6368",
        linewidth=1.0,
        linestyle="--",
        zorder=1,
    )
