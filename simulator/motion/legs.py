"""Legs of a tool path from rest to rest, and the spindle during them. Units s, rev/s."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleRamp:
    """Change of the spindle speed that begins with a leg, at constant surface speed."""

    speed: float
    """Speed to be reached, rev/s."""
    acceleration: float
    """Acceleration of the spindle, rev/s²; may be infinite."""
    is_awaited: bool
    """Whether the feed after the leg waits until the speed is reached."""

    def time_from(self, speed: float) -> float:
        """Time that the change takes from a speed in rev/s, s."""
        return abs(self.speed - speed) / self.acceleration

    def after(self, seconds: float, speed: float) -> float:
        """Speed some time after it was a given speed, rev/s."""
        change = self.acceleration * seconds if seconds > 0.0 else 0.0
        return min(max(self.speed, speed - change), speed + change)


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """Part of a run from rest to rest, by its rows, with the wait after it."""

    first: int
    last: int
    """Row after the last row of the leg."""
    wait: float
    """Waiting time after the leg, s."""
    ramp: SpindleRamp | None = None
    """Change of the spindle speed during rapids; None: the spindle follows, or keeps its
    speed."""
    spindle: float | None = None
    """Spindle speed at the end of a leg of feeds at constant surface speed, rev/s."""
