"""Bores at the back of holes: where they stand, and where their shoulder and mouth are.

A bore reaches from its shoulder down to its mouth, at the back of the part. A feature whose
axis points up begins at the shoulder and goes down to its depth plane; one whose axis points
down, seen from behind, begins at the mouth.
"""

from collections.abc import Iterator

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import CompoundFeature, RoundHole
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.frame import (
    PARALLEL,
    Frame,
    compound_of,
    frame_of,
    surrounding_frame,
)
from stepnc_model.toolpath.hole.feature import Hole, feature_depth, size_of, tolerance_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.pattern import Placed, placements


def back_holes(job: Job) -> Iterator[Hole]:
    """Bores at the back of holes, in the order of the file.

    Each one's top is its shoulder, its depth the way from there down to its mouth.

    Yields
    ------
    Hole

    Raises
    ------
    PathError
        When there is none, its axis does not lie along the tool, or it lacks a size.
    """
    if not job.step.features:
        raise job.fault("has no feature: nothing tells where to bore", job.step.ref)
    for feature in job.step.features:
        for placed in placements(job.program, job.step.setup, feature):
            with job.program.using(placed.feature):
                yield _hole(job, placed)


def _hole(job: Job, placed: Placed) -> Hole:
    """One bore, or the element of a compound feature that opens at the back."""
    named = job.program.get(placed.feature)
    ref, frame = placed.feature, placed.frame
    if isinstance(named, CompoundFeature):
        ref = _element(job, placed, named)
        frame = _inner(job, placed.frame, ref)
    entity = job.program.get(ref)
    shoulder, mouth = _ends(job, ref, frame)
    x, y, _ = frame.origin
    diameter = size_of(job, ref, entity) if isinstance(entity, RoundHole) else None
    bottom = getattr(entity, "bottom_condition", None)
    return Hole(
        ref=ref,
        frame=placed.frame,
        top=(x, y, shoulder),
        entry_z=_entry(job, placed, max(shoulder, mouth)),
        depth=shoulder - mouth,
        diameter=diameter,
        narrowest=diameter,
        tolerance=tolerance_of(job, entity),
        bottom=job.program.get(bottom) if bottom is not None else None,
    )


def _element(job: Job, placed: Placed, compound: CompoundFeature) -> Ref[Entity]:
    """Hole of a compound feature that opens lowest; of several the tapered or widest one."""
    found: dict[Ref[Entity], tuple[float, bool, float]] = {}
    for ref in compound.elements:
        entity = job.program.get(ref)
        if isinstance(entity, RoundHole):
            _, mouth = _ends(job, ref, _inner(job, placed.frame, ref))
            is_tapered = entity.change_in_diameter is not None
            found[ref] = (-round(mouth, 6), is_tapered, size_of(job, ref, entity))
    if not found:
        message = "has no round hole among its elements"
        raise job.fault(message, placed.feature, "elements")
    return max(found, key=found.__getitem__)


def _ends(job: Job, ref: Ref[Entity], frame: Frame) -> tuple[float, float]:
    """Heights of a bore's shoulder and mouth."""
    if abs(frame.z[0]) + abs(frame.z[1]) > PARALLEL:
        along = ", ".join(f"{part:.4g}" for part in frame.z)
        message = (
            f"its axis ({along}) does not lie along the tool: a setup of its own is needed"
        )
        raise job.fault(message, ref)
    depth = feature_depth(job, ref)
    if depth is None:
        raise job.fault("has no depth: nothing tells where its other end is", ref, "depth")
    z = frame.origin[2]
    return (z, z - depth) if frame.is_upright else (z + depth, z)


def _entry(job: Job, placed: Placed, own: float) -> float:
    """Height where the tool enters: the top of the compound feature, else of the stock."""
    named = job.program.get(placed.feature)
    frame = placed.frame
    if not isinstance(named, CompoundFeature):
        ref = compound_of(job.program, placed.feature)
        if ref is None:
            return own if job.stock is None else max(own, job.stock.high[2])
        named = job.program.get(ref)
        frame = surrounding_frame(job.program, job.step.setup, placed.feature)
    tops = (
        max(_ends(job, ref, _inner(job, frame, ref)))
        for ref in named.elements
        if isinstance(job.program.get(ref), RoundHole)
    )
    return max(own, frame.origin[2], *tops)


def _inner(job: Job, compound: Frame, ref: Ref[Entity]) -> Frame:
    """Frame of an element, by that of its compound feature."""
    placement = getattr(job.program.get(ref), "feature_placement", None)
    return compound.inner(frame_of(job.program, placement))
