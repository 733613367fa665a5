"""Geometry of points, and the engagement or size for which windows of a tool are valid.

Units: mm.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class DrillPoint:
    """Point geometry of a tool that cuts with its end."""

    thrust_share: float
    """Thrust of the lips over their tangential force times sin κ."""
    chisel_ratio: float
    """Length of the chisel edge over the diameter, c/D; 0 without chisel edge."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedWindow:
    """Engagement for which the feeds per tooth of a milling cutter are valid."""

    width_ratio: float
    """Greatest a_e/D for which the feeds are valid."""
    slot_factor: float
    """Factor on the feeds in a full slot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthWindow:
    """Engagement for which the depths of a milling cutter are valid."""

    width_ratio: float
    """Greatest a_e/D for which the depths are valid."""
    slot_ratio: float
    """Greatest axial depth over the diameter in a full slot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReamingAllowance:
    """Allowance on the diameter for reamers up to a diameter."""

    up_to: float
    """Greatest diameter of these reamers, mm."""
    least: float
    """Least allowance on the diameter, mm; with less the edges rub."""
    greatest: float
    """Greatest allowance on the diameter, mm."""
    source: str
