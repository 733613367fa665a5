"""The axes as they would follow the override if only the feed drives' lag held them back.

Corners, blocks and feed drives that differ from :class:`~controller.law.Plant` make the axes
run another override than this; what they really ran is measured. The force that would have been
measured on these axes, ``F·(mean/actual)^p``, is therefore known, and a law that looks at it
instead of F sees a plant of exactly the nominal lag: it neither winds up while a corner slows
the axes nor swings when the lag is not what it was taken for. PID controllers know the remedy
as tracking of the measured output of the actuator [1]_.

Revolutions are those in which the law is asked: one that was lost counts as not gone by.

References
----------
.. [1] K. J. Åström, T. Hägglund, "Advanced PID Control", ISA, 2006, chapter 3: windup,
   back-calculation and tracking of an actuator that is measured or modelled.
"""

from dataclasses import dataclass
from math import exp, expm1, log

from controller.law import Plant, Situation

FARTHEST = log(20.0)
"""of a force from its set point that is believed, either way, in ln"""
STANDSTILL = 0.1
"""of the floor; axes slower than this tell no force over feed"""
RACING = 10.0
"""of the ceiling; axes do not run faster"""

LEAST = 1e-3
"""override, in place of none"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axes:
    """Overrides that axes of the nominal lag would run, above 0."""

    last: float
    """at the end of the last revolution"""
    mean: float
    """over the last revolution"""


def resting(override: float) -> Axes:
    """Axes that have run an override for long."""
    run = max(override, LEAST)
    return Axes(last=run, mean=run)


def moved(axes: Axes, override: float, *, lag: float) -> Axes:
    """The axes after one more revolution at an override.

    A first-order lag of T revolutions leaves ``exp(−1/T)`` of the way at the revolution's end
    and ``T·(1 − exp(−1/T))`` of it in the mean.
    """
    way = axes.last - override
    return Axes(
        last=override + way * exp(-1.0 / lag), mean=override - way * lag * expm1(-1.0 / lag)
    )


def standing(at: Situation) -> float:
    """Override that a step starts from: one of 0, a held feed, could not be multiplied."""
    return within(at.override, at)


def within(override: float, at: Situation) -> float:
    """The nearest override that the guard lets through."""
    return min(max(override, at.floor), at.ceiling)


def ran(at: Situation) -> float:
    """Override that the axes ran, above 0."""
    return min(max(at.actual, STANDSTILL * at.floor), RACING * at.ceiling)


def shortfall(axes: Axes, at: Situation, *, exponent: float) -> float:
    """Logarithm of set point over the force that these axes would meet; above 0: too little."""
    slowed = log(ran(at)) - log(axes.mean)
    error = log(at.set_point) - log(at.force) + exponent * slowed
    return min(max(error, -FARTHEST), FARTHEST)


def quickening(plant: Plant, closing: float) -> float:
    """Overshoot factor of the command, so that the axes reach their goal sooner.

    To approach with time constant T_c instead of the lag T, sampled once a revolution:
    ``κ = (1 − exp(−1/T_c)) / (1 − exp(−1/T))``.

    Parameters
    ----------
    plant : Plant
        With the lag.
    closing : float, revolutions
        T_c of the closed loop.
    """
    return expm1(-1.0 / closing) / expm1(-1.0 / plant.lag)


def sent(axes: Axes, goal: float, *, quickening: float) -> float:
    """Override that makes the axes approach their goal so much sooner than by themselves."""
    return axes.last + quickening * (goal - axes.last)
