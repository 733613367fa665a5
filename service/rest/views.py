"""Response bodies of the REST API, with units in the names of their fields."""

from typing import Any, Generic, TypeVar

from pydantic import BaseModel, ConfigDict, Field

from service.inputs.program_kind import ProgramKind
from service.monitor.freshness import Freshness
from service.monitor.monitor import ConnectionState
from service.monitor.observed_run import StepState
from service.rest.replies import moment
from service.storage.jobs import Job, JobKind, JobState
from service.storage.programs import StoredProgram

T = TypeVar("T")


class View(BaseModel):
    """Base class of response bodies."""

    model_config = ConfigDict(frozen=True)


class ProblemDetails(BaseModel):
    """Problem details (RFC 9457); project errors add fields such as line, entity and limits."""

    model_config = ConfigDict(extra="allow")

    type: str = Field(examples=["urn:stepnc:problem:schema-error"])
    title: str
    status: int
    detail: str


class PageView(View, Generic[T]):
    """Page of a list, newest first."""

    items: list[T]
    next_cursor: str | None = Field(
        description="cursor of the next page; null on the last page"
    )


class ProgramView(View):
    """Uploaded program."""

    id: str
    name: str
    size_bytes: int
    sha256: str
    owner: str
    created_at: str
    kind: ProgramKind = Field(description="step-nc or nc-code, told by the content")


class FindingView(View):
    """Finding of a check: an error, a warning or a note."""

    severity: str
    message: str
    entity: str
    attribute: str
    line: int = Field(description="line of the file, from 1; 0: the whole file")
    rule: str


class WorkingstepView(View):
    """Workingstep of a program."""

    id: str
    instance: str
    operation: str
    tool: str


class ExecutableView(View):
    """Executable of the workplan."""

    instance: str
    entity: str
    id: str
    level: int


class UseView(View):
    """Use of a program: tool paths, NC code, simulation or advice."""

    name: str
    is_possible: bool
    is_possible_with_material: bool = Field(
        description="only the name of a material is missing, which a request can give"
    )
    reason: str = Field(description="why it is not possible; empty where it is")


class ContentsView(View):
    """Contents and findings of a program."""

    program: str
    schemas: list[str]
    instances: int
    is_usable: bool = Field(
        description="feeds can be advised or NC code written; a material may have to be named"
    )
    uses: list[UseView]
    executables: list[ExecutableView]
    workingsteps: list[WorkingstepView]
    findings: list[FindingView]


class JobView(View):
    """Job: long work that runs in the background."""

    id: str
    kind: JobKind
    state: JobState
    program_id: str | None
    advice_id: str | None
    owner: str
    created_at: str
    started_at: str | None
    ended_at: str | None
    share: float = Field(description="share of the work done, 0 to 1")
    message: str
    is_cancelling: bool
    attempt: int
    problem: ProblemDetails | None = Field(description="why the job failed")
    request: dict[str, Any]
    result: str = Field(description="path of the result, once the job has succeeded")


class RunTotalView(View):
    """Time, energy and volume of a run or a workingstep."""

    model_config = ConfigDict(extra="allow", frozen=True)

    time_s: float
    cutting_time_s: float
    energy_j: dict[str, float]
    volume_mm3: float


class SimulationView(View):
    """Result of a simulated run."""

    model_config = ConfigDict(extra="allow", frozen=True)

    program: str
    machine: str
    samples: int
    workingsteps: list[dict[str, Any]]
    total: RunTotalView
    left_out: list[str] = []
    findings: list[FindingView]


class SignalView(View):
    """Minimum, mean and maximum of a signal at each point; null: unknown."""

    low: list[float | None]
    mean: list[float | None]
    high: list[float | None]


class SeriesView(View):
    """Signals over a time range, in at most the requested number of points."""

    begin_s: list[float] = Field(description="time of the first row of each point, s")
    end_s: list[float] = Field(description="time of the last row of each point, s")
    signals: dict[str, SignalView] = Field(description="signals by name, which states the unit")
    rows: int = Field(description="number of rows in the time range")
    is_reduced: bool = Field(description="whether several rows were merged into a point")
    is_growing: bool = Field(description="whether the run is still going on")
    columns: list[str] = Field(description="names of all available signals")


class PathView(View):
    """Path of the tool, thinned to at most the requested number of points."""

    workingsteps: list[str] = Field(description="ids, in the order of their numbers")
    rows: int = Field(description="number of rows of the run")
    deviation_mm: float = Field(
        description="largest distance of an omitted point from the drawn line"
    )
    deviation_mm_min: float = Field(description="largest error of the feed, except in rapids")
    deviation_n: float = Field(description="largest error of the force")
    is_growing: bool = Field(description="whether the run is still going on")
    time_s: list[float]
    x_mm: list[float]
    y_mm: list[float]
    z_mm: list[float]
    feed_actual_mm_min: list[float]
    cutting_force_n: list[float | None]
    is_rapid: list[bool] = Field(description="whether the move to the point is a rapid")
    workingstep: list[int] = Field(description="workingstep number from 1; 0: none")


class EntryView(View):
    """Machine or material of the library."""

    name: str
    title: str
    is_own: bool = Field(description="whether it belongs to the shop, not the built-in library")
    problem: str | None = Field(description="why it cannot be read; null if it can")


class MonitorView(View):
    """Real machine that is monitored through its MTConnect agent."""

    name: str
    url: str
    state: ConnectionState
    problem: str | None = Field(description="why there is no connection; null if there is one")
    freshness: Freshness = Field(
        description="fresh; quiet: the agent answers and the machine is at rest; stale: "
        "the values are old; none: no observation yet"
    )
    age_s: float | None = Field(description="time since the last observation arrived here")
    stale_after_s: float = Field(description="age from which values are old")
    availability: str | None
    execution: str | None
    program: str | None
    workingstep: str | None


class ObservedStepView(View):
    """Workingstep as measured so far."""

    id: str = Field(description="empty: outside workingsteps")
    begin_s: float
    time_s: float
    energy_j: float | None = Field(description="null: the power was not told")
    is_running: bool
    is_whole: bool = Field(description="whether all of it was observed")


class ObservedRunView(View):
    """Current or latest run of a program, as measured so far."""

    program: str
    begin_s: float | None = Field(description="null: its beginning was not observed")
    is_running: bool
    workingsteps: list[ObservedStepView]


class MonitorStatusView(MonitorView):
    """Status of a monitor, with the latest values and the measured run."""

    time_zero: str | None = Field(description="timestamp of the machine at which time_s is 0")
    rows: int = Field(description="number of rows that are kept")
    workingsteps: list[str] = Field(description="ids, in the order of their numbers in rows")
    latest: dict[str, float | None] = Field(description="latest row; null: not told")
    run: ObservedRunView | None


class StepComparisonView(View):
    """Workingstep as measured and as predicted."""

    id: str = Field(description="empty: outside workingsteps")
    state: StepState
    measured_time_s: float | None
    predicted_time_s: float | None
    time_ratio: float | None = Field(description="measured over predicted, once it is done")
    measured_energy_j: float | None
    predicted_energy_j: float | None
    energy_ratio: float | None = Field(description="measured over predicted, once it is done")


class AlignedPartView(View):
    """Part of the prediction, and how far it is moved to the time of the measured rows."""

    begin_s: float
    end_s: float
    shift_s: float


class ComparisonView(View):
    """Measured run beside a simulation of it."""

    simulation: str
    machine: str
    program: str = Field(description="program of the simulation")
    measured_program: str | None
    workingsteps: list[StepComparisonView]
    done: StepComparisonView = Field(description="sum of what is done and predicted")
    parts: list[AlignedPartView] = Field(description="empty: nothing common was observed yet")


def program_view(program: StoredProgram) -> dict[str, Any]:
    """Return a stored program as a :class:`ProgramView`."""
    return {
        "id": program.id,
        "name": program.name,
        "size_bytes": program.size,
        "sha256": program.sha256,
        "owner": program.owner,
        "created_at": moment(program.created),
        "kind": program.kind.value,
    }


PLACES = {
    JobKind.ADVICE: "advice",
    JobKind.SIMULATION: "simulations",
    JobKind.CONTROL: "control-runs",
    JobKind.TRIAL: "trials",
    JobKind.EVALUATION: "evaluations",
    JobKind.REVIEW: "reviews",
    JobKind.VERIFICATION: "verifications",
    JobKind.CYCLE_TIME: "cycle-times",
    JobKind.FACTORY: "factories",
}
"""Path segment of the results by kind of job."""


def job_view(job: Job) -> dict[str, Any]:
    """Return a job as a :class:`JobView`."""
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
