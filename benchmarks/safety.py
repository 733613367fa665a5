"""Share of plans that pass their bounds when k_c is not that of the catalogue.

The bracket is planned at several quantiles of k_c and run on the virtual machine, which finds
each load at the catalogue's k_c. Then k_c is drawn from its spread: loads are in proportion to
it. Counted are pairs of a draw and a workingstep whose feed is held by a limit that moves with
k_c. Of all pairs a plan at the quantile q passes 1 - q, if plan and run agree.
"""

import argparse
from functools import partial
from math import log
from pathlib import Path

import numpy as np

from optimiser.advice import Advice, AdviceStatus, Plan
from optimiser.cuts.source import along_paths
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import SCALES_WITH_FORCE, LimitName
from service.programs.advice_records import changes_of
from service.simulation.confirm import confirm
from service.simulation.confirmation import Confirmation
from simulator.library import load_machine, match_material
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program

BRACKET = Path(__file__).parents[1] / "examples" / "parts" / "bracket.stpnc"

FIGURES = {
    LimitName.MOTOR_POWER: "cutting_power_w",
    LimitName.CUTTING_FORCE: "cutting_force_n",
    LimitName.TOOL_DEFLECTION: "deflection_um",
}
"""what the run finds of a limit; what it does not find is taken as planned"""


def main(arguments: list[str] | None = None) -> None:
    """Print shares of pairs that pass their bound, and times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--safety", type=float, nargs="*", default=[0.5, 0.7, 0.9, 0.99])
    options = parser.parse_args(arguments)
    print(f"{options.draws} draws of k_c on bracket.stpnc, vmc15, C45, seed {options.seed}")
    print(
        f"{'safety':>7}{'expected':>10}{'as planned':>12}{'as found':>10}{'pairs':>7}{'s':>9}"
    )
    for safety in options.safety:
        plan, confirmation = _plan_and_run(safety)
        planned, found = _shares(plan, None), _shares(plan, confirmation)
        factors = _draws(plan, options.draws, options.seed)
        print(
            f"{safety:7g}{1.0 - safety:10.1%}{_passed(planned, factors):12.1%}"
            f"{_passed(found, factors):10.1%}{found.size * factors.size:7}"
            f"{plan.time_after:9.1f}"
        )


def _plan_and_run(safety: float) -> tuple[Plan, Confirmation]:
    """A plan of the bracket at a quantile, and what the machine finds of it."""
    program = Program(Part21File.from_bytes(BRACKET.read_bytes()), name="bracket")
    plan = optimise_program(
        program,
        machine=load_machine("vmc15"),
        material=match_material(["C45"]),
        task=OptimisationTask(safety=safety, source=partial(along_paths, is_run=True)),
    )
    data = writeback.write(program, changes_of(plan), FileProfile.OPTIMISATION)
    advised = Program(Part21File.from_bytes(data, name="bracket"), name="bracket")
    return plan, confirm(plan, program, advised)


def _shares(plan: Plan, confirmation: Confirmation | None) -> np.ndarray:
    """(N,) nominal load over bound of each active limit that moves with k_c."""
    steps = () if confirmation is None else confirmation.steps
    ratios = {(step.id, each.key): each.ratio for step in steps for each in step.figures}
    return np.array([
        _share(advice)
        * (ratios.get((advice.workingstep.id, FIGURES.get(advice.active, ""))) or 1.0)
        for advice in plan.advices
        if advice.status is AdviceStatus.ADVISED and advice.active in SCALES_WITH_FORCE
    ])


def _share(advice: Advice) -> float:
    """Nominal load over bound of the limit that holds the feed."""
    if advice.after is None:
        raise ValueError(f"'{advice.workingstep.id}' is not advised")
    return max(
        load.value / load.bound
        for load in advice.after.loads
        if load.limit.name is advice.active
    )


def _draws(plan: Plan, count: int, seed: int) -> np.ndarray:
    """(count,) factors on k_c."""
    spread = plan.material.material.spread or 0.0
    return np.exp(np.random.default_rng(seed).normal(size=count) * log(1.0 + spread))


def _passed(shares: np.ndarray, factors: np.ndarray) -> float:
    """Share of the pairs whose load passes its bound; rounding is no passing."""
    return float((shares[None, :] * factors[:, None] > 1.0 + 1e-9).mean())


if __name__ == "__main__":
    main()
