"""Routes of ``/v1/comparisons``: advice on one program, side by side."""

from collections import Counter
from collections.abc import Sequence
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from pydantic import Field

from service.rest.advice import cached_advice
from service.rest.bodies import Id
from service.rest.replies import json_reply
from service.rest.views import View
from service.verbs.compare.plan import ComparedPlan, plan_of
from service.verbs.compare.request import MOST_PLANS
from service.verbs.compare.run import comparison

ROUTES = APIRouter(prefix="/v1/comparisons", tags=["advice"])

Wanted = Annotated[
    list[Id],
    Query(
        alias="advice", min_length=2, max_length=MOST_PLANS,
        description="ids of advice on one STEP-NC program, the first to tell others from",
    ),
]  # fmt: skip


class PlanTotalView(View):
    """Totals of a plan over the workingsteps that all plans time."""

    plan: str = Field(description="name of the plan in this comparison")
    mode: str
    machine: str
    material: str
    time_s: float
    energy_j: float
    unchecked: int | None = Field(description="required limits that could not be looked at")
    left_out: int | None = Field(description="workingsteps that not every plan times")


class StepOfPlanView(View):
    """Workingstep in one plan."""

    workingstep: str
    plan: str
    feed_mm_min: float | None
    spindle_rpm: float | None
    depth_x_passes: str | None
    active_limit: str
    roughness_ra_um: float | None = Field(description="ideal, not measured")
    time_s: float | None
    energy_j: float | None


class ComparedPlansView(View):
    """Plans side by side."""

    plans: list[PlanTotalView]
    workingsteps: list[StepOfPlanView]
    differences: list[str] = Field(description="sentences on what differs from the first plan")


@ROUTES.get("", response_model=ComparedPlansView, summary="Compare advice")
async def compare_advice(request: Request, wanted: Wanted) -> Response:
    """Compare advice on one program by workingstep, as ``stepnc compare`` does."""
    plans = [
        plan_of((await cached_advice(request, id)).result, f"advice '{id}'") for id in wanted
    ]
    return json_reply(request, comparison(plans, _names(plans, wanted)).record())


def _names(plans: Sequence[ComparedPlan], ids: Sequence[str]) -> list[str]:
    """Names of plans: the mode, with as much more as tells them apart."""
    forms = (
        [plan.mode for plan in plans],
        [f"{plan.mode} {plan.machine}" for plan in plans],
        [f"{plan.mode} {plan.machine} {plan.material}" for plan in plans],
    )
    for names in forms:
        if max(Counter(names).values()) == 1:
            return names
    return [f"{plan.mode} {id[-6:]}" for plan, id in zip(plans, ids, strict=True)]
