"""Catalogue feed per tooth, adapted to the engagement of the cut.

Catalogue feeds apply to a usual width of cut. In a narrower cut the chip is thinner than the
feed, which may rise until the chip is as thick as the catalogue intends. In a wider cut the
chips stay longer in the cut and evacuate badly from a slot, so the feed falls, in a full slot
to the slot factor of the catalogue.
"""

from math import pi

from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from simulator.physics.engagement import conventional
from simulator.spec import CuttingMaterial, ToolGrade, ToolKind
from simulator.tool_windows import FeedWindow

GREATEST_THINNING = 4.0
"""Greatest factor on the catalogue feed, a customary bound of CAM systems.

With more, a wall that comes closer would give many times the chip that the edge bears.
"""

USUAL_CHIP_RATIO = 2.0 / pi
"""Mean chip thickness over feed per tooth at half the diameter, from the side."""

FINISH_NOSE_FEED = 0.5
"""Greatest feed per revolution over the nose radius for finishing.

A radius of two to three feeds is recommended: Mitsubishi Materials, general catalogue
2020-2021, technical data.
"""

ROUGH_NOSE_FEED = 2.0 / 3.0
"""Greatest feed per revolution over the nose radius for roughing.

A customary bound for the strength of the nose; 1/1.6 for strong inserts (C, S) and 1/2.5 for
weak ones (D, T) are printed too.
"""


def _factor(cut: Cut, at: CuttingConditions) -> float:
    """Factor on the catalogue feed per tooth for the engagement; 1 without a grade."""
    if at.grade is None or at.machine.only_stated_limits:
        return 1.0
    return engagement_factor(cut, at.grade)


def feed_origin(cut: Cut, at: CuttingConditions) -> str:
    """Describe where the greatest feed comes from; empty for the plain catalogue value."""
    factor = _factor(cut, at)
    told = "" if factor == 1.0 else f"{factor:.3g} × the catalogue value at this engagement"
    if at.grade is None or not is_borrowed_feed(cut, at):
        return told
    feed = catalogue_feed(cut, at)
    if feed is not None and cut.programmed.feed > feed * factor:
        return f"as programmed, above {at.grade.borrowed}"
    return f"{told}, {at.grade.borrowed}" if told else at.grade.borrowed


def least_feed(cut: Cut, at: CuttingConditions) -> float | None:
    """Least recommended feed per tooth, mm; below it the edges rub. None if not recommended."""
    bounds: list[float | None] = []
    if at.grade is not None and not at.grade.borrowed:
        teeth = 1 if cut.kind is CutKind.MILLING else cut.tool.teeth
        ratio = at.grade.min_feed_ratio
        if at.grade.min_feed is not None:
            bounds.append(at.grade.min_feed / teeth)
        if ratio is not None and cut.tool.diameter > 0.0:
            bounds.append(ratio * at.grade.size(cut.tool.diameter) / teeth)
    ratio = at.material.min_feed_per_tooth_ratio
    if ratio is not None and _is_solid_carbide(cut, at):
        bounds.append(ratio * _size(cut, at))
    lowest = min((each for each in bounds if each), default=None)
    return None if lowest is None else lowest * min(1.0, _factor(cut, at))


def greatest_feed(cut: Cut, at: CuttingConditions) -> float | None:
    """Greatest feed per tooth for the material and grade at this engagement, mm.

    Windows of another group are no reason to slow a program down.
    """
    feed = catalogue_feed(cut, at)
    if feed is None:
        return None
    highest = feed * _factor(cut, at)
    return max(highest, cut.programmed.feed) if is_borrowed_feed(cut, at) else highest


def is_borrowed_feed(cut: Cut, at: CuttingConditions) -> bool:
    """True if the greatest feed comes from a window of another group."""
    is_borrowed = at.grade is not None and at.grade.borrowed != ""
    has_own = at.material.max_feed_per_tooth_ratio is not None and _is_solid_carbide(cut, at)
    return is_borrowed and not has_own


def borrowed_datum(at: CuttingConditions) -> str:
    """Datum that would bring windows of the material's own group."""
    if not at.material.iso_group:
        return f"iso_group in the file of '{at.material.name}'"
    return f"a tool for ISO group {at.material.iso_group}, or its windows in a tool table"


def _own_feeds(cut: Cut, at: CuttingConditions) -> list[float]:
    """Greatest feeds per tooth that the material's own file gives for this tool, mm."""
    ratio = at.material.max_feed_per_tooth_ratio
    bounds = [at.material.max_feed_per_tooth]
    if ratio is not None and _is_solid_carbide(cut, at):
        bounds.append(ratio * _size(cut, at))
    return [bound for bound in bounds if bound is not None]


def catalogue_feed(cut: Cut, at: CuttingConditions) -> float | None:
    """Greatest feed per tooth for the material and grade at their reference engagement, mm."""
    bounds = _own_feeds(cut, at)
    grade = at.grade
    if grade is not None and cut.kind is CutKind.TURNING and cut.corner_radius > 0.0:
        # With a wiper the nose does not form the surface: only its strength counts.
        is_finish = cut.is_finishing and not cut.tool.has_wiper
        share = FINISH_NOSE_FEED if is_finish else ROUGH_NOSE_FEED
        bounds.append(share * cut.corner_radius)
    # What the material's own file says goes before what another group says.
    if grade is not None and (not grade.borrowed or is_borrowed_feed(cut, at)):
        teeth = 1 if cut.kind is CutKind.MILLING else cut.tool.teeth
        if grade.max_feed is not None:
            bounds.append(grade.max_feed / teeth)
        if grade.max_feed_ratio is not None and cut.tool.diameter > 0.0:
            bounds.append(grade.max_feed_ratio * grade.size(cut.tool.diameter) / teeth)
    return min(bounds, default=None)


def _size(cut: Cut, at: CuttingConditions) -> float:
    """Diameter to which ratios of the diameter apply, mm."""
    return cut.tool.diameter if at.grade is None else at.grade.size(cut.tool.diameter)


def least_chip(cut: Cut, at: CuttingConditions) -> float:
    """Chip thickness below which the edges rub, mm; 0 if nothing is known of the tool.

    The edges of the smallest tools are sharper than is typical: what their catalogue feed cuts
    at the usual width does not rub.
    """
    grade = at.grade
    if grade is None:
        return 0.0
    if grade.min_feed_ratio is None or cut.tool.diameter <= 0.0:
        return grade.min_chip_thickness
    is_mill = cut.kind is CutKind.MILLING
    ratio = USUAL_CHIP_RATIO if is_mill else 1.0 / cut.tool.teeth
    feed = grade.min_feed_ratio * grade.size(cut.tool.diameter)
    return min(grade.min_chip_thickness, ratio * feed)


def _is_solid_carbide(cut: Cut, at: CuttingConditions) -> bool:
    """True if the feeds per tooth of the material's file are for this tool."""
    is_carbide = at.cutting_material is CuttingMaterial.CARBIDE
    return is_carbide and cut.tool_kind is ToolKind.ENDMILL


def engagement_factor(cut: Cut, grade: ToolGrade) -> float:
    """Factor on the catalogue feed per tooth at the widest engagement; 1 without data."""
    window = grade.feed_window
    if cut.kind is not CutKind.MILLING or window is None or cut.engagement is None:
        return 1.0
    width = cut.width_ratio or 0.5 * cut.engagement.cosine_difference
    sine = cut.chip_sine or cut.engagement.greatest_sine
    return feed_factor(width, sine, window)


def feed_factor(width_ratio: float, sine: float, window: FeedWindow) -> float:
    """Factor on the catalogue feed per tooth at a given width and chip sine.

    ``h(x_ref)/h`` with ``h = f_z·sin φ`` at the thickest chip, at most 4; beyond the width of
    the window linear in a_e/D to the factor of a slot.

    Parameters
    ----------
    width_ratio : float
        a_e/D.
    sine : float
        Greatest sin φ in the cut: chip thickness over feed per tooth of a straight edge.

    Examples
    --------
    A tenth of the diameter from the side: ``1/(2·sqrt(0.1·0.9))``, catalogues' 1.67.

    >>> window = FeedWindow(width_ratio=0.5, slot_factor=0.75)
    >>> round(feed_factor(0.1, 0.6, window), 2), feed_factor(1.0, 1.0, window)
    (1.67, 0.75)
    """
    reference = window.width_ratio
    if width_ratio > reference:
        beyond = min(1.0, (width_ratio - reference) / (1.0 - reference))
        return 1.0 - beyond * (1.0 - window.slot_factor)
    thickest = conventional(reference, 1.0).greatest_sine
    return min(GREATEST_THINNING, max(1.0, thickest / sine))
