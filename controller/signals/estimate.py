"""Estimate of the ratio of measured to expected cutting force.

The knowledge base learns k_c from this ratio. Statistics are of its logarithm, because the
ratio is a product of factors, each as likely to be a tenth too high as a tenth too low. What
the ratio indicates about tool wear is in :mod:`controller.monitoring.tool_life`. Units: N.

References
----------
.. [1] B. P. Welford, "Note on a method for calculating corrected sums of squares and products",
   Technometrics 4 (1962), 419-420.
"""

from dataclasses import dataclass
from math import log, sqrt

from controller.signals.signal import Revolution
from stepnc_model.outcome import ForceRatio

STEADY = 0.1
"""Greatest change of ln(expected force) between revolutions that are compared.

While depth or feed change, expected and measured force do not refer to the same moment.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RatioEstimate:
    """Running mean and deviation of ln(measured / expected force)."""

    log_mean: float = 0.0
    square_sum: float = 0.0
    """Sum of squared distances from the mean."""
    readings: int = 0
    """Number of revolutions counted so far."""

    @property
    def log_deviation(self) -> float:
        """Standard deviation of a single reading; 0 with fewer than two readings."""
        return sqrt(self.square_sum / (self.readings - 1)) if self.readings > 1 else 0.0


def log_ratio(
    revolution: Revolution, expected: float, *, expected_before: float
) -> float | None:
    """Return ln(measured / expected force) of a revolution, or None when it is left out.

    Left out are revolutions with less than half of their samples, with a mean force that is
    not above 0, out of the cut, and those in which the expected force is not within ``STEADY``
    of that of the revolution before: entries, exits, steps of depth, quick changes of feed.

    Parameters
    ----------
    expected : float, N
        Mean force at the feed that was run, ``g · u^p``, with the catalogue's k_c; 0: no cut.
    expected_before : float, N
        Expected force of the previous revolution; 0: there was none.
    """
    if not (expected > 0.0 and expected_before > 0.0 and revolution.is_covered):
        return None
    if abs(log(expected / expected_before)) > STEADY or not revolution.force > 0.0:
        return None
    return log(revolution.force / expected)


def counted(estimate: RatioEstimate, ratio: float) -> RatioEstimate:
    """Update the statistics with one more ln(measured / expected), [1]_."""
    readings = estimate.readings + 1
    away = ratio - estimate.log_mean
    mean = estimate.log_mean + away / readings
    return RatioEstimate(
        log_mean=mean,
        square_sum=estimate.square_sum + away * (ratio - mean),
        readings=readings,
    )


def force_ratio(estimate: RatioEstimate) -> ForceRatio | None:
    """Force ratio of a workingstep for its outcome record; None with fewer than two readings.

    Consecutive revolutions have similar errors, so the uncertainty of the mean is larger than
    the deviation over the root of their number.
    """
    if estimate.readings < 2:
        return None
    return ForceRatio(
        log_mean=estimate.log_mean,
        log_deviation=estimate.log_deviation,
        readings=estimate.readings,
    )
