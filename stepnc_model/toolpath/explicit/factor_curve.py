"""Curve of feed factors along a path that never lies above given steps of the factor.

A ``toolpath_speed`` (ISO 14649-10) holds a B-spline, and a B-spline of ISO 10303-42 is
continuous: a step becomes a ramp. Ramps lie in the faster part, so that the curve is at most
the steps everywhere, and equal to them outside the ramps. Lengths in mm.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from stepnc_model.toolpath.spline import Spline

RAMP = 0.01
"""Greatest length of a ramp, mm."""

RAMP_SHARE = 1.0 / 3.0
"""Greatest share of the faster part that one of its two ramps takes."""

SHORTEST = 1e-6
"""Length below which a part is joined to its neighbour, at the lower factor, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorPart:
    """Part of a path with one factor on the feedrate."""

    end: float
    """Length of the path up to the end of the part, mm."""
    factor: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _FactorLevel:
    """Stretch of the path between two changes of the factor."""

    begin: float
    end: float
    factor: float

    @property
    def ramp(self) -> float:
        """Length of a ramp within the stretch, mm."""
        return min(RAMP, RAMP_SHARE * (self.end - self.begin))


def factor_curve(parts: Sequence[FactorPart]) -> Spline:
    """B-spline of degree 1 of the factor, with the length of the path as its parameter.

    Parameters
    ----------
    parts : sequence of FactorPart
        Parts in the order of the path, which begins at length 0.

    Returns
    -------
    Spline
        At most the factor of each part, and equal to it except on ramps of at most ``RAMP``
        beside a slower part. A part shorter than ``SHORTEST`` lowers its neighbour.

    Raises
    ------
    ValueError
        If there are no parts, or the path is shorter than ``SHORTEST``.

    Examples
    --------
    >>> parts = [FactorPart(end=2.0, factor=1.0), FactorPart(end=3.0, factor=0.5)]
    >>> curve = factor_curve(parts)
    >>> curve.knots
    (0.0, 0.0, 1.99, 2.0, 3.0, 3.0)
    >>> [factor for factor, *_ in curve.poles]
    [1.0, 1.0, 0.5, 0.5]
    """
    levels = _levels(parts)
    if not levels or levels[-1].end < SHORTEST:
        raise ValueError(f"a curve of factors needs a path of at least {SHORTEST:g} mm")
    knots, factors = [0.0], [levels[0].factor]
    for one, other in pairwise(levels):
        if one.factor > other.factor:
            knots += [one.end - one.ramp, one.end]
            factors += [one.factor, other.factor]
        elif one.factor < other.factor:
            knots += [one.end, one.end + other.ramp]
            factors += [one.factor, other.factor]
    knots.append(levels[-1].end)
    factors.append(levels[-1].factor)
    return Spline(
        degree=1,
        knots=(knots[0], *knots, knots[-1]),
        poles=tuple((factor, 0.0, 0.0) for factor in factors),
    )


def _levels(parts: Sequence[FactorPart]) -> list[_FactorLevel]:
    """Stretches of one factor; short parts are joined to their neighbours."""
    levels: list[_FactorLevel] = []
    begin = 0.0
    for part in parts:
        last = levels[-1] if levels else None
        if last is not None and (
            part.factor == last.factor
            or part.end - begin < SHORTEST
            or last.end - last.begin < SHORTEST
        ):
            factor = min(part.factor, last.factor)
            levels[-1] = replace(last, end=part.end, factor=factor)
        else:
            levels.append(_FactorLevel(begin=begin, end=part.end, factor=part.factor))
        begin = part.end
    return levels
