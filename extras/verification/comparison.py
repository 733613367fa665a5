"""Comparison of the logged part with the programmed or the required one.

Deviations of the programmed surface from the features of the program.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import ceil

import numpy as np

from extras.verification.log import LogFile
from extras.verification.model.deviation import (
    ComparedVolumes,
    SurfacePlaces,
    compared_volumes,
    surface_places,
)
from extras.verification.model.logged_bar import LoggedBar, profile_distance
from extras.verification.model.logged_part import (
    LogFacts,
    LoggedPart,
    LoggedSamples,
    NearestSamples,
)
from extras.verification.model.mesh import (
    NominalOutline,
    floor_deviation,
    height_deviation,
    outline_at,
    profile_side,
    wall_deviation,
)
from extras.verification.model.required_bar import profile_deviation, required_turned_places
from extras.verification.model.required_part import required_part, required_places
from extras.verification.model.surface import EXACT, programmed_part
from extras.verification.model.sweep import FAR
from extras.verification.model.turned_part import turned_part, turned_places, turned_volumes
from extras.verification.preparation import PreparedProgram, RequiredSetup
from service.progress import Tell
from simulator.motion.segments import AXES, Floats
from simulator.removal.cutter import Cutter
from simulator.removal.lathe import TurningStock
from simulator.removal.mesh_stock import RequiredBar, required_bar
from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted
from stepnc_model.toolpath.milling.contour import Chain
from stepnc_model.toolpath.milling.nominal import NominalWall, nominal_walls
from stepnc_model.toolpath.turning.nominal import nominal_outlines
from stepnc_model.toolpath.turning.outline import FeatureOutline

LEVEL = 3
"""Decimals of a millimetre to which the levels of walls are rounded."""

LONGEST = 0.01
"""Greatest angle of one line of an arc, rad: 0.1 µm on a radius of 10 mm."""


def nominal_deviation(
    program: PreparedProgram, places: SurfacePlaces, normal: Floats
) -> Floats:
    """Deviation of the programmed surface from the nominal features, (N,), mm; NaN: unknown.

    Parameters
    ----------
    places : SurfacePlaces
        Those on walls first.
    normal : (P, 2) array
        Direction from the air into the material at the places on walls.
    """
    found = np.full(len(places), np.nan)
    steps = {step.id: step for step in program.program.workingsteps}
    for index, name in enumerate(program.steps):
        walls = nominal_walls(program.program, steps[name.workingstep])
        own = places.workingstep == index
        floors = np.flatnonzero(own & ~places.is_wall)
        heights = places.position[floors, 2]
        found[floors] = floor_deviation(heights, sorted({wall.bottom for wall in walls}))
        rows = np.flatnonzero(own & places.is_wall)
        if len(rows):
            found[rows] = _walls(places.position[rows], normal[rows], walls)
    return found


def required_deviation(triangles: Floats, places: SurfacePlaces, normal: Floats) -> Floats:
    """Deviation of the programmed surface from a required part, (N,), mm; NaN: none near.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
        Required part in the coordinates of the setup.
    places : SurfacePlaces
        Those on walls first.
    normal : (P, 2) array
        Direction from the air into the material at the places on walls.
    """
    found = np.full(len(places), np.nan)
    floors = np.flatnonzero(~places.is_wall & (places.workingstep >= 0))
    found[floors] = height_deviation(places.position[floors], triangles)
    walls = np.flatnonzero(places.is_wall)
    levels, level = np.unique(places.position[walls, 2].round(LEVEL), return_inverse=True)
    for index, height in enumerate(levels.tolist()):
        rows = walls[level == index]
        outline = outline_at(triangles, height)
        found[rows] = wall_deviation(places.position[rows, :2], normal[rows], outline)
    return found


def turned_nominal_deviation(program: PreparedProgram, places: SurfacePlaces) -> Floats:
    """Deviation of a programmed profile from the features, (N,), mm; NaN: unknown."""
    found = np.full(len(places), np.nan)
    steps = {step.id: step for step in program.program.workingsteps}
    for index, name in enumerate(program.steps):
        own = np.flatnonzero(places.workingstep == index)
        outlines = nominal_outlines(program.program, steps[name.workingstep])
        if len(own) and outlines:
            chains = [_profile(outline) for outline in outlines]
            found[own] = profile_side(places.position[own][:, [2, 0]], chains)
    return found


def required_profile_deviation(
    part: RequiredBar, bar: TurningStock, places: SurfacePlaces
) -> Floats:
    """Deviation of a programmed profile from a required one, (N,), mm; NaN: unknown.

    Parameters
    ----------
    bar : TurningStock
        Programmed part.
    places : SurfacePlaces
        Places on it.
    """
    at = places.position[:, [0, 2]]
    outside, inside = (
        profile_distance(at, np.column_stack([radius, bar.z]), bar.cell)
        for radius in (bar.outer, bar.inner)
    )
    is_bore = (bar.inner > 0.0).any() & (inside < outside)
    found = profile_deviation(places, is_bore, part)
    return np.where((places.workingstep >= 0) & (np.abs(found) < FAR), found, np.nan)


def _profile(outline: FeatureOutline) -> Floats:
    """Points z and radius along an outline, (N, 2), mm."""
    points = [outline.pieces[0].start]
    for piece in outline.pieces:
        count = max(ceil(abs(piece.turn) / LONGEST), 1)
        points += [piece.point((index + 1.0) / count) for index in range(count)]
    return np.array(points)


def _walls(position: Floats, normal: Floats, walls: tuple[NominalWall, ...]) -> Floats:
    """Deviation from the nearest of some walls; NaN without any."""
    found = np.full(len(position), np.nan)
    for wall in walls:
        outline = NominalOutline(points=_points(wall.chain))
        away = wall_deviation(position[:, :2], normal, outline)
        above = np.maximum(position[:, 2] - wall.bottom, 0.0)
        heights, place = np.unique(above.round(6), return_inverse=True)
        away = away - np.array([wall.inset(height) for height in heights.tolist()])[place]
        is_nearer = np.isnan(found) | (np.abs(away) < np.abs(found))
        found = np.where(is_nearer & ~np.isnan(away), away, found)
    return found


def _points(chain: Chain) -> tuple[Floats, ...]:
    """Points of a chain, each edge by itself; none of an empty chain."""
    parts = []
    for edge in chain:
        count = max(ceil(abs(edge.turn) / LONGEST), 1)
        points = [edge.at(index / count) for index in range(count + 1)]
        parts.append(np.array([[point.real, point.imag] for point in points]))
    return tuple(parts)


NEVER = "never enter the stock: where is its zero (--zero), and are they in millimetres?"

LEAST_VOLUME = 1e-3
"""Volume that counts as nothing, mm³."""

MOST_SHORT = 3.0
"""Positions are refused if this multiple of their extent is less than what is required."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedParts:
    """Comparison of two parts."""

    places: SurfacePlaces
    nominal: Floats
    volumes: ComparedVolumes
    facts: LogFacts
    step: float
    cell: float
    notes: tuple[str, ...] = ()
    """What is to be known of the required part."""


def compared_with_program(
    program: PreparedProgram, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    """Compare the logged part with the programmed one."""
    if program.is_turned:
        return _turned(program, file, cell, tell)
    return _milled(program, file, cell, tell)


def compared_with_required(
    setup: RequiredSetup, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    """Compare the logged part with the required one, without a program."""
    if setup.is_turned:
        return _turned_required(setup, file, cell, tell)
    return _milled_required(setup, file, cell, tell)


def _milled(
    program: PreparedProgram, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    raw = program.raw
    part = programmed_part(program.path, program.stock, cell=cell, raw=raw)
    left = LoggedPart(part, program.stock, _rotating(program.cutters), raw=raw)
    for piece in _with_progress(file, left, tell):
        left.add(piece)
    places = surface_places(part, left)
    return ComparedParts(
        places=places,
        nominal=(
            nominal_deviation(program, places, part.walls.normal)
            if program.required is None
            else required_deviation(program.required, places, part.walls.normal)
        ),
        volumes=compared_volumes(part, left),
        facts=left.facts,
        step=_usual(left.walls, left.floors),
        cell=part.map.cell,
    )


def _turned(
    program: PreparedProgram, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    raw = None
    if program.raw is not None:
        raw = required_bar(program.raw, program.stock, cell=cell).bar
    part = turned_part(program.path, program.stock, cell=cell, raw=raw)
    required = _required_profile(program, cell)
    left = LoggedBar(part.bar, program.stock, program.cutters, raw=raw)
    for piece in _with_progress(file, left, tell):
        left.add(piece)
    places = turned_places(part, left)
    return ComparedParts(
        places=places,
        nominal=(
            turned_nominal_deviation(program, places)
            if required is None
            else required_profile_deviation(required, part.bar, places)
        ),
        volumes=turned_volumes(part.bar, left),
        facts=left.facts,
        step=_usual(left.nearest),
        cell=part.bar.cell,
    )


def _required_profile(program: PreparedProgram, cell: float | None) -> RequiredBar | None:
    """Profile of the required part, if one is given."""
    if program.required is None:
        return None
    try:
        return required_bar(program.required, program.stock, cell=cell)
    except ValueError as error:
        raise StepNcError(f"{program.required_name}: {error}") from error


def _milled_required(
    setup: RequiredSetup, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    mesh = setup.required
    part = required_part(
        mesh.triangles, setup.stock, cell=cell, most_sag=mesh.sag, raw=setup.raw
    )
    left = LoggedPart(part, setup.stock, _rotating(setup.cutters), raw=setup.raw)
    for piece in _with_progress(file, left, tell):
        left.add(piece)
    places = required_places(part, left)
    found = ComparedParts(
        places=places,
        nominal=np.full(len(places), np.nan),
        volumes=compared_volumes(part, left),
        facts=left.facts,
        step=_usual(left.walls, left.floors),
        cell=part.map.cell,
        notes=(*_sag_notes(float(part.sag.max())), *_open_notes(part.open)),
    )
    grid = part.map.grid
    cut = np.nonzero(part.is_part & (grid.heights < grid.top - EXACT))
    widest = max(
        shape.diameter for shape in setup.cutters.values() if isinstance(shape, Cutter)
    )
    wanted = [np.ptp(each) * size for each, size in zip(cut, (grid.dx, grid.dy), strict=True)]
    _require_cut(found, file, np.array(wanted) - widest, axes=[0, 1])
    return found


def _turned_required(
    setup: RequiredSetup, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    part = required_bar(setup.required.triangles, setup.stock, cell=cell)
    raw = None
    if setup.raw is not None:
        raw = required_bar(setup.raw, setup.stock, cell=cell).bar
        np.minimum(part.bar.outer, raw.outer, out=part.bar.outer)
        np.maximum(part.bar.inner, raw.inner, out=part.bar.inner)
    left = LoggedBar(part.bar, setup.stock, setup.cutters, raw=raw)
    for piece in _with_progress(file, left, tell):
        left.add(piece)
    places = required_turned_places(part, left)
    found = ComparedParts(
        places=places,
        nominal=np.full(len(places), np.nan),
        volumes=turned_volumes(part.bar, left, low=part.low),
        facts=left.facts,
        step=_usual(left.nearest),
        cell=part.bar.cell,
        notes=tuple(_sag_notes(part.sag)),
    )
    bar = part.bar
    cut = np.flatnonzero(bar.outer < bar.outer.max() - EXACT)
    _require_cut(found, file, np.array([np.ptp(bar.z[cut]) if len(cut) else 0.0]), axes=[2])
    return found


def _sag_notes(sag: float) -> Iterator[str]:
    """Say how far facets lie beside the surface."""
    if sag > EXACT:
        yield (
            f"facets of the required part lie up to {sag:.2g} mm beside the curved surface "
            "that they stand for; their corners are taken to lie on it"
        )


def _open_notes(count: int) -> Iterator[str]:
    """Say that a mesh is not closed."""
    if count:
        yield (
            f"the mesh of the required part is not closed: {counted(count, 'edge')} without "
            "two triangles; what is missing is not compared"
        )


def _with_progress(
    file: LogFile, left: LoggedPart | LoggedBar, tell: Tell
) -> Iterator[LoggedSamples]:
    """Yield the pieces of a log, and tell how far it was taken."""
    for piece in file.pieces():
        yield piece
        tell(f"{counted(left.facts.samples, 'sample')}, {left.facts.end:.0f} s of the log")


def _rotating(cutters: Mapping[int, object]) -> dict[int, Cutter | None]:
    """Shapes of rotating tools; other tools mill nothing."""
    return {
        number: shape if isinstance(shape, Cutter) else None
        for number, shape in cutters.items()
    }


def _usual(*places: NearestSamples) -> float:
    """Way between samples that 95 % of the samples at a surface do not exceed, mm."""
    steps = np.concatenate([each.step[np.isfinite(each.time)] for each in places])
    return float(np.quantile(steps, 0.95)) if len(steps) else 0.0


def _require_cut(
    parts: ComparedParts, file: LogFile, wanted: Floats, *, axes: list[int]
) -> None:
    """Refuse a log that removes nothing, or goes too short a way for what is to be removed.

    Parameters
    ----------
    wanted : (A,) array, mm
        Extent of what is to be removed along some axes, less the widest tool.
    """
    if not parts.volumes.logged > LEAST_VOLUME:
        raise StepNcError(f"{file.name}: the positions {NEVER}")
    span = parts.facts.span[axes]
    if (span * MOST_SHORT < wanted).all():
        shown = " × ".join(f"{each:.3g}" for each in span.tolist())
        needed = " × ".join(f"{each:.3g}" for each in wanted.tolist())
        names = ", ".join(AXES[axis] for axis in axes)
        raise StepNcError(
            f"{file.name}: positions span {shown} mm in {names}; the required part needs a way "
            f"of {needed} mm: are they in inches, or is it another part?"
        )
