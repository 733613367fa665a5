"""Settings of a LinuxCNC that its planner depends on."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannerSettings:
    """Settings of LinuxCNC, in its INI file, that its planner depends on."""

    max_feed_override: float = 1.0
    """Greatest feed override; corners are planned for it."""
    servo_period: float = 0.001
    """Servo period, s."""


USUAL = PlannerSettings()
