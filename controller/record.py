"""Summary of a run under control, workingstep by workingstep.

Running state. Units mm, s, N.
"""

from dataclasses import dataclass, field
from math import inf, isfinite

from controller.cycle import LoopCycle
from controller.estimate import RatioEstimate, counted
from controller.signal import Revolution


@dataclass(kw_only=True)
class RunRecord:
    """One workingstep, or what stands before them. Running state."""

    workingstep: int
    time: float = 0.0
    """s"""
    cutting_time: float = 0.0
    """s with chips"""
    way: float = 0.0
    """mm of path with chips"""
    peak: float = 0.0
    """N, where it came nearest to its bound, for some revolutions; without one the greatest"""
    impulse: float = 0.0
    """N·s with chips"""
    excess: float = 0.0
    """N·s above the bound"""
    over_time: float = 0.0
    """s above the bound by more than a twentieth"""
    overrides: float = 0.0
    """s of the program that were cut"""
    least: float = inf
    greatest: float = 0.0
    """override with chips"""
    share: float = 0.0
    """force over its bound, a moving mean"""
    most: float = 0.0
    """greatest such share"""
    set_point: float = inf
    """N, bound of that revolution"""
    revolutions: int = 0
    """with chips"""
    lost: int = 0
    """of them without a force"""
    ratio: RatioEstimate = field(default_factory=RatioEstimate)

    @property
    def feed(self) -> float:
        """Mean with chips, mm/s; 0 without."""
        return self.way / self.cutting_time if self.cutting_time else 0.0

    @property
    def force(self) -> float:
        """Mean with chips, N; 0 without."""
        return self.impulse / self.cutting_time if self.cutting_time else 0.0

    @property
    def override(self) -> float:
        """Mean with chips; 1 without."""
        return self.overrides / self.cutting_time if self.cutting_time else 1.0


LASTING = 0.2
"""weight of a revolution in the moving mean: one that enters a cut, or noise, breaks nothing"""

FREE = 1e9
"""N, in place of no bound"""

EXCESS_RATIO = 1.05
"""times the set point, from which a force counts as over it: its noise is not"""


class Recorder:
    """Gathers the cycles of a run. Running state.

    Parameters
    ----------
    chips : float, N
        Mean of a revolution above which there are chips.
    """

    def __init__(self, chips: float) -> None:
        self.records: dict[int, RunRecord] = {}
        """by the workingstep's number, in the order of their beginning"""
        self._chips = chips

    def add(self, cycle: LoopCycle) -> None:
        """One more cycle."""
        number = cycle.reading.workingstep
        record = self.records.get(number)
        if record is None:
            record = self.records[number] = RunRecord(workingstep=number)
        record.time += cycle.reading.period
        if cycle.revolution is not None:
            self._add(record, cycle, cycle.revolution)

    def _add(self, record: RunRecord, cycle: LoopCycle, revolution: Revolution) -> None:
        if not revolution.is_covered:
            record.lost += 1
            return
        if not revolution.force > self._chips:
            return
        force, bound = revolution.force / cycle.weight, cycle.bound
        period, override = revolution.period, revolution.override
        record.revolutions += 1
        record.cutting_time += period
        record.way += revolution.feed * period
        record.overrides += override * period
        record.least, record.greatest = (
            min(record.least, override),
            max(record.greatest, override),
        )
        record.impulse += force * period
        # Shares of their bounds; where nothing bounds the force, the forces themselves.
        record.share += LASTING * (force / min(bound, FREE) - record.share)
        if record.share > record.most:
            record.most, record.set_point = record.share, bound
            record.peak = record.share * min(bound, FREE)
        if cycle.ratio is not None:
            record.ratio = counted(record.ratio, cycle.ratio)
        if isfinite(bound):
            record.excess += max(force - bound, 0.0) * period
            record.over_time += period * (force > EXCESS_RATIO * bound)
