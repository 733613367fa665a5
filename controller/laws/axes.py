"""Model of the feed axes that follow the override with a nominal first-order lag.

Corners, blocks and feed drives that differ from :class:`~controller.laws.law.Plant` make the
axes run at another override than this model; the override that they really ran is measured. The
force that would have been measured with the modelled axes, ``F·(mean/actual)^p``, is therefore
known, and a law that uses it instead of F sees a plant of exactly the nominal lag: it neither
winds up while a corner slows the axes nor oscillates when the real lag differs. In PID control
this is known as tracking of the measured actuator output [1]_.

The model advances only in revolutions in which the law is called; lost revolutions do not
count.

References
----------
.. [1] K. J. Åström, T. Hägglund, "Advanced PID Control", ISA, 2006, chapter 3: windup,
   back-calculation and tracking of an actuator that is measured or modelled.
"""

from math import exp, expm1, log
from typing import NamedTuple

from controller.laws.law import Plant, Situation
from stepnc_model.tuples import quick_replace

FARTHEST = log(20.0)
"""Greatest deviation of the force from its set point that is accepted, either way, in ln."""
STANDSTILL = 0.1
"""Share of the floor below which axes are too slow for the force to indicate the load."""
RACING = 10.0
"""Multiple of the ceiling above which the measured override is not credible."""

LEAST = 1e-3
"""Least override used in place of zero."""


@quick_replace
class Axes(NamedTuple):
    """Overrides that axes of the nominal lag would run, above 0."""

    last: float
    """Override at the end of the last revolution."""
    mean: float
    """Mean override over the last revolution."""


def resting(override: float) -> Axes:
    """Axes that have settled at an override."""
    run = max(override, LEAST)
    return Axes(last=run, mean=run)


def moved(axes: Axes, override: float, *, lag: float) -> Axes:
    """Advance the axes by one more revolution at an override.

    A first-order lag of T revolutions leaves ``exp(−1/T)`` of the remaining distance at the end
    of the revolution and ``T·(1 − exp(−1/T))`` of it in the mean.
    """
    way = axes.last - override
    return Axes(
        last=override + way * exp(-1.0 / lag), mean=override - way * lag * expm1(-1.0 / lag)
    )


def standing(at: Situation) -> float:
    """Override that the next step starts from, above 0 even while the feed is held."""
    return within(at.override, at)


def within(override: float, at: Situation) -> float:
    """Clip an override to the range that the guard allows."""
    return min(max(override, at.floor), at.ceiling)


def ran(at: Situation) -> float:
    """Override that the axes ran, clipped to credible values above 0."""
    return min(max(at.actual, STANDSTILL * at.floor), RACING * at.ceiling)


def shortfall(axes: Axes, at: Situation, *, exponent: float) -> float:
    """Logarithm of set point over the force at the modelled axes; above 0: force too low."""
    slowed = log(ran(at)) - log(axes.mean)
    error = log(at.set_point) - log(at.force) + exponent * slowed
    return min(max(error, -FARTHEST), FARTHEST)


def quickening(plant: Plant, closing: float) -> float:
    """Lead factor of the command, so that the axes reach their target sooner.

    To approach with time constant T_c instead of the lag T, sampled once a revolution:
    ``κ = (1 − exp(−1/T_c)) / (1 − exp(−1/T))``.

    Parameters
    ----------
    plant : Plant
        Gives the lag T.
    closing : float, revolutions
        T_c of the closed loop.
    """
    return expm1(-1.0 / closing) / expm1(-1.0 / plant.lag)


def sent(axes: Axes, goal: float, *, quickening: float) -> float:
    """Override command with lead, so that the axes approach their target sooner."""
    return axes.last + quickening * (goal - axes.last)
