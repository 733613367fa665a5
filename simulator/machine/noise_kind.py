"""Kinds of sensor noise."""

from enum import StrEnum


class NoiseKind(StrEnum):
    """Kind of noise of a sensor."""

    NONE = "none"
    NORMAL = "normal"
    """Normally distributed noise: 3 % of a force, 20 W of a power."""
    UNIFORM = "uniform"
    """Uniformly distributed noise: 10 % in feed and 5 % in rapid, as in paper 003."""
