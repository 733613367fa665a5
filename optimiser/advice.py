"""Results of the optimiser: advice for each workingstep, and the plan for a whole program."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from optimiser.bounds.holding import HoldingLoad
from optimiser.bounds.required_limits import UncheckedLimit
from optimiser.bounds.stability import ChatterRisk, Stability, risk_of
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut
from optimiser.modes import Mode
from optimiser.safety import LEAST_SHARE, USUAL_QUANTILE
from optimiser.solver.problem import BoundSide, Limit, LimitName, Setting
from simulator.physics.surface_spread import LIKELY, RoughnessForecast
from simulator.spec import Machine, MaterialMatch
from stepnc_model.entities.entity import Entity
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import ResolvedWorkingstep
from stepnc_model.programs.technology import Programmed
from stepnc_model.programs.tool import Tool


class AdviceStatus(StrEnum):
    """Outcome of the optimisation of a workingstep."""

    ADVISED = "advised"
    UNTOUCHED = "untouched"
    """The feed stays as programmed: the program locks it, or nothing can be chosen (see
    reason)."""
    INFEASIBLE = "infeasible"


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitLoad:
    """Load of one limit at one setting, with its bound."""

    limit: Limit
    value: float
    """Load at the setting, in the canonical unit of the limit."""
    bound: float
    """Bound on the load times its safety factor, in the canonical unit of the limit."""

    @property
    def margin(self) -> float:
        """Share of the bound left after the safety factor; negative when exceeded."""
        sign = 1.0 if self.limit.sense is BoundSide.AT_MOST else -1.0
        return sign * (self.bound - self.limit.safety_factor * self.value) / self.bound


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatedSetting:
    """Setting of a cut with the resulting time, energy, forces and loads."""

    setting: Setting
    feed: float
    """Feed along the path, mm/s."""
    time: float
    """Machining time, s."""
    energy: float
    """Energy that the machine draws, J."""
    motor_power: float
    """Power of the spindle motor, W."""
    cutting_force: float
    """Cutting force averaged over a revolution, N; of a mill, along its passes."""
    thrust: float
    """Axial force of a drill or of a mill plunging straight down, N; 0 when neither occurs."""
    roughness: float | None
    """Ideal roughness Ra, mm; ``None`` where it does not follow from the feed."""
    loads: tuple[LimitLoad, ...]
    surface: RoughnessForecast | None = None
    """Ra that a finished surface is expected to have; None where nothing is known of it."""
    money: float | None = None
    """Cost of machine time and worn edges, in the machine's currency; None: not stated."""
    lives: float | None = None
    """Tool lives used; None where tool life is unknown."""
    plunge_loads: tuple[LimitLoad, ...] = ()
    """Loads of the limits at the plunge feed, on ways down that have a feed of their own."""
    ramp_force: float = 0.0
    """Cutting force of a mill on a ramp at the plunge feed, revolution mean, N; 0: no ramp."""
    pass_power: float = 0.0
    """Motor power along the passes, W."""
    ramp_power: float = 0.0
    """Motor power of a mill on a ramp at the plunge feed, W; 0: no ramp."""
    plunge_power: float = 0.0
    """Motor power of a mill that plunges straight down, W; 0: no such plunge."""

    @property
    def plunge_feed(self) -> float | None:
        """Feed on the way down into the material, mm/s; None without a plunge feed."""
        per_tooth = self.setting.plunge_feed
        return None if per_tooth is None else self.feed * per_tooth / self.setting.feed


@dataclass(frozen=True, slots=True, kw_only=True)
class ParetoPoint:
    """One point of the Pareto front between time, roughness and energy."""

    state: EvaluatedSetting
    roughness_bound: float | None
    """Roughness Ra that this point had to keep, mm; None: unbounded."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Advice:
    """Optimised setting of one workingstep, with the reasons and the state before and after."""

    workingstep: ResolvedWorkingstep
    tool: Tool
    programmed: Programmed
    status: AdviceStatus
    reason: str
    """One sentence: what limits the feed, why it was not changed, or which limits conflict."""
    cut: Cut | None
    before: EvaluatedSetting | None
    after: EvaluatedSetting | None
    conditions: CuttingConditions | None = None
    """Conditions of the cut; None where no cut is known."""
    force_factor: float = 1.0
    """Accepted correction factor of k_c used for the loads."""
    active: LimitName | None = None
    active_words: str = ""
    """Name of the active limit in words for the user."""
    saving_of_one_more: float = 0.0
    """Time saved if the bound of the active limit were one step wider, s."""
    safety_factor: float = 1.0
    """k_c at the planned quantile, relative to the nominal k_c."""
    saving_of_free_speed: float = 0.0
    """Time saved if the spindle speed were free, on the advised path, s."""
    cost_of_safety: float = 0.0
    """Extra time spent because of planning with the safety quantile, s."""
    deepest_first_time: float | None = None
    """Machining time with the fewest feasible passes, s."""
    prices: tuple[tuple[LimitName, float], ...] = ()
    """Shadow price per limit: relative fall of the cost for a relative rise of the bound."""
    front: tuple[ParetoPoint, ...] = ()
    plunge_reason: str = ""
    """What limits the plunge feed, one sentence; empty when there is no separate plunge
    feed."""
    plunge_fault: str = ""
    """Why the tool must not plunge straight down here; empty when it may."""
    speed_fault: str = ""
    """Limit that a locked spindle speed exceeds; empty when none is exceeded."""
    holding_load: HoldingLoad | None = None
    """Load on the chuck, vice or clamps; None in air, or for a drill on a milling machine."""
    stability: Stability | None = None
    """Chatter stability of the cut; None where chatter does not depend on its depth."""
    unchecked: tuple[UncheckedLimit, ...] = ()
    """Required limits that could not be looked at, or only by a stand-in."""

    @property
    def roughness_probability(self) -> float | None:
        """Probability that the surface keeps its roughness; None where it is not known."""
        state = self.after or self.before
        at = self.conditions
        if state is None or state.surface is None or at is None or at.roughness is None:
            return None
        return state.surface.probability(at.roughness)

    @property
    def chatter_risk(self) -> ChatterRisk | None:
        """Depth beyond the optimistic end of an estimate of the stable depth; None if not."""
        state = self.after or self.before
        if state is None or self.stability is None:
            return None
        return risk_of(self.stability, state.setting.depth)


@dataclass(frozen=True, slots=True, kw_only=True)
class RefusedWorkingstep:
    """Workingstep that cannot be advised, in a plan that keeps going."""

    id: str
    ref: Ref[Entity]
    reason: str
    """What is missing or wrong, with its place in the file."""
    is_infeasible: bool = False
    """Whether no setting was found; False where the file lacks or breaks something."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Optimised feeds for a program: one advice per workingstep."""

    program: str
    mode: Mode
    machine: Machine
    material: MaterialMatch
    advices: tuple[Advice, ...]
    findings: tuple[Finding, ...]
    safety: float = USUAL_QUANTILE
    """Quantile of k_c at which the loads keep their bounds."""
    roughness_quantile: float = LEAST_SHARE
    """Share of real surfaces that keep their roughness."""
    refused: tuple[RefusedWorkingstep, ...] = ()
    """Workingsteps that were left as they are, if the plan keeps going."""

    @property
    def has_bad_data(self) -> bool:
        """True if a workingstep was left as it is because of its data."""
        return any(not each.is_infeasible for each in self.refused)

    @property
    def is_infeasible(self) -> bool:
        """True if any workingstep has no feasible setting."""
        return any(advice.status is AdviceStatus.INFEASIBLE for advice in self.advices) or any(
            each.is_infeasible for each in self.refused
        )

    @property
    def unlikely_surfaces(self) -> tuple[Advice, ...]:
        """Advised workingsteps that are not likely to keep their roughness."""
        return tuple(
            advice
            for advice in self.advices
            if advice.status is AdviceStatus.ADVISED
            and (chance := advice.roughness_probability) is not None
            and chance < LIKELY - 1e-6
        )

    @property
    def unchecked(self) -> tuple[tuple[Advice, UncheckedLimit], ...]:
        """Required limits of the advised workingsteps that could not be looked at."""
        return tuple(
            (advice, limit)
            for advice in self.advices
            if advice.status is AdviceStatus.ADVISED
            for limit in advice.unchecked
        )

    @property
    def faults(self) -> tuple[str, ...]:
        """One sentence for each forbidden plunge and each locked speed that is too fast."""
        return tuple(
            f"{advice.workingstep.id}: {fault}"
            for advice in self.advices
            for fault in (advice.plunge_fault, advice.speed_fault)
            if fault
        )

    @property
    def time_before(self) -> float:
        """Machining time as programmed, in seconds, of the workingsteps whose time is known."""
        return sum(advice.before.time for advice in self.advices if advice.before)

    @property
    def time_after(self) -> float:
        """Machining time as advised, in seconds."""
        return sum(state.time for state in self._final)

    @property
    def energy_before(self) -> float:
        """Energy as programmed, in joules, of the workingsteps whose energy is known."""
        return sum(advice.before.energy for advice in self.advices if advice.before)

    @property
    def energy_after(self) -> float:
        """Energy as advised, in joules."""
        return sum(state.energy for state in self._final)

    @property
    def left_out(self) -> str:
        """Short text naming what the totals leave out."""
        unknown = sum(advice.before is None for advice in self.advices)
        rest = "tool changes and moves between workingsteps"
        return f"{unknown} of the workingsteps (no feed is chosen), {rest}" if unknown else rest

    @property
    def _final(self) -> list[EvaluatedSetting]:
        states = (advice.after or advice.before for advice in self.advices)
        return [state for state in states if state]


def tightest(loads: Sequence[LimitLoad]) -> list[LimitLoad]:
    """Return the load nearest to its bound for each limit and sense."""
    worst: dict[tuple[LimitName, BoundSide], LimitLoad] = {}
    for load in loads:
        key = (load.limit.name, load.limit.sense)
        if key not in worst or load.margin < worst[key].margin:
            worst[key] = load
    return list(worst.values())
