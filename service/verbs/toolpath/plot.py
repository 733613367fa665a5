"""Picture of tool paths, coloured by the type of each move."""

import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import ceil, isfinite

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from service.verbs.toolpath.stretches import called_tool, tool_label
from stepnc_model.nc.moves import MoveKind, NcMove
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.blocks import MachineType
from stepnc_model.programs.program import Stock
from stepnc_model.toolpath.arc import points_along
from stepnc_model.toolpath.path import Move, MoveType, Point, ToolPath

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

CODE_TYPES = {"rapid": MoveType.RAPID, "feed": MoveType.CONTACT}
"""Types by which the moves of NC code are drawn: it does not say where it cuts."""

Segment = tuple[Point, Move]
"""Start of a move, and the move."""

View = tuple[int, int]
"""Axes drawn to the right and upwards."""

LEAST_EXTENT = 1.0
"""Smallest extent of a path seen from above, in mm; smaller ones are drawn from the front."""

MOST_PANELS = 40
"""Most sections that get a panel each; with more, only the overall view is drawn."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlotStroke:
    """Consecutive moves of the same type, as the points along them."""

    label: str
    type: MoveType
    points: tuple[Point, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlotSection:
    """Part of a program that gets a panel: a workingstep, or the moves of one tool."""

    name: str
    is_turning: bool
    strokes: tuple[PlotStroke, ...]


def sections_of_paths(paths: Iterable[ToolPath]) -> tuple[PlotSection, ...]:
    """Sections of tool paths that move, one each."""
    return tuple(
        PlotSection(
            name=path.id,
            is_turning=path.is_turning,
            strokes=tuple(
                PlotStroke(label=kind.value, type=kind, points=tuple(_points(moves)))
                for kind, moves in groupby(path.segments(), key=lambda pair: pair[1].type)
            ),
        )
        for path in paths
        if path.moves
    )


def sections_of_code(program: NcProgram) -> tuple[PlotSection, ...]:
    """Sections of NC code, one for each tool in the order of the calls.

    Moves of which start, end or centre are not known are left out.
    """
    moves = (each for each in program.moves.each() if _is_drawn(each))
    return tuple(
        PlotSection(
            name=tool_label(called),
            is_turning=program.machine is MachineType.LATHE,
            strokes=tuple(
                PlotStroke(label=label, type=CODE_TYPES[label], points=tuple(_points(pairs)))
                for label, pairs in _runs_of_code(group)
            ),
        )
        for called, group in groupby(moves, key=lambda move: called_tool(move.setting))
    )


def _runs_of_code(moves: Iterable[NcMove]) -> Iterator[tuple[str, Iterator[Segment]]]:
    """Group consecutive moves that start where the last one ended, by rapid or feed."""
    label, ended, run = "", None, 0
    keyed: list[tuple[tuple[int, str], NcMove]] = []
    for move in moves:
        now = "rapid" if move.kind is MoveKind.RAPID else "feed"
        if now != label or move.start != ended:
            run += 1
        label, ended = now, move.end
        keyed.append(((run, now), move))
    for (_, name), group in groupby(keyed, key=lambda pair: pair[0]):
        yield name, (_segment(move) for _, move in group)


def _is_drawn(move: NcMove) -> bool:
    if move.kind in {MoveKind.DWELL, MoveKind.UNKNOWN}:
        return False
    turn = 0.0 if move.arc is None else move.arc.turn
    return isfinite(sum(move.start) + sum(move.end) + turn)


def _segment(move: NcMove) -> Segment:
    """Start of a move of NC code, and the move as one of a tool path."""
    return move.start, Move(type=MoveType.CONTACT, end=move.end, arc=move.arc)


def _points(segments: Iterable[Segment]) -> Iterator[Point]:
    """Points along moves that follow each other."""
    for index, (start, move) in enumerate(segments):
        if not index:
            yield start
        yield from points_along(start, move, step=STEP)


def path_png(
    sections: Sequence[PlotSection],
    stock: Stock | None,
    clamps: Sequence[Point] = (),
    *,
    title: str,
) -> bytes:
    """Draw the program from above, or along the lathe's axis, and each section alone."""
    panels = sections if len(sections) <= MOST_PANELS else []
    rows = ceil(len(panels) / COLUMNS)
    mpl.use("Agg")
    figure = Figure(figsize=(16.0, 6.5 + 3.6 * rows), layout="constrained")
    grid = figure.add_gridspec(rows + 2, COLUMNS)
    overall = figure.add_subplot(grid[:2, :])
    is_turning = any(section.is_turning for section in sections)
    for section in sections:
        _draw(overall, section, (2, 0) if section.is_turning else (0, 1))
    _stock(overall, stock, is_turning=is_turning)
    across, up = (2, 0) if is_turning else (0, 1)
    xs, ys = [clamp[across] for clamp in clamps], [clamp[up] for clamp in clamps]
    overall.plot(xs, ys, "x", color="#5f6368", markersize=9, markeredgewidth=2)
    overall.set_title(title)
    order = list(MoveType)
    strokes = [stroke for section in sections for stroke in section.strokes]
    labels = {stroke.type: stroke.label for stroke in strokes}
    handles = [
        Line2D([], [], color=COLOURS[kind], label=labels[kind])
        for kind in sorted(labels, key=order.index)
    ]
    if stock is not None:
        handles.append(Line2D([], [], color="#5f6368", linestyle="--", label="stock"))
    if clamps:
        clamp = Line2D([], [], color="#5f6368", marker="x", linestyle="", label="clamping")
        handles.append(clamp)
    overall.legend(handles=handles, loc="upper right")
    for index, section in enumerate(panels):
        axes = figure.add_subplot(grid[2 + index // COLUMNS, index % COLUMNS])
        _draw(axes, section)
        axes.set_title(section.name, fontsize=9)
        axes.tick_params(labelsize=7)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return buffer.getvalue()


def _draw(axes: Axes, section: PlotSection, view: View | None = None) -> None:
    """Draw the strokes of a section, cuts on top."""
    across, up = view or _view(section)
    for stroke in section.strokes:
        order = 3 if stroke.type is MoveType.CONTACT else 2
        axes.plot(
            [point[across] for point in stroke.points],
            [point[up] for point in stroke.points],
            color=COLOURS[stroke.type],
            linewidth=0.9,
            zorder=order,
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"{'xyz'[across]}, mm", fontsize=8)
    axes.set_ylabel(f"{'xyz'[up]}, mm", fontsize=8)


def _view(section: PlotSection) -> View:
    """View of a section: lathe along the axis, mill from above, upright ones from the front."""
    if section.is_turning:
        return 2, 0
    points = [point for stroke in section.strokes for point in stroke.points]
    is_upright = all(
        max(point[axis] for point in points) - min(point[axis] for point in points)
        < LEAST_EXTENT
        for axis in (0, 1)
    )
    return (0, 2) if is_upright else (0, 1)


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
