"""Back boring: through a narrower hole, then upwards into its back (ISO 14649-11).

Above the hole the spindle stops with the edge in a known direction, and the tool is shifted the
opposite way, so that it passes the hole. Below the hole it moves back to the axis, starts
turning and feeds up. It leaves in reverse order. No move inside the workpiece is rapid.

Interpretation of the file:

* ``cutting_depth`` is measured upwards from the back of the part;
* the programmed point is the tip of the tool. The boring edge lies above it: by
  ``cutting_edge_length``, or for a conical tool of lip angle α by the height of the cone
  from the tool's diameter D to the hole's diameter d, ``(D − d)/2 · tan α``. If neither is
  given, the edge is at the programmed point. EXAMPLE3 of ISO 14649-11, which has an explicit
  path, feeds up by 3 mm and stops with the tip below the back of the part: no attribute gives
  the height of its tool;
* the diameter d of the passed hole is the smallest of ``previous_diameter`` and the other
  holes in the compound feature; if none is known, the diameter of the widest tool that
  went through the same feature before;
* the edge points along ``direction_for_spindle_orientation``, else along the
  ``oriented_spindle_stop`` of the machine functions.

Tools with a folding edge need no shift; the file has to give their paths explicitly.

A bore extends from its shoulder down to its mouth at the back of the part. A feature whose axis
points up begins at the shoulder and ends at its depth plane; a feature whose axis points down,
seen from behind, begins at the mouth.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot, inf, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import CompoundFeature, RoundHole
from stepnc_model.entities.milling import (
    BackBoring,
    CenterDrilling,
    CounterSinking,
    DrillingTypeOperation,
    DrillingTypeStrategy,
)
from stepnc_model.entities.technology import MillingMachineFunctions
from stepnc_model.entities.tools import MillingCuttingTool
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import feature_depth
from stepnc_model.programs.tool import tool_of
from stepnc_model.toolpath.frame import (
    PARALLEL,
    Frame,
    PlacedFeature,
    compound_of,
    direction_of,
    frame_of,
    placements,
    surrounding_frame,
)
from stepnc_model.toolpath.hole.cycle import HoleCut, dwell, retract_feed
from stepnc_model.toolpath.hole.feature import (
    TOLERANCE,
    Hole,
    lip_angle,
    narrowest_of,
    size_of,
    tolerance_of,
)
from stepnc_model.toolpath.path import MoveType, SpindleCommand
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask


def back_holes(job: ToolPathTask) -> Iterator[Hole]:
    """Bores at the back of holes, in the order of the file.

    The top of each is its shoulder, and its depth the distance from there down to its mouth.

    Yields
    ------
    Hole

    Raises
    ------
    PathError
        If there is no bore, its axis is not parallel to the tool, or a size is missing.
    """
    if not job.step.features:
        raise job.fault("the workingstep has no feature to bore", job.step.ref, "its_feature")
    for feature in job.step.features:
        for placed in placements(job.program, job.step.setup, feature):
            with job.program.using(placed.feature):
                yield _hole(job, placed)


def _hole(job: ToolPathTask, placed: PlacedFeature) -> Hole:
    """Bore of a placed feature, or the element of a compound feature open at the back."""
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


def _element(
    job: ToolPathTask, placed: PlacedFeature, compound: CompoundFeature
) -> Ref[Entity]:
    """Hole of a compound feature with the lowest mouth; among equals the tapered or widest."""
    found: dict[Ref[Entity], tuple[float, bool, float]] = {}
    for ref in compound.elements:
        entity = job.program.get(ref)
        if isinstance(entity, RoundHole):
            _, mouth = _ends(job, ref, _inner(job, placed.frame, ref))
            is_tapered = entity.change_in_diameter is not None
            found[ref] = (-round(mouth, 6), is_tapered, size_of(job, ref, entity))
    if not found:
        message = "the compound feature has no round hole among its elements"
        raise job.fault(message, placed.feature, "elements")
    return max(found, key=found.__getitem__)


def _ends(job: ToolPathTask, ref: Ref[Entity], frame: Frame) -> tuple[float, float]:
    """Heights z of a bore's shoulder and mouth, mm."""
    if abs(frame.z[0]) + abs(frame.z[1]) > PARALLEL:
        along = ", ".join(f"{part:.4g}" for part in frame.z)
        message = f"the bore axis ({along}) is not parallel to the tool: use a separate setup"
        raise job.fault(message, ref)
    depth = feature_depth(job.program, ref)
    if depth is None:
        raise job.fault("the bore has no depth: its other end is unknown", ref, "depth")
    z = frame.origin[2]
    return (z, z - depth) if frame.is_upright else (z + depth, z)


def _entry(job: ToolPathTask, placed: PlacedFeature, own: float) -> float:
    """Height z where the tool enters: the top of the compound feature, else of the stock."""
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


def _inner(job: ToolPathTask, compound: Frame, ref: Ref[Entity]) -> Frame:
    """Frame of an element of a compound feature, in setup coordinates."""
    placement = getattr(job.program.get(ref), "feature_placement", None)
    return compound.inner(frame_of(job.program, placement))


SHIFT_CLEARANCE = 0.5
"""Clearance between the edge and the wall of the passed hole, mm, customary."""

MOUTH_CLEARANCE = 1.0
"""Default clearance between the edge and the back of the part, mm, customary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bore:
    """Shift and heights of the tip for back boring one hole, mm."""

    shift: tuple[float, float]
    """Shift of the tool from the axis, away from the edge, mm."""
    below_z: float
    """Height z of the tip where the edge is clear of the back of the part, mm."""
    shoulder_z: float
    """Height z of the tip where the edge reaches the shoulder, mm."""


def bore_of(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> Bore:
    """Calculate the shift and heights of a back bore.

    Raises
    ------
    PathError
        If the tool does not pass the hole, or does not fit the bore behind it.
    """
    passed = _passed(job, operation, hole)
    _check_tool(job, hole, passed)
    size = 0.5 * (job.tool.diameter - passed) + SHIFT_CLEARANCE
    _check_bar(job, size, passed)
    x, y = _direction(job) or (1.0, 0.0)
    length = _length(job, operation, hole)
    mouth_z = _mouth_z(hole)
    edge = _edge(job, passed) or 0.0
    return Bore(
        shift=(-size * x, -size * y),
        below_z=mouth_z - _clearance(job, operation) - edge,
        shoulder_z=mouth_z + length - edge,
    )


def bore_back(course: PathBuilder, cut: HoleCut) -> None:
    """Bore one hole from behind; the tool starts and ends on the retract plane above it."""
    bore = bore_of(cut.job, cut.operation, cut.hole)
    above, below = cut.hole.at(cut.retract_z), cut.hole.at(bore.below_z)
    x, y = above[0] + bore.shift[0], above[1] + bore.shift[1]
    feed = retract_feed(cut.job, cut.operation, cut.feed)
    course.spindle(SpindleCommand.ORIENT)
    course.line((x, y, cut.retract_z), MoveType.NO_CONTACT)
    course.line((x, y, bore.below_z), MoveType.NO_CONTACT)
    course.line(below, MoveType.NO_CONTACT)
    course.spindle(SpindleCommand.START)
    course.line(cut.hole.at(bore.shoulder_z), MoveType.CONTACT)
    dwell(course, cut, cut.operation.dwell_time_bottom, "dwell_time_bottom")
    course.line(below, MoveType.NO_CONTACT)
    course.spindle(SpindleCommand.ORIENT)
    course.line((x, y, bore.below_z), MoveType.NO_CONTACT)
    course.line((x, y, cut.retract_z), MoveType.RETRACT, feed)
    course.line(above, MoveType.NO_CONTACT)
    course.spindle(SpindleCommand.START)


def back_findings(
    job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole, bore: Bore
) -> Iterator[Finding]:
    """Report assumptions and warnings about a back bore.

    Yields
    ------
    Finding
    """
    tool = job.program.get(job.step.tool_ref)
    if _direction(job) is None:
        text = "the direction of the stopped tool's edge is not given: assuming +x"
        yield job.note(text, job.step.tool_ref, "direction_for_spindle_orientation")
    if _bar(job) is None:
        text = "no boring bar diameter given: clearance in the hole is not checked"
        yield job.note(text, job.step.tool_ref, "tool_holder_diameter_for_spindle_orientation")
    if _edge(job, _passed(job, operation, hole)) is None:
        text = "no cutting edge length given: assuming the edge at the programmed point"
        yield job.warning(text, job.step.tool_ref, "its_tool_body")
    if _is_reduced(job, operation):
        text = "back boring has a single feed: reductions at start and end are ignored"
        yield job.note(text, attribute="its_machining_strategy")
    given = operation.cutting_depth
    if given is not None and hole.depth is not None and given > hole.depth + TOLERANCE:
        text = f"{given:g} mm is deeper than the bore depth of {hole.depth:g} mm"
        yield job.warning(text, attribute="cutting_depth")
    reach = hole.entry_z - bore.below_z
    overall = tool.overall_assembly_length if isinstance(tool, MillingCuttingTool) else None
    if overall and reach > overall:
        text = f"{overall:g} mm tool length is shorter than the depth of {reach:.4g} mm"
        yield job.warning(text, job.step.tool_ref, "overall_assembly_length")
    mouth_z = _mouth_z(hole)
    if job.stock is not None and mouth_z > job.stock.low[2] + TOLERANCE:
        text = (
            f"the bore opens at z = {mouth_z:g} mm, above the bottom of the workpiece at "
            f"z = {job.stock.low[2]:g} mm: the tool shifts inside it"
        )
        yield job.warning(text, hole.ref, "depth")


def _length(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> float:
    """Length of the bore from its mouth, mm, which must leave a shoulder."""
    at = job.step.operation_ref
    given = operation.cutting_depth
    if given is not None and not 0.0 < given < inf:
        message = f"{given:g} mm: the cutting depth must be positive"
        raise job.fault(message, at, "cutting_depth")
    length = (hole.depth or 0.0) if given is None else given
    shoulder_z = _mouth_z(hole) + length
    if shoulder_z > hole.entry_z - TOLERANCE:
        message = (
            f"a bore of {length:g} mm from behind, up to z = {shoulder_z:g} mm, leaves no "
            "shoulder below the top of the part"
        )
        raise job.fault(message, at, "cutting_depth")
    return length


def _is_reduced(job: ToolPathTask, operation: DrillingTypeOperation) -> bool:
    """True if a strategy asks for other feeds or speeds at the start or the end."""
    ref = operation.its_machining_strategy
    strategy = job.program.get(ref) if ref is not None else None
    return isinstance(strategy, DrillingTypeStrategy) and any(
        ratio is not None
        for ratio in (
            strategy.reduced_cut_at_start,
            strategy.reduced_feed_at_start,
            strategy.reduced_cut_at_end,
            strategy.reduced_feed_at_end,
        )
    )


def _mouth_z(hole: Hole) -> float:
    """Height z where a bore opens at the back of the part, mm."""
    return hole.top[2] - (hole.depth or 0.0)


def _passed(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> float:
    """Diameter of the hole that the tool passes on its way, mm."""
    at = job.step.operation_ref
    given = operation.previous_diameter
    if given is not None and not 0.0 < given < inf:
        raise job.fault(f"{given:g} mm: the diameter must be positive", at, "previous_diameter")
    widths = [*_narrower(job, hole), *([given] if given is not None else [])]
    widths = widths or _drilled(job)[-1:]
    if not widths:
        message = "the diameter of the hole that the tool passes is unknown"
        raise job.fault(message, at, "previous_diameter")
    return min(widths)


def _narrower(job: ToolPathTask, hole: Hole) -> Iterator[float]:
    """Smallest diameters of the other holes of the same compound feature, mm."""
    ref = compound_of(job.program, hole.ref)
    for element in job.program.get(ref).elements if ref is not None else ():
        entity = job.program.get(element)
        if element != hole.ref and isinstance(entity, RoundHole):
            width = size_of(job, element, entity)
            yield narrowest_of(job, entity, width, feature_depth(job.program, element))


def _drilled(job: ToolPathTask) -> list[float]:
    """Diameters of the tools that went through the same feature before, smallest first, mm."""
    return sorted(
        tool_of(job.program, before.tool_ref).diameter
        for before in job.program.before(job.step)
        if isinstance(before.operation, DrillingTypeOperation)
        and not isinstance(before.operation, (BackBoring, CenterDrilling, CounterSinking))
    )


def _check_tool(job: ToolPathTask, hole: Hole, passed: float) -> None:
    """Raise an error if the tool is too narrow, too wide, or has more than one edge."""
    at, width = job.step.operation_ref, job.tool.diameter
    if width <= passed + TOLERANCE:
        message = f"tool of {width:g} mm is not wider than the passed hole of {passed:g} mm"
        raise job.fault(message, at, "its_tool")
    is_tapered = getattr(job.program.get(hole.ref), "change_in_diameter", None) is not None
    if hole.diameter is not None and not is_tapered and width > hole.diameter + hole.tolerance:
        message = (
            f"tool of {width:g} mm diameter is too wide for a bore of {hole.diameter:g} mm "
            f"with a tolerance of {hole.tolerance:g} mm"
        )
        raise job.fault(message, at, "its_tool")
    if job.tool.teeth > 1:
        message = f"{job.tool.teeth} teeth: only a single-edge tool can pass a narrower hole"
        raise job.fault(message, job.step.tool_ref, "its_tool_body")


def _check_bar(job: ToolPathTask, shift: float, passed: float) -> None:
    """Raise an error if the shifted boring bar does not pass the hole."""
    bar = _bar(job)
    if shift + 0.5 * (bar or 0.0) > 0.5 * passed + TOLERANCE:
        what = "the tool axis" if bar is None else f"a bar of {bar:g} mm"
        message = (
            f"{what}, {shift:g} mm off the hole's axis, does not fit through {passed:g} mm"
        )
        attribute = "tool_holder_diameter_for_spindle_orientation"
        raise job.fault(message, job.step.tool_ref, attribute)


def _bar(job: ToolPathTask) -> float | None:
    """Diameter of the bar that carries the boring edge, mm; None if not given."""
    tool = job.program.get(job.step.tool_ref)
    if not isinstance(tool, MillingCuttingTool):
        raise job.fault("is not a rotating tool: it cannot bore", job.step.tool_ref)
    bar = tool.tool_holder_diameter_for_spindle_orientation
    if bar is not None and not 0.0 < bar < inf:
        attribute = "tool_holder_diameter_for_spindle_orientation"
        raise job.fault(
            f"{bar:g} mm: the diameter must be positive", job.step.tool_ref, attribute
        )
    return bar


def _direction(job: ToolPathTask) -> tuple[float, float] | None:
    """Direction of the stopped tool's edge across its axis; None if unknown."""
    tool = job.program.get(job.step.tool_ref)
    ref = (
        tool.direction_for_spindle_orientation if isinstance(tool, MillingCuttingTool) else None
    )
    functions = job.program.get(job.step.functions_ref) if job.step.functions_ref else None
    if ref is None and isinstance(functions, MillingMachineFunctions):
        ref = functions.oriented_spindle_stop
    if ref is None:
        return None
    x, y, _ = direction_of(job.program, ref)
    size = hypot(x, y)
    if size < PARALLEL:
        raise job.fault("the edge points along the axis of its tool", ref, "direction_ratios")
    return x / size, y / size


def _edge(job: ToolPathTask, passed: float) -> float | None:
    """Height of the boring edge above the tip, mm; None if unknown."""
    angle = lip_angle(job)
    if angle > 0.0:
        return 0.5 * (job.tool.diameter - passed) * tan(angle)
    return job.tool.cutting_edge_length


def _clearance(job: ToolPathTask, operation: DrillingTypeOperation) -> float:
    """Distance from the back of the part down to where the edge is clear of it, mm."""
    overcut = operation.overcut_length or MOUTH_CLEARANCE
    if not 0.0 < overcut < inf:
        message = f"{overcut:g} mm: the overcut length must not be negative"
        raise job.fault(message, job.step.operation_ref, "overcut_length")
    return overcut
