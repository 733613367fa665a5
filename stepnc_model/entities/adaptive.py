"""Milling technology as NIST proposed it in 2009, with ``adaptive_allowed``.

Quoted in paper 002, "Future work". The keyword stays MILLING_TECHNOLOGY; five parameters, two
of them references, tell it from the standard's nine.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref


class SpeedSpec(Entity, abstract=True):
    """Supertype ``speed_spec``."""

    adaptive_allowed: bool


class Cutspeed(SpeedSpec):
    """EXPRESS ``cutspeed``."""

    value: float


class SpindleSpeed(SpeedSpec):
    """EXPRESS ``spindle_speed``."""

    value: float


class FeedSpec(Entity, abstract=True):
    """Supertype ``feed_spec``."""

    adaptive_allowed: bool


class FeedrateTcp(FeedSpec):
    """EXPRESS ``feedrate_tcp``."""

    value: float


class FeedratePerTooth(FeedSpec):
    """EXPRESS ``feedrate_per_tooth``."""

    value: float


class AdaptiveMillingTechnology(Entity, abstract=True):
    """EXPRESS ``milling_technology`` in the proposed form."""

    its_speed: Ref[SpeedSpec]
    its_feed: Ref[FeedSpec]
    synchronize_spindle_with_feed: bool
    inhibit_feedrate_override: bool
    inhibit_spindle_override: bool
