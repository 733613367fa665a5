"""Model predictive control of the cutting force: the override planned over next revolutions.

Once a revolution ``ln K = ln F − ln g − p·ln m`` is measured, m the mean override that the axes
ran, and filtered: the disturbance that makes the law free of offset [1]_. With it each of the
next revolutions has a cap, the override at which its force meets the set point, ``c_j =
(F_ref / (K·g_j))^(1/p)``, and OSQP [2]_ solves the program of
:mod:`controller.laws.horizon`; the first command is the decision. Where nothing is known ahead,
g stays as it is.

Targets are the least cap up to each revolution: a cut that will be lighter is answered when it
is there, since the program would otherwise slow down first in order to rise earlier. Where OSQP
does not find the solution in the iterations that it has, the decision is the least cap of the
horizon, within the rise: the model inverted at rest, which asks no more of the cut than the
program would in the end, and does not make up for the lag.

Answers depend on state and situation only: every solve starts from what the state holds. The
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

from controller.law import Plant, Situation
from controller.laws.horizon import (
    LENGTH,
    Horizon,
    Outlook,
    horizon,
    lingering,
    remaining,
    vectors,
)
from controller.ports import Floats

LEARNING = 0.4
"""share of what is new in a measured ln K that is believed"""
SURPRISE = 1.0
"""of ln K, that is believed at most in one revolution"""
RISE = 0.5
"""of the override from one revolution to the next, at most"""
FALL = 1.0
"""likewise"""
LEAST, MOST = 0.01, 10.0
"""overrides between which the program is stated, whatever the band"""
NARROWEST = 1.01
"""ceiling over floor in the program: OSQP factorises anew when a band becomes an equation"""
CHECKED = 5
"""iterations after which OSQP looks whether it is done"""
SETTINGS = {
    "verbose": False,
    "rho": 0.4,
    "adaptive_rho": False,
    "polishing": False,
    "check_termination": CHECKED,
    "eps_abs": 1e-4,
    "eps_rel": 0.0,
}
"""of OSQP, in units of the least cap; a rho that adapts would remember earlier calls"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MpcState:
    """State that a decision leaves to the next."""

    log_factor: float | None
    """ln K; None: nothing was measured yet"""
    expected: float
    """N, g that K refers to; 0: none was ever known, and K stands for K·g"""
    plan: Floats
    """(2H,) commands and excess of the coming revolutions, as the last decision saw them"""
    prices: Floats
    """(3H,) dual variables of the caps, the band and the moves, likewise"""
    is_planned: bool
    """whether the last decision was the program's; if not, it was the least cap"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelPredictive:
    """Model predictive control; with preview where the situation has what is ahead."""

    plant: Plant = field(default_factory=Plant)
    iterations: int = 400
    """of the solver, at most: some 0.4 ms"""
    _horizon: Horizon = field(init=False, repr=False, compare=False)
    _solver: Any = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not (self.plant.lag > 0.0 and self.plant.exponent > 0.0):
            raise ValueError(f"lag and exponent must be above 0: {self.plant}")
        over = horizon(self.plant.lag)
        object.__setattr__(self, "_horizon", over)
        object.__setattr__(self, "_solver", _solver(over, iterations=self.iterations))

    def begin(self, override: float) -> MpcState:
        """Nothing measured, and a plan to stay at this override."""
        return MpcState(
            log_factor=None,
            expected=0.0,
            plan=np.repeat([min(max(override, LEAST), MOST), 0.0], LENGTH),
            prices=np.zeros(3 * LENGTH),
            is_planned=True,
        )

    def decide(self, state: MpcState, at: Situation) -> tuple[MpcState, float]:
        """See :class:`~controller.law.ControlLaw`; what the situation tells must be finite."""
        expected = at.expected if at.expected > 0.0 else state.expected
        factor = _learned(state, at, exponent=self.plant.exponent)
        outlook = _outlook(at, _needed(at, factor, expected=expected), plant=self.plant)
        # The least cap as unit makes the solver's tolerance one relative to what is decided.
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
    """OSQP, set up once: matrices are scaled and factorised here."""
    solver = osqp.OSQP()
    solver.setup(
        P=over.quadratic,
        q=np.zeros(2 * LENGTH),
        A=over.rows,
        # Bounds of the kind of later ones: caps from above, band and moves from both sides.
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
        # From now on K refers to g, and the expected force is right until shown otherwise.
        before = 0.0
    if at.actual < LEAST:
        # Force of axes that stand tells nothing of force over feed.
        return before
    expected = at.expected if at.expected > 0.0 else state.expected
    measured = log(at.force) - log(expected or 1.0) - exponent * log(at.actual)
    if before is None:
        return measured
    return before + LEARNING * min(max(measured - before, -SURPRISE), SURPRISE)


def _needed(at: Situation, log_factor: float | None, *, expected: float) -> Floats | None:
    """(H,) ln of the force allowed over that at override 1; None: nothing was measured yet."""
    if log_factor is None:
        return None
    return log(at.set_point) - log_factor - np.log(_coming(at, expected or 1.0))


def _coming(at: Situation, expected: float) -> Floats:
    """(H,) N, g of each of the next revolutions; what is not known stays as it was."""
    if at.expected <= 0.0 or not at.ahead:
        return np.full(LENGTH, expected)
    coming, last = [], expected
    for each in at.ahead[:LENGTH]:
        last = each if each > 0.0 else last
        coming.append(last)
    return np.array(coming + [last] * (LENGTH - len(coming)))


def _outlook(at: Situation, needed: Floats | None, *, plant: Plant) -> Outlook:
    """Matrices that the quadratic program is set up with."""
    floor = min(max(at.floor, LEAST), MOST / NARROWEST)
    ceiling = max(min(at.ceiling, MOST), NARROWEST * floor)
    command = min(max(at.override, floor), ceiling)
    if needed is None:
        caps = np.full(LENGTH, command)
    else:
        caps = np.exp((needed / plant.exponent).clip(log(floor), log(ceiling)))
    # Of the way that the axes lacked in the mean, this share they still lack at the end.
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
    """Each row of H values one revolution on, the last kept."""
    rows = values.reshape(-1, LENGTH)
    return np.concatenate([rows[:, 1:], rows[:, -1:]], axis=1).ravel()
