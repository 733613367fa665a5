"""Summary of a controlled run, per workingstep.

Mutable state. Units: mm, s, N.
"""

from dataclasses import dataclass, field
from math import inf, isfinite, isnan

from controller.cycle import LoopCycle
from controller.monitoring.monitor import NOT_OVER, OverTime
from controller.monitoring.tool_life import ToolLife
from controller.signals.estimate import RatioEstimate, counted
from controller.signals.signal import Revolution


@dataclass(kw_only=True)
class RunRecord:
    """Summary of one workingstep, or of the time before the first (mutable state)."""

    workingstep: int
    time: float = 0.0
    """Total time of the workingstep, s."""
    cutting_time: float = 0.0
    """Time with chips, s."""
    way: float = 0.0
    """Length of path run with chips, mm."""
    peak: float = 0.0
    """Force of some revolutions that came nearest to its bound, N; without a bound the
    greatest."""
    impulse: float = 0.0
    """Integral of the force with chips, N·s."""
    excess: float = 0.0
    """Integral of the force above the bound, N·s."""
    over_time: float = 0.0
    """Time with a force above the bound by more than a twentieth, s."""
    longest_over: OverTime = NOT_OVER
    """Longest time without a break in which the mean force was above the bound."""
    overrides: float = 0.0
    """Integral of the override with chips: program time that was cut, s."""
    least: float = inf
    greatest: float = 0.0
    """Greatest override with chips."""
    share: float = 0.0
    """Moving mean of the force over its bound."""
    most: float = 0.0
    """Greatest moving mean of the force over its bound."""
    set_point: float = inf
    """Bound of the revolution with the greatest share, N."""
    revolutions: int = 0
    """Number of revolutions with chips."""
    life: ToolLife | None = None
    """Wear of the tool at the end; None: nothing is known."""
    power: float = 0.0
    """Greatest mean power of the main drive in a revolution with chips, W."""
    work: float = 0.0
    """Work of the main drive with chips, W·s."""
    astray: float = 0.0
    """Time in which the axes did not run the commanded override, s."""
    lost: int = 0
    """Number of revolutions without a valid force."""
    ratio: RatioEstimate = field(default_factory=RatioEstimate)

    @property
    def feed(self) -> float:
        """Mean feed with chips, mm/s; 0 without chips."""
        return self.way / self.cutting_time if self.cutting_time else 0.0

    @property
    def force(self) -> float:
        """Mean force with chips, N; 0 without chips."""
        return self.impulse / self.cutting_time if self.cutting_time else 0.0

    @property
    def mean_power(self) -> float:
        """Mean power of the main drive with chips, W; 0 without chips."""
        return self.work / self.cutting_time if self.cutting_time else 0.0

    @property
    def override(self) -> float:
        """Mean override with chips; 1 without chips."""
        return self.overrides / self.cutting_time if self.cutting_time else 1.0


LASTING = 0.2
"""Weight of a revolution in the moving mean, so that noise or one entry does not dominate."""

FREE = 1e9
"""Force used in place of an infinite bound, N."""

EXCESS_RATIO = 1.05
"""Factor on the set point above which a force counts as over it, to allow for noise."""


class Recorder:
    """Recorder that gathers the cycles of a run into summaries (mutable state).

    Parameters
    ----------
    chips : float, N
        Revolution mean force above which there are chips.
    """

    def __init__(self, chips: float) -> None:
        self.records: dict[int, RunRecord] = {}
        """Summaries by workingstep number, in the order in which they began."""
        self._chips = chips

    def add(self, cycle: LoopCycle) -> None:
        """Add one control cycle to the summary of its workingstep."""
        number = cycle.reading.workingstep
        record = self.records.get(number)
        if record is None:
            record = self.records[number] = RunRecord(workingstep=number)
        record.time += cycle.reading.period
        record.astray += cycle.is_astray * cycle.reading.period
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
        record.revolutions += max(round(revolution.turns), 1)
        record.cutting_time += period
        record.way += revolution.feed * period
        record.overrides += override * period
        record.least, record.greatest = (
            min(record.least, override),
            max(record.greatest, override),
        )
        record.impulse += force * period
        # Shares of the bounds; where nothing limits the force, the forces themselves.
        record.share += LASTING * (force / min(bound, FREE) - record.share)
        if record.share > record.most:
            record.most, record.set_point = record.share, bound
            record.peak = record.share * min(bound, FREE)
        if cycle.over.seconds >= record.longest_over.seconds:
            record.longest_over = cycle.over
        record.life = cycle.life or record.life
        if not isnan(revolution.power):
            record.power = max(record.power, revolution.power)
            record.work += revolution.power * period
        if cycle.sharp_ratio is not None:
            record.ratio = counted(record.ratio, cycle.sharp_ratio)
        if isfinite(bound):
            record.excess += max(force - bound, 0.0) * period
            record.over_time += period * (force > EXCESS_RATIO * bound)
