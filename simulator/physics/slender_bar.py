"""Bending of a bar between chuck and tool, with or without a centre at its free end.

An Euler-Bernoulli beam of round sections, built in at the jaws. The chuck, the spindle and the
centre are taken as rigid, so that a real bar bends more; shear is left out: it counts where
the bar is shorter than three diameters, and there it hardly bends. Units mm, N.

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
    """A stretch of a bar with one diameter."""

    start: float
    """Start, mm from the jaws"""
    end: float
    """End, mm from the jaws, not before the start"""
    outer: float
    """Outer, mm, diameter"""
    inner: float = 0.0
    """Inner, mm, diameter of the bore"""

    @property
    def second_moment(self) -> float:
        """``I = π·(D⁴ − d⁴)/64``, mm⁴."""
        return pi / 64.0 * (self.outer**4 - self.inner**4)


def compliance(
    sections: Sequence[BarSection],
    at: float,
    *,
    youngs_modulus: float,
    centre: float | None = None,
) -> float:
    """Deflection of a bar under a force of 1 N across it, where the force acts.

    With ``f(a, b)`` the deflection at a of the cantilever under a unit force at b it is
    ``f(a, a)``, and ``f(a, a) − f(a, L)²/f(L, L)`` with a centre at L, [1]_.

    Parameters
    ----------
    sections : sequence of BarSection
        From the jaws on, without gaps.
    at : float, mm
        From the jaws.
    youngs_modulus : float, N/mm²
    centre : float or None, mm
        Of a tailstock from the jaws, not before the force; None: there is none.

    Returns
    -------
    float, mm/N

    Raises
    ------
    ValueError
        If the bar has nothing left somewhere before the force, or Young's modulus is not
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
    """``∫ (a − s)·(b − s)/I ds`` from the jaws to the nearer of both, 1/mm."""
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
