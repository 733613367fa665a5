"""Response bodies, with units in the names of their fields."""

from typing import Any, Generic, TypeVar

from pydantic import BaseModel, ConfigDict, Field

from service.rest.replies import moment
from service.storage.jobs import Job, JobKind, JobState
from service.storage.programs import StoredProgram

T = TypeVar("T")


class View(BaseModel):
    """An answer."""

    model_config = ConfigDict(frozen=True)


class ProblemDetails(BaseModel):
    """A problem after RFC 9457; errors of the project add fields (line, entity, limits …)."""

    model_config = ConfigDict(extra="allow")

    type: str = Field(examples=["urn:stepnc:problem:schema-error"])
    title: str
    status: int
    detail: str


class PageView(View, Generic[T]):
    """Some of a list, newest first."""

    items: list[T]
    next_cursor: str | None = Field(description="for the next page; null: there is none")


class ProgramView(View):
    """A program."""

    id: str
    name: str
    size_bytes: int
    sha256: str
    owner: str
    created_at: str


class FindingView(View):
    """A deviation that was found."""

    severity: str
    message: str
    entity: str
    attribute: str
    line: int = Field(description="of the file, from 1; 0: the whole file")
    rule: str


class WorkingstepView(View):
    """A workingstep of a program."""

    id: str
    instance: str
    operation: str
    tool: str


class ExecutableView(View):
    """A line of the workplan."""

    instance: str
    entity: str
    id: str
    level: int


class ContentsView(View):
    """Content of a program, and its faults."""

    program: str
    schemas: list[str]
    instances: int
    is_usable: bool
    executables: list[ExecutableView]
    workingsteps: list[WorkingstepView]
    findings: list[FindingView]


class JobView(View):
    """A job: long work that goes on by itself."""

    id: str
    kind: JobKind
    state: JobState
    program_id: str | None
    advice_id: str | None
    owner: str
    created_at: str
    started_at: str | None
    ended_at: str | None
    share: float = Field(description="that is done, 0 to 1")
    message: str
    is_cancelling: bool
    attempt: int
    problem: ProblemDetails | None = Field(description="why it failed")
    request: dict[str, Any]
    result: str = Field(description="path of the result, once it has succeeded")


class LimitView(View):
    """Use of a limit."""

    name: str
    value: float | None
    bound: float | None
    unit: str
    sense: str
    margin: float | None = Field(description="share of the bound that is left")


class SettingView(View):
    """Feed, speed and depth."""

    feed_mm_min: float
    spindle_rpm: float
    feed_per_tooth_mm: float
    axial_depth_mm: float
    passes: int | None = None
    plunge_feed_mm_min: float | None = Field(
        default=None, description="on the way down into the material; null: as the cut"
    )
    plunge_feed_per_tooth_mm: float | None = None


class PlungeView(View):
    """Plunge feed and the limit that holds it."""

    reason: str
    fault: str | None = Field(description="why the tool may not go straight down; null: it may")
    limits: list[LimitView]


class BeforeAfterView(View):
    """As programmed, and as advised."""

    before: float | None
    after: float | None


class StabilityView(View):
    """Stability of a cut; its bound is one of the limits."""

    basis: str = Field(description="measured, estimated (bounds nothing) or not_used")
    reason: str
    stable_at_any_speed_mm: float | None
    band_mm: list[float] | None = Field(description="of an estimate, least and greatest")


class HoldingLoadView(View):
    """Loads of a cut on the work-holding; bounds are among the limits."""

    torque_nm: float = Field(description="about the axis of a bar, axial force included")
    moment_nm: float = Field(description="of tilting about the jaws; 0: not known, or none")
    force_n: float = Field(description="across the axis of a mill, the greatest")
    lift_n: float = Field(description="along it, that pulls the workpiece up")


class AdvisedView(View):
    """The advice for one workingstep: the feed, and why."""

    model_config = ConfigDict(extra="allow", frozen=True)

    id: str
    instance: str
    operation: str
    tool: str
    status: str
    reason: str = Field(description="what holds the feed, in a sentence")
    programmed: SettingView | None
    advised: SettingView | None
    active_limit: str | None
    limits: list[LimitView]
    motor_power_kw: float | None
    cutting_force_n: float | None
    roughness_ra_um: float | None
    energy_j: float | None
    time_s: BeforeAfterView
    stability: StabilityView | None = Field(
        default=None, description="null: chatter is no matter of this cut's depth"
    )
    plunge: PlungeView | None = Field(
        default=None, description="null: no way down has a feed of its own"
    )
    holding_load: HoldingLoadView | None = Field(
        default=None, description="null: not cut, or nothing is asked of a holding"
    )


class FigureView(View):
    """One promise and what became of it."""

    promised: float
    found: float
    ratio: float | None = Field(description="found over promised")
    bound: float | None = Field(description="that the figure must keep")


class ConfirmedView(View):
    """A workingstep beside its run."""

    id: str
    time_s: FigureView
    cutting_force_n: FigureView
    thrust_n: FigureView
    deflection_um: FigureView
    cutting_power_w: FigureView
    drive_power_w: FigureView


class ConfirmationView(View):
    """A plan beside its run."""

    workingsteps: list[ConfirmedView]
    passed: list[str] = Field(description="a sentence for each bound that the run passed")


class AdviceView(View):
    """An advice: the workingsteps of a program with their feeds."""

    model_config = ConfigDict(extra="allow", frozen=True)

    program: str
    mode: str
    machine: str
    material: str
    workingsteps: list[AdvisedView]
    total_time_s: BeforeAfterView
    findings: list[FindingView]
    is_written: bool = Field(description="whether there is an optimised program")
    nc_control: str | None
    confirmation: ConfirmationView | None = Field(
        None, description="what a run of the advised program found; only where asked for"
    )


class RunTotalView(View):
    """Time, energy and peaks."""

    model_config = ConfigDict(extra="allow", frozen=True)

    time_s: float
    cutting_time_s: float
    energy_j: dict[str, float]
    volume_mm3: float


class SimulationView(View):
    """A simulated run."""

    model_config = ConfigDict(extra="allow", frozen=True)

    program: str
    machine: str
    samples: int
    workingsteps: list[dict[str, Any]]
    total: RunTotalView
    findings: list[FindingView]


class SignalView(View):
    """A signal in each of the rows that were brought together; null: not known."""

    low: list[float | None]
    mean: list[float | None]
    high: list[float | None]


class SeriesView(View):
    """Signals of a range of time, in as many points as were asked for at most."""

    begin_s: list[float] = Field(description="of the first row of each point, s")
    end_s: list[float] = Field(description="of the last one, s")
    signals: dict[str, SignalView] = Field(description="by name, which tells the unit")
    rows: int = Field(description="that the range holds")
    is_reduced: bool = Field(description="whether rows were brought together")
    is_growing: bool = Field(description="whether the run goes on")
    columns: list[str] = Field(description="all signals that there are")


class PathView(View):
    """The way of the tool, thinned to as many points as were asked for at most."""

    workingsteps: list[str] = Field(description="ids, in the order of their numbers")
    rows: int = Field(description="that the run has")
    deviation_mm: float = Field(
        description="at most, of what was left out, from the line between its neighbours"
    )
    deviation_mm_min: float = Field(description="of the feed, outside of rapid moves")
    deviation_n: float = Field(description="of the force")
    is_growing: bool = Field(description="whether the run goes on")
    time_s: list[float]
    x_mm: list[float]
    y_mm: list[float]
    z_mm: list[float]
    feed_actual_mm_min: list[float]
    cutting_force_n: list[float | None]
    is_rapid: list[bool] = Field(description="of the move that ends in the point")
    workingstep: list[int] = Field(description="its number from 1; 0: none")


class EntryView(View):
    """A machine or a material by name."""

    name: str
    title: str
    is_own: bool = Field(description="of the shop, not of the library")
    problem: str | None = Field(description="why it cannot be read; null: it can")


def program_view(program: StoredProgram) -> dict[str, Any]:
    """See :class:`ProgramView`."""
    return {
        "id": program.id,
        "name": program.name,
        "size_bytes": program.size,
        "sha256": program.sha256,
        "owner": program.owner,
        "created_at": moment(program.created),
    }


PLACES = {
    JobKind.ADVICE: "advice",
    JobKind.SIMULATION: "simulations",
    JobKind.CONTROL: "control-runs",
    JobKind.TRIAL: "trials",
    JobKind.EVALUATION: "evaluations",
    JobKind.REVIEW: "reviews",
}
"""where results of a kind are"""


def job_view(job: Job) -> dict[str, Any]:
    """See :class:`JobView`."""
    return {
        "id": job.id,
        "kind": job.kind.value,
        "state": job.state.value,
        "program_id": job.program or None,
        "advice_id": job.source or None,
        "owner": job.owner,
        "created_at": moment(job.created),
        "started_at": moment(job.started),
        "ended_at": moment(job.ended),
        "share": job.share,
        "message": job.message,
        "is_cancelling": job.is_cancelling,
        "attempt": job.attempt,
        "problem": job.problem,
        "request": job.request,
        "result": f"/v1/{PLACES[job.kind]}/{job.id}",
    }
