"""Limits on the depth of one pass, from machine, tool and the windows of its grade."""

from collections.abc import Iterator
from dataclasses import replace

from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut, CutKind
from optimiser.problem import Limit, LimitName, Monomial
from optimiser.sourced_bound import SourcedBound, borrowed_bound
from optimiser.speed_limits import WRITTEN
from simulator.spec import (
    ToolGrade,
)

DEEPER = 1.01
"""Depth of the deepest place over that of a pass above which it is named."""


def depth_limits(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
    """Limit on the depth of one pass from machine, tool and grade."""
    if cut.kind not in {CutKind.MILLING, CutKind.TURNING}:
        return
    of_tool = _grade_depth(cut, at)
    greatest = _least_known(cut, at, of_tool)
    if greatest is not None:
        is_of_tool = greatest == of_tool.bound
        deepest = cut.deepest_share if cut.is_depth_free else 1.0
        yield Limit(
            name=LimitName.AXIAL_DEPTH,
            label="depth at the deepest place" if deepest > DEEPER else "",
            load=Monomial(coefficient=deepest, depth_exponent=1.0),
            bound=greatest,
            unit="mm",
            origin=of_tool.origin if is_of_tool else "",
            datum=of_tool.datum if is_of_tool else "",
        )
        yield from _shoulder_limits(cut, greatest)


def depth_at_shoulder(cut: Cut, at: CuttingConditions) -> float | None:
    """Depth of a turning tool beyond which a place keeps its programmed feed, mm; None: any."""
    if cut.kind is not CutKind.TURNING or cut.is_depth_free or at.grade is None:
        return None
    return _least_known(cut, at, _grade_depth(cut, at))


def _least_known(cut: Cut, at: CuttingConditions, of_tool: SourcedBound) -> float | None:
    """Least of the greatest depths that anything permits, mm; None: any."""
    bounds = [at.machine.max_axial_depth, cut.depth_bound, at.bounds.axial_depth]
    known = [bound for bound in (*bounds, of_tool.bound) if bound is not None]
    return min(known, default=None)


def _shoulder_limits(cut: Cut, bound: float) -> Iterator[Limit]:
    """Keep the programmed feed where a finishing cut meets more than its insert may cut.

    An insert that turns along the axis up to a shoulder meets the allowance of its face with
    the whole edge, as high as the shoulder is: an edge at 93° stands 3° off the face, so that
    an allowance of 0.5 mm is met on 9.5 mm of it at once. What is left along the face's normal
    would count only for a move along the face. No feed makes a shoulder less deep: the program
    itself must change. One feed holds for a workingstep; along the path only the place itself
    keeps it (:mod:`optimiser.along_path.caps`).
    """
    depth = cut.programmed.depth
    deepest = cut.deepest_share * depth
    if cut.is_depth_free or deepest <= DEEPER * bound or depth > bound:
        return
    yield Limit(
        name=LimitName.PROGRAMMED_FEED,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=cut.programmed.feed,
        unit="mm",
        step=0.01,
        origin=f"{deepest:.3g} mm deep at a shoulder, where the tool may cut {bound:.3g} mm",
        datum="a tool for that depth, roughing nearer to the shoulder, or facing it inwards",
        stands_for=LimitName.AXIAL_DEPTH,
    )


def _grade_depth(cut: Cut, at: CuttingConditions) -> SourcedBound:
    """Greatest depth of a pass by the windows of the tool, mm."""
    grade, given = at.grade, cut.programmed.depth
    if grade is None:
        return SourcedBound()
    bounds = [grade.max_depth, depth_by_diameter(cut, at, grade)]
    known = [bound for bound in bounds if bound is not None]
    if not known:
        if grade.has_feeds or at.machine.only_stated_limits:
            return SourcedBound()
        origin = f"no source for more with {grade.name}"
        return SourcedBound(bound=given, origin=origin, datum="a catalogue of the tool")
    found = borrowed_bound(min(known), given, at)
    if found.origin or not _is_wide(cut, at, grade):
        return found
    return replace(found, origin=f"for a width of {_width_ratio(cut):.3g} of the diameter")


def depth_by_diameter(cut: Cut, at: CuttingConditions, grade: ToolGrade) -> float | None:
    """Greatest depth of a pass as a ratio of the diameter, mm; None without one.

    Beyond the width of the window it falls linearly with a_e/D to that in a full slot.
    """
    ratio, window = grade.max_depth_ratio, grade.depth_window
    if ratio is None:
        return None
    if window is not None and _is_wide(cut, at, grade):
        beyond = (_width_ratio(cut) - window.width_ratio) / (1.0 - window.width_ratio)
        ratio -= min(1.0, beyond) * (ratio - min(ratio, window.slot_ratio))
    return ratio * grade.size(cut.diameter)


def _is_wide(cut: Cut, at: CuttingConditions, grade: ToolGrade) -> bool:
    """Whether a milling cut is wider than the depths of the tool are meant for."""
    window = grade.depth_window
    if window is None or cut.kind is not CutKind.MILLING or at.machine.only_stated_limits:
        return False
    return _width_ratio(cut) > window.width_ratio + WRITTEN


def _width_ratio(cut: Cut) -> float:
    """Radial width over diameter where the force is greatest."""
    return min(cut.radial_width / cut.diameter, 1.0) if cut.diameter > 0.0 else 0.0
