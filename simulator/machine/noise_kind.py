"""Kinds of noise of sensors."""

from enum import StrEnum


class NoiseKind(StrEnum):
    """Kind of noise of a sensor."""

    NONE = "none"
    NORMAL = "normal"
    """3 % of a force, 20 W of a power, normally distributed"""
    UNIFORM = "uniform"
    """10 % in feed and 5 % in rapid, all errors alike: paper 003"""
