"""Margin on forces: the quantile of k_c at which bounds are kept.

k_c of a catalogue is a median that real material scatters around, by a factor as often up as
down: ln k_c is normal with ``σ = ln(1 + s)``, s the relative spread. Loads are in proportion to
k_c, so that a bound kept by the load at a quantile is passed with the probability that is left.
"""

from math import exp, log

USUAL_QUANTILE = 0.9
"""one cut in ten may need more force than was planned for"""

LEAST_QUANTILE, GREATEST_QUANTILE = 0.5, 0.999
"""nominal; above the other, results would depend on an unknown tail of the distribution"""


def require_quantile(quantile: float) -> None:
    """Refuse what is no quantile to plan with.

    Raises
    ------
    ValueError
        With the bounds.
    """
    if not LEAST_QUANTILE <= quantile <= GREATEST_QUANTILE:
        raise ValueError(
            f"safety {quantile:g}: it must be {LEAST_QUANTILE:g} to {GREATEST_QUANTILE:g}"
        )


def safety_factor(spread: float, quantile: float) -> float:
    """k_c at a quantile over its median: ``exp(z·ln(1 + s))``, z the normal quantile.

    Examples
    --------
    >>> round(safety_factor(0.2, 0.9), 3)
    1.263
    """
    if quantile == LEAST_QUANTILE:
        return 1.0
    from statistics import NormalDist  # noqa: PLC0415 (15 ms of a start)

    return exp(NormalDist().inv_cdf(quantile) * log(1.0 + spread))
