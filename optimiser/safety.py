"""Safety margin on forces: the quantile of k_c at which bounds are kept.

The k_c of a catalogue is a median around which real material scatters: ln k_c is normally
distributed with ``σ = ln(1 + s)``, s the relative spread. Loads are proportional to k_c, so a
bound kept at the quantile q is exceeded with the probability 1 − q.
"""

from math import exp, log

USUAL_QUANTILE = 0.9
"""Default quantile: one cut in ten may need more force than was planned for."""

LEAST_QUANTILE, GREATEST_QUANTILE = 0.5, 0.999
"""Range of the quantile: nominal, to where the tail of the distribution is unknown."""

LEAST_SHARE, GREATEST_SHARE = 0.5, 0.99
"""Range of the share of surfaces that a plan may promise to keep a roughness."""


def require_quantile(quantile: float) -> None:
    """Check that a quantile is within the supported range.

    Raises
    ------
    ValueError
        When it is not; the message states the range.
    """
    if not LEAST_QUANTILE <= quantile <= GREATEST_QUANTILE:
        raise ValueError(
            f"safety {quantile:g}: it must be {LEAST_QUANTILE:g} to {GREATEST_QUANTILE:g}"
        )


def safety_factor(spread: float, quantile: float) -> float:
    """Ratio of k_c at a quantile to its median, ``exp(z·ln(1 + s))``, z the normal quantile.

    Examples
    --------
    >>> round(safety_factor(0.2, 0.9), 3)
    1.263
    """
    if quantile == LEAST_QUANTILE:
        return 1.0
    from statistics import NormalDist  # noqa: PLC0415 (15 ms of a start)

    return exp(NormalDist().inv_cdf(quantile) * log(1.0 + spread))


USUAL_RISE = 3.0
"""Feed over the programmed one, at most, unless the user permits more."""
