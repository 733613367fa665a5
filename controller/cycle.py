"""Result of one control cycle: reading, commanded override and its reason. Units: N.

Forces are the equivalent forces that the loop controls
(:mod:`controller.states.equivalent_force`); divided by the weight they are the real ones.
"""

from typing import NamedTuple

from controller.guard import AllowedOverride
from controller.monitoring.monitor import NOT_OVER, OverTime
from controller.monitoring.tool_life import ToolLife
from controller.orders import LoopEvent
from controller.signals.signal import Revolution
from simulator.reading import Reading
from stepnc_model.tuples import quick_replace


@quick_replace
class LoopCycle(NamedTuple):
    """Reading, override, set point and events of one control cycle."""

    reading: Reading
    """Conditioned reading that the loop acted upon."""
    allowed: AllowedOverride
    """Commanded override and the reason that limited it."""
    set_point: float
    """Set point of the force, N; infinite without one."""
    revolution: Revolution | None
    """Spindle revolution completed in this cycle, if any."""
    expected: float
    """Expected force at the override that was run with catalogue k_c, N; 0: no cut."""
    ratio: float | None
    """ln(measured / expected force); None when not comparable."""
    events: tuple[LoopEvent, ...]
    weight: float = 1.0
    """Weight: equivalent force over real force."""
    over: OverTime = NOT_OVER
    """How long the force has been above its set point."""
    life: ToolLife | None = None
    """Wear of the tool, once forces were compared; None: nothing is known."""
    sharp_ratio: float | None = None
    """The ratio without the force of the wear land; None when not comparable."""
    is_astray: bool = False
    """Whether the axes do not follow the override."""

    @property
    def bound(self) -> float:
        """Real force that uses the whole bound at this place, N; infinite without a bound."""
        return self.set_point / self.weight
