"""Nominal walls and floors of the features that a workingstep makes, in the setup. Units mm."""

from collections.abc import Iterator
from dataclasses import dataclass

from stepnc_model.errors import SchemaError
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.frame import placements
from stepnc_model.toolpath.milling.contour import Chain
from stepnc_model.toolpath.milling.cover import Area, Flank, Inset
from stepnc_model.toolpath.milling.shapes import shapes
from stepnc_model.toolpath.task import job_of


@dataclass(frozen=True, slots=True, kw_only=True)
class NominalWall:
    """Wall of a feature above its floor."""

    chain: Chain
    """Outline at the top."""
    inset: Inset
    """Distance by which the wall stands before its outline, by the height above the floor."""
    bottom: float
    """Height z of the floor, mm."""


def nominal_walls(program: Program, step: ResolvedWorkingstep) -> tuple[NominalWall, ...]:
    """Walls of the features of a milling or drilling workingstep; none where it has none.

    A face has a floor only: a wall with an empty chain.
    """
    try:
        job = job_of(program, step)
        return tuple(
            wall
            for feature in step.features
            for placed in placements(program, step.setup, feature)
            for shape in shapes(job, placed.feature, placed.frame)
            for wall in _walls(shape)
        )
    except SchemaError:
        # What cannot be milled, such as a thread, has no walls here.
        return ()


def _walls(shape: Area | Flank) -> Iterator[NominalWall]:
    if isinstance(shape, Flank):
        yield NominalWall(chain=shape.chain, inset=shape.inset, bottom=shape.bottom)
        return
    if not shape.walls:
        yield NominalWall(chain=(), inset=lambda _: 0.0, bottom=shape.bottom)
    for wall in shape.walls:
        chain = tuple(edge for edge in wall.loop if edge not in shape.outside)
        yield NominalWall(chain=chain, inset=wall.inset, bottom=shape.bottom)
