"""Milling technology as NIST proposed it in 2009, with ``adaptive_allowed``.

Quoted in paper 002, "Future work". The keyword remains MILLING_TECHNOLOGY; it is recognised by
its five parameters, two of them references, instead of the standard's nine.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref


class SpeedSpec(Entity, abstract=True):
    """Supertype ``speed_spec``: a speed that may or may not be adapted."""

    adaptive_allowed: bool


class Cutspeed(SpeedSpec):
    """EXPRESS ``cutspeed``: programmed cutting speed."""

    value: float


class SpindleSpeed(SpeedSpec):
    """EXPRESS ``spindle_speed``: programmed spindle speed."""

    value: float


class FeedSpec(Entity, abstract=True):
    """Supertype ``feed_spec``: a feed that may or may not be adapted."""

    adaptive_allowed: bool


class FeedrateTcp(FeedSpec):
    """EXPRESS ``feedrate_tcp``: programmed feed of the tool centre point."""

    value: float


class FeedratePerTooth(FeedSpec):
    """EXPRESS ``feedrate_per_tooth``: programmed feed per tooth."""

    value: float


class AdaptiveMillingTechnology(Entity, abstract=True):
    """EXPRESS ``milling_technology`` in the form proposed by NIST."""

    its_speed: Ref[SpeedSpec]
    its_feed: Ref[FeedSpec]
    synchronize_spindle_with_feed: bool
    inhibit_feedrate_override: bool
    inhibit_spindle_override: bool
