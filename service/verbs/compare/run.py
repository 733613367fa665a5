"""Comparison of plans: read, matched by workingstep, told apart from the first."""

from collections.abc import Sequence
from pathlib import Path

from service.files import read_bytes
from service.progress import Tell, silent
from service.verbs.compare.plan import ComparedPlan, NamedPlan, read_plan
from service.verbs.compare.request import MOST_PLANS, ComparisonFiles, ComparisonRequest
from service.verbs.compare.result import ComparisonResult
from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted

MOST_BYTES = 1 << 26
"""of a plan; one of 1000 workingsteps has 4 MB"""


def run(
    request: ComparisonRequest,
    files: ComparisonFiles,
    *,
    tell: Tell = silent,
) -> ComparisonResult:
    """Compare plans.

    Raises
    ------
    StepNcError
        When there are fewer than two plans, or they are of different programs.
    """
    del request, tell
    plans = [read_plan(read_bytes(path, most=MOST_BYTES), str(path)) for path in files.plans]
    return comparison(plans, _labels(files.plans))


def comparison(plans: Sequence[ComparedPlan], names: Sequence[str]) -> ComparisonResult:
    """Comparison of plans under names.

    Raises
    ------
    StepNcError
        When there are fewer than two plans or too many, or they are of different programs.
    """
    if not 2 <= len(plans) <= MOST_PLANS:
        raise StepNcError(f"{counted(len(plans), 'plan')}: 2 to {MOST_PLANS} can be compared")
    first = [step.instance for step in plans[0].workingsteps]
    for plan, name in zip(plans, names, strict=True):
        if [step.instance for step in plan.workingsteps] != first:
            raise StepNcError(
                f"{name}: a plan of {plan.program} with other workingsteps than "
                f"{names[0]}, of {plans[0].program}: plans of one program can be compared"
            )
    return ComparisonResult(
        plans=tuple(
            NamedPlan(name=name, plan=plan) for name, plan in zip(names, plans, strict=True)
        )
    )


def _labels(paths: Sequence[Path]) -> list[str]:
    """Names of files without their suffix; whole where two would be alike."""
    stems = [path.stem for path in paths]
    return stems if len(set(stems)) == len(stems) else [str(path) for path in paths]
