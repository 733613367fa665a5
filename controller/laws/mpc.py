"""Model predictive control (MPC) of the cutting force: plans the override ahead.

Once a revolution ``ln K = ln F − ln g − p·ln m`` is measured, m the mean override that the axes
ran, and filtered: the disturbance estimate that makes the law free of offset [1]_. With it each
of the next revolutions has a cap, the override at which its force meets the set point,
``c_j = (F_ref / (K·g_j))^(1/p)``, and OSQP [2]_ solves the program of
:mod:`controller.laws.horizon`; the first command is the decision. Where nothing is known ahead,
g stays as it is.

Targets are the least cap up to each revolution, so a lighter cut is answered only when it
begins, since the program would otherwise slow down first in order to rise earlier. Where OSQP
does not find the solution within its iterations, the decision is the least cap of the
horizon, within the rise: the steady-state inverse of the model, which does not compensate for
the lag.

Decisions depend on state and situation only: every solve starts from what the state holds. The
workspace of the solver is reused, so an object serves one thread at a time.

References
----------
.. [1] G. Pannocchia, J. B. Rawlings, "Disturbance models for offset-free model-predictive
   control", AIChE J. 49 (2003) 426-437, doi:10.1002/aic.690490213.
.. [2] B. Stellato et al., "OSQP: an operator splitting solver for quadratic programs", Math.
   Prog. Comp. 12 (2020) 637-672, doi:10.1007/s12532-020-00179-2.
"""

from dataclasses import dataclass, field
from math import log
from typing import Any

import numpy as np
import osqp

from controller.laws.horizon import (
    LENGTH,
    Horizon,
    Outlook,
    horizon,
    lingering,
    remaining,
    vectors,
)
from controller.laws.law import Plant, Situation
from controller.signals.ports import Floats

LEARNING = 0.4
"""Filter gain: share of the deviation of a measured ln K that is adopted."""
SURPRISE = 1.0
"""Greatest deviation of ln K that is accepted in one revolution."""
RISE = 0.5
"""Greatest rise of the override per revolution."""
FALL = 1.0
"""Greatest fall of the override per revolution."""
LEAST, MOST = 0.01, 10.0
"""Range of overrides in which the program is formulated, whatever the band."""
NARROWEST = 1.01
"""Least ceiling over floor in the program; OSQP refactorises if a band becomes an equality."""
CHECKED = 5
"""Number of iterations after which OSQP checks for termination."""
SETTINGS = {
    "verbose": False,
    "rho": 0.4,
    "adaptive_rho": False,
    "polishing": False,
    "check_termination": CHECKED,
    "eps_abs": 1e-4,
    "eps_rel": 0.0,
}
"""Settings of OSQP, in units of the least cap; a fixed rho keeps calls independent."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MpcState:
    """State of the MPC law that one decision leaves to the next."""

    log_factor: float | None
    """Filtered ln K; None before anything was measured."""
    expected: float
    """Expected force g to which K refers, N; 0: never known, and K stands for K·g."""
    plan: Floats
    """Planned commands and excess of the next revolutions, from the last decision, (2H,)."""
    prices: Floats
    """Dual variables of caps, band and moves, from the last decision, (3H,)."""
    is_planned: bool
    """Whether the last decision came from the program; otherwise it was the least cap."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelPredictive:
    """Model predictive control law, with preview where the situation includes it."""

    plant: Plant = field(default_factory=Plant)
    iterations: int = 400
    """Greatest number of solver iterations, some 0.4 ms."""
    _horizon: Horizon = field(init=False, repr=False, compare=False)
    _solver: Any = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not (self.plant.lag > 0.0 and self.plant.exponent > 0.0):
            raise ValueError(f"lag and exponent must be above 0: {self.plant}")
        over = horizon(self.plant.lag)
        object.__setattr__(self, "_horizon", over)
        object.__setattr__(self, "_solver", _solver(over, iterations=self.iterations))

    def begin(self, override: float) -> MpcState:
        """Initial state: nothing measured, and a plan to stay at the override."""
        return MpcState(
            log_factor=None,
            expected=0.0,
            plan=np.repeat([min(max(override, LEAST), MOST), 0.0], LENGTH),
            prices=np.zeros(3 * LENGTH),
            is_planned=True,
        )

    def decide(self, state: MpcState, at: Situation) -> tuple[MpcState, float]:
        """Decide the next override; the values of the situation must be finite."""
        expected = at.expected if at.expected > 0.0 else state.expected
        factor = _learned(state, at, exponent=self.plant.exponent)
        outlook = _outlook(at, _needed(at, factor, expected=expected), plant=self.plant)
        # Scaling by the least cap makes the solver's tolerance relative to the decision.
        unit = float(outlook.caps.min())
        program = vectors(self._horizon, outlook)
        self._solver.update(
            q=program.linear / unit, l=program.lower / unit, u=program.upper / unit
        )
        self._solver.warm_start(x=_later(state.plan) / unit, y=_later(state.prices) / unit)
        found = self._solver.solve(raise_error=False)
        is_planned = found.info.status_val == osqp.SolverStatus.OSQP_SOLVED
        if is_planned:
            plan, prices = found.x * unit, found.y * unit
        else:
            wanted = min(unit, outlook.command + RISE)
            plan, prices = np.repeat([wanted, 0.0], LENGTH), np.zeros(3 * LENGTH)
        following = MpcState(
            log_factor=factor,
            expected=expected,
            plan=plan,
            prices=prices,
            is_planned=is_planned,
        )
        return following, min(max(float(plan[0]), at.floor), at.ceiling)


def _solver(over: Horizon, *, iterations: int) -> Any:
    """Set up the OSQP solver; its matrices are scaled and factorised once."""
    solver = osqp.OSQP()
    solver.setup(
        P=over.quadratic,
        q=np.zeros(2 * LENGTH),
        A=over.rows,
        # Bounds of the same kind as later: caps from above, band and moves on both sides.
        l=np.repeat([-np.inf, 0.0, -1.0], LENGTH),
        u=np.ones(3 * LENGTH),
        max_iter=iterations,
        **SETTINGS,
    )
    return solver


def _learned(state: MpcState, at: Situation, *, exponent: float) -> float | None:
    """Filtered ln K after one more revolution."""
    before = state.log_factor
    if state.expected == 0.0 and at.expected > 0.0:
        # From now on K refers to g, and the expected force is assumed correct until measured.
        before = 0.0
    if at.actual < LEAST:
        # The force at standing axes does not indicate the load at feed.
        return before
    expected = at.expected if at.expected > 0.0 else state.expected
    measured = log(at.force) - log(expected or 1.0) - exponent * log(at.actual)
    if before is None:
        return measured
    return before + LEARNING * min(max(measured - before, -SURPRISE), SURPRISE)


def _needed(at: Situation, log_factor: float | None, *, expected: float) -> Floats | None:
    """Logarithm of allowed force over force at override 1, (H,); None before a measurement."""
    if log_factor is None:
        return None
    return log(at.set_point) - log_factor - np.log(_coming(at, expected or 1.0))


def _coming(at: Situation, expected: float) -> Floats:
    """Expected force g of each of the next revolutions, (H,), N; unknown values are kept."""
    if at.expected <= 0.0 or not at.ahead:
        return np.full(LENGTH, expected)
    coming, last = [], expected
    for each in at.ahead[:LENGTH]:
        last = each if each > 0.0 else last
        coming.append(last)
    return np.array(coming + [last] * (LENGTH - len(coming)))


def _outlook(at: Situation, needed: Floats | None, *, plant: Plant) -> Outlook:
    """Build the inputs of the quadratic program from the situation."""
    floor = min(max(at.floor, LEAST), MOST / NARROWEST)
    ceiling = max(min(at.ceiling, MOST), NARROWEST * floor)
    command = min(max(at.override, floor), ceiling)
    if needed is None:
        caps = np.full(LENGTH, command)
    else:
        caps = np.exp((needed / plant.exponent).clip(log(floor), log(ceiling)))
    # Share of the distance missing in the mean that is still missing at the end.
    lacking = remaining(plant.lag) / lingering(plant.lag)
    axes = at.override + lacking * (at.actual - at.override)
    return Outlook(
        axes=min(max(axes, 0.0), MOST),
        command=command,
        caps=caps,
        targets=np.minimum.accumulate(caps),
        floor=floor,
        ceiling=ceiling,
        rise=RISE,
        fall=FALL,
    )


def _later(values: Floats) -> Floats:
    """Shift each row of H values by one revolution, keeping the last."""
    rows = values.reshape(-1, LENGTH)
    return np.concatenate([rows[:, 1:], rows[:, -1:]], axis=1).ravel()
