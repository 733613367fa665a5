"""One cycle of the loop: what was read, what was commanded, and why. Units N."""

from dataclasses import dataclass

from controller.guard import Allowed
from controller.orders import Event
from controller.signal import Revolution
from simulator.reading import Reading


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cycle:
    """What happened in one cycle."""

    reading: Reading
    """as it was acted upon"""
    allowed: Allowed
    """the override that was commanded, and what held it"""
    set_point: float
    """N; infinite: none"""
    revolution: Revolution | None
    """that was completed in it"""
    expected: float
    """N at the override that was run, with the catalogue's k_c; 0: no revolution or no cut"""
    ratio: float | None
    """ln(measured / expected force); None: not to be compared"""
    events: tuple[Event, ...]
