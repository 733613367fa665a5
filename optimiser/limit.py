"""One limit of the cut as a monomial: all that the mathematics sees of machining.

A load is ``(c·f^α + e) · a^β · n^γ``, where f is the feed per tooth (per revolution when
nothing has teeth), a the depth of one pass and n the spindle speed. Kienzle forces give
``e = 0``; the edge term of the linear-edge model and the empirical floor of the roughness are
``e``. A limit holds a load below (or above) ``b·n^δ``; a stretch of the spindle's power curve
gives ``δ``.

Units: mm, mm, rev/s; the load has the limit's own canonical unit.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from math import inf


class LimitName(StrEnum):
    """The names by which a limit is told to the user."""

    MOTOR_POWER = "motor_power"
    SPINDLE_TORQUE = "spindle_torque"
    CUTTING_FORCE = "cutting_force"
    TOOL_DEFLECTION = "tool_deflection"
    SHANK_STRENGTH = "shank_strength"
    FEED_PER_TOOTH = "feed_per_tooth"
    CHIP_THICKNESS = "chip_thickness"
    CUTTING_SPEED = "cutting_speed"
    FEED_MECHANISM = "feed_mechanism"
    SPINDLE_SPEED = "spindle_speed"
    AXIAL_DEPTH = "axial_depth"
    ROUGHNESS = "roughness"
    PROGRAMMED_FEED = "programmed_feed"

    @property
    def words(self) -> str:
        """The name as a sentence uses it."""
        return self.value.replace("_", " ")


class Sense(StrEnum):
    """On which side of its bound a load must stay."""

    AT_MOST = "at most"
    AT_LEAST = "at least"


@dataclass(frozen=True, slots=True, kw_only=True)
class Monomial:
    """``(c·f^α + e) · a^β · n^γ`` with c > 0, e ≥ 0, α ≥ 0, β ≥ 0."""

    coefficient: float
    offset: float = 0.0
    feed_exponent: float = 0.0
    depth_exponent: float = 0.0
    speed_exponent: float = 0.0

    def value(self, feed: float, depth: float, speed: float) -> float:
        """Value at one feed per tooth (mm), depth (mm) and spindle speed (rev/s)."""
        return float(
            (self.coefficient * feed**self.feed_exponent + self.offset)
            * depth**self.depth_exponent
            * speed**self.speed_exponent
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """A load at most (or at least) ``b·n^δ``, b > 0."""

    name: LimitName
    load: Monomial
    bound: float
    unit: str
    """unit in which the user reads load and bound"""
    scale: float = 1.0
    """user's number = canonical number · scale"""
    step: float = 1.0
    """what "one more" of the bound means to the user, in the user's unit"""
    sense: Sense = Sense.AT_MOST
    bound_speed_exponent: float = 0.0
    label: str = ""
    """what the user reads instead of the name"""

    @property
    def words(self) -> str:
        """The limit as a sentence uses it."""
        return self.label or self.name.words

    def bound_at(self, speed: float) -> float:
        """Bound at one spindle speed, canonical unit."""
        return float(self.bound * speed**self.bound_speed_exponent)

    def feed_at_bound(self, depth: float, speed: float) -> float:
        """Feed per tooth at which load and bound are equal, mm.

        ``f = ((b·n^δ / (a^β·n^γ) − e) / c)^(1/α)``; infinite when the load does not depend on
        the feed, zero when the offset alone passes the bound.
        """
        load = self.load
        if load.feed_exponent == 0.0:
            return inf
        rest = (
            self.bound
            * speed ** (self.bound_speed_exponent - load.speed_exponent)
            / depth**load.depth_exponent
            - load.offset
        ) / load.coefficient
        return float(rest ** (1.0 / load.feed_exponent)) if rest > 0.0 else 0.0

    def at_depth(self, depth: float) -> "Limit":
        """The same limit for a cut whose depth is given and not chosen."""
        factor = depth**self.load.depth_exponent
        load = replace(
            self.load,
            coefficient=self.load.coefficient * factor,
            offset=self.load.offset * factor,
            depth_exponent=0.0,
        )
        return replace(self, load=load)

    def holds(self, feed: float, depth: float, speed: float) -> bool:
        """Whether the load keeps its bound, up to rounding."""
        load, bound = self.load.value(feed, depth, speed), self.bound_at(speed)
        slack = bound - load if self.sense is Sense.AT_MOST else load - bound
        return slack >= -ROUNDING * bound


ROUNDING = 1e-9
"""relative slack within which a load counts as being at its bound"""
