"""Bending of a bar between chuck and tool, with or without a tailstock centre.

An Euler-Bernoulli beam of round sections, clamped at the jaws. The chuck, the spindle and the
centre are assumed to be rigid, so that a real bar bends more. Shear is neglected: it matters
only for bars shorter than three diameters, which hardly bend. Units mm, N.

References
----------
.. [1] S. Timoshenko, "Strength of Materials", part I: deflection by the unit-load method, and
   one redundant support.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

from simulator.physics.domain import require_positive


@dataclass(frozen=True, slots=True, kw_only=True)
class BarSection:
    """Section of a bar with constant diameters."""

    start: float
    """Distance of its start from the jaws, mm."""
    end: float
    """Distance of its end from the jaws, mm, not less than the start."""
    outer: float
    """Outer diameter, mm."""
    inner: float = 0.0
    """Diameter of the bore, mm."""

    @property
    def second_moment(self) -> float:
        """Second moment of area ``I = π·(D⁴ − d⁴)/64``, mm⁴."""
        return pi / 64.0 * (self.outer**4 - self.inner**4)


def compliance(
    sections: Sequence[BarSection],
    at: float,
    *,
    youngs_modulus: float,
    centre: float | None = None,
) -> float:
    """Compliance of a bar across its axis, at the point where the force acts.

    Let ``f(a, b)`` be the deflection at a of the cantilever under a unit force at b. The
    compliance is ``f(a, a)``, or ``f(a, a) − f(a, L)²/f(L, L)`` with a centre at L, [1]_.

    Parameters
    ----------
    sections : sequence of BarSection
        Sections from the jaws on, without gaps.
    at : float, mm
        Distance of the force from the jaws.
    youngs_modulus : float, N/mm²
    centre : float or None, mm
        Distance of a tailstock centre from the jaws, not less than ``at``; None: no centre.

    Returns
    -------
    float, mm/N

    Raises
    ------
    ValueError
        If the bar has no material somewhere before the force, or Young's modulus is not
        positive.

    Examples
    --------
    Steel, 20 mm in diameter, 100 mm out of the chuck:

    >>> bar = [BarSection(start=0.0, end=100.0, outer=20.0)]
    >>> round(1e6 * compliance(bar, 100.0, youngs_modulus=210_000.0), 1)
    202.1
    """
    require_positive(youngs_modulus, "Young's modulus", "N/mm²")
    bent = _integral(sections, at, at)
    if centre is not None and at > 0.0:
        bent -= _integral(sections, at, centre) ** 2 / _integral(sections, centre, centre)
    return max(0.0, bent) / youngs_modulus


def _integral(sections: Sequence[BarSection], at: float, force: float) -> float:
    """Integral ``∫ (a − s)·(b − s)/I ds`` from the jaws to the nearer of both, 1/mm."""
    end = min(at, force)
    total = 0.0
    for part in sections:
        low, high = max(part.start, 0.0), min(part.end, end)
        if low >= high:
            continue
        require_positive(part.second_moment, "second moment of a bar", "mm⁴")
        total += (_primitive(high, at, force) - _primitive(low, at, force)) / part.second_moment
    return total


def _primitive(s: float, a: float, b: float) -> float:
    return a * b * s - 0.5 * (a + b) * s**2 + s**3 / 3.0
