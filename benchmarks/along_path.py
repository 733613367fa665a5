"""Feeds of the samples as programmed, one a workingstep, and along the path with few and many.

All programs run on the virtual machine under the same control model, with nominal forces. The
loads are the greatest of the whole program; ``over`` is the greatest found load over its bound
among force, deflection and power.
"""

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from optimiser.advice import Plan
from optimiser.solver.problem import LimitName
from service.along_path.run import FeedsAlongPath
from service.requests.advice import AdviceRequest
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles
from simulator.machine.totals import Total

PARTS = Path(__file__).parents[1] / "examples" / "parts"
LEVELS = (2, 5, 20, None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One way to feed a program."""

    name: str
    totals: tuple[tuple[str, Total], ...]
    """Totals by workingstep."""
    plan_ratio: float | None = None
    """Time of the run over that of the plan."""


def rows_of(part: Path, folder: Path) -> Iterator[tuple[Plan, Row]]:
    """Yield the ways to feed a sample, each with the plan whose bounds apply."""
    before = simulate(SimulationRequest(), RunFiles(file=part)).totals
    plan, found = None, None
    for levels in LEVELS:
        request = AdviceRequest(is_along_path=True, levels=levels, safety=0.5)
        result = optimise(request, AdviceFiles(file=part, output=folder / "o.stpnc"))
        if result.along is None:
            raise RuntimeError("the feeds along the path were asked for")
        if plan is None:
            plan = result.plan
            yield plan, Row(name="as programmed", totals=before)
            yield plan, Row(name="one feed", totals=_totals(result.along, is_after=False))
        found = result.along
        name = "any feeds" if levels is None else f"{levels} feeds"
        ratio = found.time_after / found.planned_time
        yield plan, Row(name=name, totals=_totals(found, is_after=True), plan_ratio=ratio)


def _totals(along: FeedsAlongPath, *, is_after: bool) -> tuple[tuple[str, Total], ...]:
    return tuple((step.name, step.after if is_after else step.before) for step in along.steps)


def over(plan: Plan, row: Row) -> float:
    """Greatest found load over its bound, among force, deflection and power."""
    found = dict(row.totals)
    ratios = [0.0]
    efficiency = plan.machine.spindle.efficiency
    for advice in plan.advices:
        state, total = advice.after, found.get(advice.workingstep.id)
        if state is None or total is None:
            continue
        bounds = {load.limit.name: load.bound for load in state.loads}
        for name, value in (
            (LimitName.CUTTING_FORCE, max(total.force.value, total.thrust.value)),
            (LimitName.TOOL_DEFLECTION, total.deflection.value),
            (LimitName.MOTOR_POWER, total.cutting_power.value / efficiency),
        ):
            if name in bounds:
                ratios.append(value / bounds[name])
    return max(ratios)


def main() -> int:
    """Print a table for each sample."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", default=["bracket", "shaft"])
    for part in parser.parse_args().parts:
        print(part)
        print(
            "  feeds          time s  of one feed  run/plan  energy kJ  force N  bent µm"
            "  drive kW  removed cm³   over"
        )
        with tempfile.TemporaryDirectory() as folder:
            one = 0.0
            for plan, row in rows_of(PARTS / f"{part}.stpnc", Path(folder)):
                whole = Total()
                for _, total in row.totals:
                    whole = whole.plus(total)
                one = whole.duration if row.name == "one feed" else one
                ratio = f"{whole.duration / one:.3f}" if one else ""
                planned = "" if row.plan_ratio is None else f"{row.plan_ratio:.4f}"
                print(
                    f"  {row.name:13}  {whole.duration:6.1f}  {ratio:>11}  {planned:>8}"
                    f"  {whole.energy.total / 1e3:9.1f}  {whole.force.value:7.0f}"
                    f"  {1e3 * whole.deflection.value:7.1f}"
                    f"  {whole.drive_power.value / 1e3:8.2f}"
                    f"  {whole.volume / 1e3:11.3f}  {over(plan, row):5.3f}"
                )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
