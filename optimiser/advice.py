"""Results of the optimiser: the advice for a workingstep, and the plan of a whole program."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from optimiser.cut import Cut
from optimiser.holding import HoldingLoad
from optimiser.modes import Mode
from optimiser.problem import BoundSide, Limit, LimitName, Setting
from optimiser.safety import USUAL_QUANTILE
from optimiser.stability import Stability
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding
from stepnc_model.program import ResolvedWorkingstep
from stepnc_model.technology import Programmed
from stepnc_model.tool import Tool


class AdviceStatus(StrEnum):
    """Outcome of the optimisation of a workingstep."""

    ADVISED = "advised"
    UNTOUCHED = "untouched"
    """the program forbids it, or no feed is to be chosen; said why"""
    INFEASIBLE = "infeasible"


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitLoad:
    """One limit at one setting."""

    limit: Limit
    value: float
    """canonical unit"""
    bound: float
    """canonical unit, of the load times its safety factor"""

    @property
    def margin(self) -> float:
        """Share of the bound that is left, after the safety factor; negative: passed."""
        sign = 1.0 if self.limit.sense is BoundSide.AT_MOST else -1.0
        return sign * (self.bound - self.limit.safety_factor * self.value) / self.bound


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatedSetting:
    """A setting and what it does."""

    setting: Setting
    feed: float
    """Feed, mm/s"""
    time: float
    """Time, s"""
    energy: float
    """Energy, J"""
    motor_power: float
    """Motor power, W"""
    cutting_force: float
    """Cutting force, N, mean of a revolution; of a mill along its passes"""
    thrust: float
    """Thrust, N, along the axis, of a drill or of a mill that goes straight down; 0: of none"""
    roughness: float | None
    """Ra in mm; ``None`` where the feed does not describe it"""
    loads: tuple[LimitLoad, ...]
    plunge_loads: tuple[LimitLoad, ...] = ()
    """at the plunge feed, on the ways down that have one of their own"""
    ramp_force: float = 0.0
    """N, mean of a revolution, of a mill down a ramp at the plunge feed; 0: of none"""
    plunge_power: float = 0.0
    """Plunge power, W of the motor at the plunge feed; 0: of none"""

    @property
    def plunge_feed(self) -> float | None:
        """Feed on the way down into the material, mm/s; None: there is none of its own."""
        per_tooth = self.setting.plunge_feed
        return None if per_tooth is None else self.feed * per_tooth / self.setting.feed


@dataclass(frozen=True, slots=True, kw_only=True)
class ParetoPoint:
    """One point of the front between time, roughness and energy."""

    state: EvaluatedSetting
    roughness_bound: float | None
    """Ra in mm that this point had to keep"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Advice:
    """Advice for one workingstep."""

    workingstep: ResolvedWorkingstep
    tool: Tool
    programmed: Programmed
    status: AdviceStatus
    reason: str
    """one sentence: what holds the feed, why it was not touched, or what conflicts"""
    cut: Cut | None
    before: EvaluatedSetting | None
    after: EvaluatedSetting | None
    force_factor: float = 1.0
    """accepted correction of k_c that the loads were told with"""
    active: LimitName | None = None
    active_words: str = ""
    """the same as the user reads it"""
    saving_of_one_more: float = 0.0
    """Saving of one more, s saved by one more step of the active limit"""
    safety_factor: float = 1.0
    """k_c at the quantile that is planned with, over the nominal one"""
    saving_of_free_speed: float = 0.0
    """s saved if the spindle speed were free, on the path of the advice"""
    cost_of_safety: float = 0.0
    """Cost of safety, s that planning with that quantile costs"""
    deepest_first_time: float | None = None
    """Deepest first time, s with the fewest passes"""
    prices: tuple[tuple[LimitName, float], ...] = ()
    """relative fall of the cost for a relative rise of the bound"""
    front: tuple[ParetoPoint, ...] = ()
    plunge_reason: str = ""
    """one sentence: what holds the plunge feed; empty where there is none of its own"""
    plunge_fault: str = ""
    """why the tool may not go straight down here; empty where it may"""
    speed_fault: str = ""
    """bound that a locked speed exceeds; empty where none"""
    holding_load: HoldingLoad | None = None
    """what is asked of chuck, vice or clamps; None: nothing, or of a drill on a mill"""
    stability: Stability | None = None
    """what is known of it; None: chatter is no matter of this cut's depth"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Advice for a program."""

    program: str
    mode: Mode
    machine: Machine
    material: MaterialMatch
    advices: tuple[Advice, ...]
    findings: tuple[Finding, ...]
    safety: float = USUAL_QUANTILE
    """quantile of k_c at which loads keep their bounds"""

    @property
    def is_infeasible(self) -> bool:
        """Whether some workingstep has no feasible setting."""
        return any(advice.status is AdviceStatus.INFEASIBLE for advice in self.advices)

    @property
    def faults(self) -> tuple[str, ...]:
        """A sentence for each plunge of a tool that cannot, and each speed that is too fast."""
        return tuple(
            f"{advice.workingstep.id}: {fault}"
            for advice in self.advices
            for fault in (advice.plunge_fault, advice.speed_fault)
            if fault
        )

    @property
    def time_before(self) -> float:
        """Seconds as programmed, of the workingsteps whose time is known."""
        return sum(advice.before.time for advice in self.advices if advice.before)

    @property
    def time_after(self) -> float:
        """Seconds as advised."""
        return sum(state.time for state in self._final)

    @property
    def energy_before(self) -> float:
        """Joules as programmed, of the workingsteps whose energy is known."""
        return sum(advice.before.energy for advice in self.advices if advice.before)

    @property
    def energy_after(self) -> float:
        """Joules as advised."""
        return sum(state.energy for state in self._final)

    @property
    def left_out(self) -> str:
        """Remarks on what the totals leave out."""
        unknown = sum(advice.before is None for advice in self.advices)
        rest = "tool changes and moves between workingsteps"
        return f"{unknown} of the workingsteps (no feed is chosen), {rest}" if unknown else rest

    @property
    def _final(self) -> list[EvaluatedSetting]:
        states = (advice.after or advice.before for advice in self.advices)
        return [state for state in states if state]


def tightest(loads: Sequence[LimitLoad]) -> list[LimitLoad]:
    """One load for each limit and sense: the one that is nearest to its bound."""
    worst: dict[tuple[LimitName, BoundSide], LimitLoad] = {}
    for load in loads:
        key = (load.limit.name, load.limit.sense)
        if key not in worst or load.margin < worst[key].margin:
            worst[key] = load
    return list(worst.values())
