"""Plans read back from their JSON, with the values that a comparison needs."""

import json
from dataclasses import dataclass
from pathlib import Path

from simulator.files.toml_file import TableHead, converted
from stepnc_model.errors import StepNcError


class StepSetting(TableHead, frozen=True, kw_only=True):
    """Programmed or advised setting of a workingstep."""

    feed_mm_min: float
    spindle_rpm: float
    axial_depth_mm: float
    passes: int


class StepTime(TableHead, frozen=True, kw_only=True):
    """Machining time before and after, s."""

    before: float | None = None
    after: float | None = None


class LimitOfStep(TableHead, frozen=True, kw_only=True):
    """Limit of a workingstep, in the unit that the plan names."""

    name: str
    bound: float


class PlannedStep(TableHead, frozen=True, kw_only=True):
    """Workingstep of a plan."""

    id: str
    instance: str
    status: str
    reason: str
    programmed: StepSetting | None
    advised: StepSetting | None
    active_limit: str | None
    time_s: StepTime
    energy_j: float | None
    roughness_ra_um: float | None
    limits: tuple[LimitOfStep, ...] = ()
    unchecked: tuple[object, ...] = ()

    @property
    def setting(self) -> StepSetting | None:
        """StepSetting with which the workingstep would run."""
        return self.advised or self.programmed

    @property
    def time(self) -> float | None:
        """Machining time with that setting, s; None where it is unknown."""
        return self.time_s.before if self.time_s.after is None else self.time_s.after

    @property
    def required_roughness(self) -> float | None:
        """Roughness Ra that the plan had to keep, µm; None where none is required."""
        return next((each.bound for each in self.limits if each.name == "roughness"), None)


class ComparedPlan(TableHead, frozen=True, kw_only=True):
    """Plan of a program."""

    program: str
    mode: str
    machine: str
    material: str
    is_checked: bool
    workingsteps: tuple[PlannedStep, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedPlan:
    """Plan with its name in the comparison."""

    name: str
    plan: ComparedPlan


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanTotal:
    """Totals of a plan over the workingsteps that all plans time."""

    named: NamedPlan
    time: float
    energy: float
    left_out: int
    unchecked: int


def read_plan(data: bytes, place: str) -> ComparedPlan:
    """Plan of the JSON that ``optimise`` prints.

    Raises
    ------
    StepNcError
        When it is none, or one of NC code, which has no workingsteps.
    """
    try:
        record = json.loads(data)
    except ValueError as error:
        raise StepNcError(f"{place}: is no JSON: {error}") from error
    return plan_of(record, place)


def plan_of(record: object, place: str) -> ComparedPlan:
    """Plan of a JSON object.

    Raises
    ------
    StepNcError
        As :func:`read_plan`.
    """
    if not isinstance(record, dict) or "workingsteps" not in record:
        raise StepNcError(f"{place}: is no plan of `optimise --json` of a STEP-NC program")
    return converted(record, ComparedPlan, Path(place))
