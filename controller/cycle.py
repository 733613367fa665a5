"""One cycle of the loop: what was read, what was commanded, and why. Units N.

Forces are equivalent ones, as the loop acts upon them (:mod:`controller.equivalent`); over the
weight they are those that really were.
"""

from dataclasses import dataclass

from controller.guard import AllowedOverride
from controller.orders import LoopEvent
from controller.signal import Revolution
from simulator.reading import Reading


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopCycle:
    """Results of one control cycle."""

    reading: Reading
    """as it was acted upon"""
    allowed: AllowedOverride
    """the override that was commanded, and what held it"""
    set_point: float
    """N; infinite: none"""
    revolution: Revolution | None
    """that was completed in it"""
    expected: float
    """N at the override that was run, with the catalogue's k_c; 0: no revolution or no cut"""
    ratio: float | None
    """ln(measured / expected force); None: not to be compared"""
    weight: float = 1.0
    """equivalent over real force"""
    events: tuple[LoopEvent, ...]

    @property
    def bound(self) -> float:
        """Real force that uses the whole bound here; infinite: none."""
        return self.set_point / self.weight
