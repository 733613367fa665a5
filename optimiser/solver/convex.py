"""Least value of a convex function of one variable: over whole numbers, and over speeds."""

from collections.abc import Callable
from math import exp, log

TIE = 1e-9
"""Relative difference of cost below which two settings are equally good."""

GOLDEN = (5.0**0.5 - 1.0) / 2.0

SPEED_WIDTH = 1e-8
"""Width of ln n at which the search for the cheapest speed ends; relative error of the cost
about its square."""


def least_of_convex(cost: Callable[[int], float], low: int, high: int, *, guess: int) -> int:
    """Least number in [low, high] at which a convex cost stops falling, found from a guess."""
    at = min(max(guess, low), high)
    here = cost(at)
    is_falling = False
    while at < high and (after := cost(at + 1)) < here * (1.0 - TIE):
        at, here, is_falling = at + 1, after, True
    while not is_falling and at > low and here >= (before := cost(at - 1)) * (1.0 - TIE):
        at, here = at - 1, before
    return at


def least_within(cost: Callable[[float], float], low: float, high: float) -> float:
    """Speed of the least cost between two; the cost is convex in ln n along the feed caps."""
    low, high = log(low), log(high)
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = cost(exp(left)), cost(exp(right))
    # Below this width the cost, flat at its least, no longer changes.
    while high - low > SPEED_WIDTH:
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = cost(exp(left))
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = cost(exp(right))
    return exp(0.5 * (low + high))
