"""Raw part of NC code as the user gives it: numbers, a mesh, or what an earlier run left.

One place for every command: :func:`raw_stock_of` reads it, :func:`stock_map` makes the map that
tools cut.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from service.files import read_bytes
from service.inputs.numbers import require_size, stock_in
from service.inputs.part_file import read_part
from service.inputs.program_bodies import USUAL_TOLERANCE, ProgramBodies, stock_around
from service.requests.program_facts import KEPT_SUFFIX, RawPart, StockFile
from simulator.machine.virtual import StockMap
from simulator.motion.segments import Floats
from simulator.removal.engage import MillingStock
from simulator.removal.larger_stock import grown_milling_stock, grown_turning_stock
from simulator.removal.lathe import TurningStock
from simulator.removal.mesh_stock import bounds_of, milling_stock_of, turning_stock_of
from simulator.removal.stock_file import kept_stock
from simulator.spec import Machine, MachineKind
from stepnc_model.entities.executables import Setup
from stepnc_model.errors import StepNcError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, Stock
from stepnc_model.toolpath.frame import Frame, workpiece_frame
from stepnc_model.toolpath.task import drawn_stock, raw_body

MOST_BYTES = 1 << 27
"""Largest file of a kept stock, bytes; the most cells take half of it."""

OFF_AXIS = 1e-6
"""Greatest distance of a bar's axis from that of a lathe, mm."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GivenStock:
    """Raw part in coordinates of the program."""

    bounds: Stock
    """Its box or bar, or the box around it."""
    triangles: Floats | None = None
    """Triangles of a mesh or a solid, (T, 3, 3), mm; None: it is neither."""
    kept: MillingStock | TurningStock | None = None
    """Stock that an earlier run left; it is cut further, so it serves one run."""
    name: str = ""
    """File it was read from; empty for numbers."""


def file_of_stock(part: RawPart) -> Path | None:
    """Path of the file that a stock is read from; None for numbers."""
    return part.path if isinstance(part, StockFile) else None


def raw_stock_of(part: RawPart) -> GivenStock:
    """Read a raw part.

    Parameters
    ----------
    part : str or StockFile
        Numbers in mm: ``x0,y0,z0,x1,y1,z1`` of a box, ``diameter,z0,z1`` of a bar about zero,
        ``diameter,length`` of a bar that ends at z = 0, or ``x,y,diameter,z0,z1`` of an upright
        bar elsewhere; a text is never a path. Or an STL file in mm, a STEP file with a solid,
        or a stock that a run kept (``.npz``).

    Raises
    ------
    StepNcError
        When the numbers or the file are invalid, or the size is not that of a stock.
    """
    if not isinstance(part, StockFile):
        return GivenStock(bounds=stock_in(part))
    path = part.path
    if path.suffix.lower() == KEPT_SUFFIX:
        bounds, kept = kept_stock(read_bytes(path, most=MOST_BYTES), str(path))
        return GivenStock(bounds=bounds, kept=kept, name=str(path))
    triangles = read_part(path, solid=part.solid, tolerance=USUAL_TOLERANCE).triangles
    raw = GivenStock(bounds=bounds_of(triangles), triangles=triangles, name=str(path))
    _require_size(raw)
    return raw


def stock_map(machine: Machine, raw: GivenStock) -> StockMap:
    """Build the map of a raw part that suits the kind of machine.

    Raises
    ------
    StepNcError
        When the stock has no volume or exceeds the size of any machine, lies beside the axis
        of a lathe, is no body of revolution there, or was kept by another kind of machine.
    """
    _require_size(raw)
    if machine.kind is not MachineKind.LATHE:
        if isinstance(raw.kept, TurningStock):
            raise _of_other(raw, machine, "a lathe")
        if raw.triangles is not None:
            return milling_stock_of(raw.triangles)
        return MillingStock(raw.bounds) if raw.kept is None else raw.kept
    if isinstance(raw.kept, MillingStock):
        raise _of_other(raw, machine, "a mill")
    if raw.kept is not None:
        return raw.kept
    if raw.triangles is not None:
        try:
            return turning_stock_of(raw.triangles)
        except ValueError as error:
            raise StepNcError(f"{raw.name}: {error}") from error
    _require_on_axis(raw.bounds, machine)
    return TurningStock(raw.bounds)


def larger_stock_map(machine: Machine, raw: GivenStock, margin: float) -> StockMap:
    """Build the map of a raw part that is larger all around by a margin, mm.

    Raises
    ------
    StepNcError
        When :func:`stock_map` would raise it.
    """
    if raw.triangles is None and raw.kept is None:
        return stock_map(machine, replace(raw, bounds=raw.bounds.grown(margin)))
    drawn = stock_map(machine, raw)
    if isinstance(drawn, TurningStock):
        return grown_turning_stock(drawn, margin)
    if isinstance(drawn, MillingStock):
        return grown_milling_stock(drawn, margin)
    return drawn


def raw_triangles(program: Program, setup: Ref[Setup] | None) -> Floats | None:
    """Triangles of the raw part of a program, (T, 3, 3), mm, in coordinates of a setup.

    None if it is a box or a bar: the program has no B-rep body of it, does not use it, or it
    cannot be read, which is told.
    """
    bodies = program.bodies
    if not isinstance(bodies, ProgramBodies):
        return None
    if bodies.user_triangles is not None:
        return bodies.user_triangles
    body = raw_body(program)
    if body is None or drawn_stock(program, setup) is None:
        return None
    mesh = bodies.raw(program.file, body)
    return None if mesh is None else placed_triangles(mesh, workpiece_frame(program, setup))


def body_map(
    program: Program, setup: Ref[Setup] | None, *, is_turning: bool, cell: float | None
) -> MillingStock | TurningStock | None:
    """Map of a raw part that is a body; None if it is a box or a bar.

    Parameters
    ----------
    setup : Ref or None
    is_turning : bool
        Whether it is turned.
    cell : float, mm
        Size of the map's cells on a mill; None: chosen from the size of the part.

    Raises
    ------
    ValueError
        When it is turned, and no closed body of revolution about Z.
    """
    mesh = raw_triangles(program, setup)
    if mesh is None:
        return None
    return turning_stock_of(mesh) if is_turning else milling_stock_of(mesh, cell=cell)


def user_stock(part: RawPart) -> GivenStock:
    """Read a raw part that was not cut before: numbers, a mesh or a solid.

    Raises
    ------
    StepNcError
        As :func:`raw_stock_of`; when it is a stock that an earlier run kept.
    """
    raw = raw_stock_of(part)
    if raw.kept is not None:
        raise StepNcError(
            f"{raw.name}: a kept stock serves NC code only: name numbers, an STL file or a "
            "STEP file"
        )
    if raw.triangles is None:
        return raw
    return replace(raw, bounds=stock_around(raw.triangles))


def placed_triangles(triangles: Floats, frame: Frame) -> Floats:
    """Triangles, (T, 3, 3) in mm, of a part that lies in a frame."""
    axes = np.array([frame.x, frame.y, frame.z])
    return np.asarray(triangles @ axes + np.array(frame.origin))


def _require_size(raw: GivenStock) -> None:
    """Refuse a size that no stock has, with the name of its file."""
    try:
        require_size(raw.bounds)
    except StepNcError as error:
        raise StepNcError(f"{raw.name}: {error}" if raw.name else str(error)) from error


def _of_other(raw: GivenStock, machine: Machine, kind: str) -> StepNcError:
    return StepNcError(f"{raw.name}: was kept by {kind}, but {machine.name} is none")


def _require_on_axis(bounds: Stock, machine: Machine) -> None:
    """Refuse a bar beside the axis of a lathe."""
    if bounds.radius is None:
        return
    for axis, low, high in zip("xy", bounds.low, bounds.high[:2], strict=False):
        middle = 0.5 * (low + high)
        if abs(middle) > OFF_AXIS:
            raise StepNcError(
                f"stock: the bar's axis lies at {axis} = {middle:g} mm; {machine.name} turns "
                "it about x = y = 0"
            )
