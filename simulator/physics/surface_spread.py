"""Distribution of the roughness Ra that a real cut leaves, around the ideal of feed and corner.

``ln Ra = ln(c·Ra_ideal·z^(2·k) + R₀·(v/150)^−γ·e^(δ·dry)) + ε``, v in m/min held to 60 to 250:
the feed's trace, and a floor that the feed does not explain. z^(2k) is for milling cutters,
whose trace lies between that of equal teeth (k = 0, feed per tooth) and that of one high tooth
(k = 1, feed per revolution). The parameters are known with a covariance only, and ε has the
deviation σ, so that a feed leaves a median and a spread. Worn edges, wipers, boring bars and
slender parts leave rougher surfaces than this.

Lengths in **mm**, as everywhere; R₀ is in µm inside the model, as it was published.

References
----------
.. [1] Median and spread of c, R₀, γ, δ: 108 surfaces of AISI 1045, Adv. Mater. Sci. Eng. 2018,
   2560253, table 3, and the spread between nine published studies of turning and milling.
.. [2] Tungaloy catalogue 2020, L061: the one or two highest inserts make a milled surface.
.. [3] M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 1964; 26.7.5.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import exp, log, sqrt
from statistics import NormalDist

from simulator.surface_law import SurfaceSpread
from stepnc_model.units import m_min_from_speed, mm_from_um, um_from_mm

REFERENCE_SPEED = 150.0  # m/min
HELD_SPEED = (60.0, 250.0)  # m/min
RA_SHARE = (log(0.7), 0.40)  # ln c: mean and sd, [1]
RA_LEVEL = (log(0.7), 0.65)  # ln R₀, µm at 150 m/min and wet, [1]
RA_SPEED = {True: (0.8, 0.4), False: (0.0, 0.2)}  # γ; no built-up edge in groups N and K
RA_DRY = (0.45, 0.2)  # δ, [1]
RA_WEAR = (0.0, 1.0)  # of the growth with flank wear, in its relative deviation
CONTACT = (0.43, 0.38)  # k; uniform over 1 … z teeth in contact, [2]
RA_SCATTER = 0.22  # σ, deviation of ln Ra of one surface, [1]
SCATTER_DEGREES = 5.6  # degrees of freedom with which σ is known

LIKELY = 0.9
"""Probability of keeping a roughness from which it counts as promised."""

LARGEST_DEVIATE = 8.0
"""Standard deviations beyond which a probability is 0 or 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RoughnessForecast:
    """Ra that a cut leaves: ideal, median, and the spread around it."""

    ideal: float
    """Trace of feed and corner, mm."""
    median: float
    """Ra that half of the surfaces keep, mm."""
    deviation: float
    """Standard deviation of ln Ra."""
    degrees: float
    """Degrees of freedom of Student's distribution of ln Ra."""

    def quantile(self, share: float) -> float:
        """Ra that a share of the surfaces keeps, mm."""
        return self.median * exp(student_quantile(share, self.degrees) * self.deviation)

    def probability(self, roughness: float) -> float:
        """Probability that the surface keeps an Ra, mm."""
        away = log(roughness / self.median) / self.deviation
        low, high = -LARGEST_DEVIATE, LARGEST_DEVIATE
        # The expansion rises with the normal deviate; its inverse has no closed form.
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (
                (middle, high) if _student(middle, self.degrees) < away else (low, middle)
            )
        return NormalDist().cdf(low)


@lru_cache(maxsize=8)
def unmeasured_spread(iso_group: str) -> SurfaceSpread:
    """Spread between published studies, for a shop that has measured no surface."""
    known = (
        RA_SHARE, RA_LEVEL, RA_SPEED[iso_group not in {"N", "K"}], RA_DRY, RA_WEAR, CONTACT,
    )  # fmt: skip
    return SurfaceSpread(
        mean=tuple(mean for mean, _ in known),
        covariance=tuple(
            tuple(sd * sd if row == column else 0.0 for column in range(len(known)))
            for row, (_, sd) in enumerate(known)
        ),
        sigma=RA_SCATTER,
        degrees=SCATTER_DEGREES,
    )


def forecast(
    spread: SurfaceSpread, ideal: float, *, cutting_speed: float, is_dry: bool, teeth: int = 1
) -> RoughnessForecast:
    """Roughness that a sharp edge leaves.

    Parameters
    ----------
    spread : SurfaceSpread
    ideal : float, mm
        Ideal Ra of the feed per tooth, or per revolution of a turned part; 0: the floor alone.
    cutting_speed : float, mm/s
    is_dry : bool
    teeth : int
        Teeth of a milling cutter whose corner or flank leaves the surface; 1 in turning.
    """
    gain, level, slope, dry, _, contact = spread.mean
    low, high = HELD_SPEED
    speed = min(max(m_min_from_speed(cutting_speed), low), high)
    fast, marks = log(speed / REFERENCE_SPEED), 2.0 * log(teeth)
    trace = um_from_mm(ideal) * exp(gain + contact * marks)
    floor = exp(level - slope * fast + dry * is_dry)
    share = trace / (trace + floor)
    rest = 1.0 - share
    # Derivatives of ln Ra by the parameters, of a sharp edge.
    by = (share, rest, -rest * fast, rest * is_dry, 0.0, share * marks)
    known = sum(
        one * two * spread.covariance[row][column]
        for row, one in enumerate(by)
        for column, two in enumerate(by)
    )
    return RoughnessForecast(
        ideal=ideal,
        median=mm_from_um(trace + floor),
        deviation=sqrt(known + spread.sigma**2),
        degrees=spread.degrees,
    )


def student_quantile(share: float, degrees: float) -> float:
    """Quantile of Student's t distribution.

    Expansion in the normal quantile, [3]_ eq. 26.7.5: within 0.7 % from 4 degrees of freedom
    on, between the quantiles 0.01 and 0.99.
    """
    return _student(NormalDist().inv_cdf(share), degrees)


def _student(z: float, degrees: float) -> float:
    """Student's deviate of a normal deviate."""
    return (
        z
        + (z**3 + z) / (4.0 * degrees)
        + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * degrees**2)
        + (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / (384.0 * degrees**3)
    )
