"""What clients send: the bodies of requests, with bounds and units. In the user's units."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, create_model

from controller.laws.choice import LawName
from controller.orders import Criterion
from controller.preview import LOOK_AHEAD
from kbe.evaluation import Grouping, RowFilter, SortKey
from optimiser.modes import Free, Mode
from optimiser.safety import GREATEST_QUANTILE, LEAST_QUANTILE, USUAL_QUANTILE
from service.control.live import MOST_PERCENT
from service.depot.ids import PATTERN
from service.live.pace import LEAST, MOST
from service.trial.inputs import FIELDS, MillingType
from simulator.machine.disturbance import NoiseKind
from simulator.motion.control import Control as MotionControl
from stepnc_model.post.controls import Control as NcControl
from stepnc_model.unit_profiles import PROFILES
from stepnc_model.writeback import Profile

Id = Annotated[str, Field(pattern=PATTERN, examples=["01jd3m8y7q2v4x6z8b0c1d2e3f"])]
Name = Annotated[str, Field(max_length=200)]
Percent = Annotated[float, Field(gt=0.0, le=MOST_PERCENT)]
Pace = Annotated[float, Field(ge=LEAST, le=MOST)]
Units = StrEnum("Units", {name.replace("-", "_"): name for name in PROFILES})  # type: ignore[misc]
ISO = Units("iso")
"""as the standard says"""


def _not_between(pace: float) -> float:
    """A pace, or none: what is nearly none never ends."""
    if 0.0 < pace < LEAST:
        raise ValueError(f"{pace:g}: it must be 0 or at least {LEAST:g}")
    return pace


PaceOrNone = Annotated[
    float,
    Field(
        ge=0.0, le=MOST, json_schema_extra={"anyOf": [{"const": 0.0}, {"minimum": LEAST}]}
    ),
    AfterValidator(_not_between),
]  # fmt: skip
PACE_WORDS = "s of the machine in one of ours; 0: as fast as can be"


class Sensor(StrEnum):
    """What the loop measures."""

    DYNAMOMETER = "dynamometer"
    POWER = "power"


class Body(BaseModel):
    """A request's body: what is not known is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    def words(self) -> dict[str, Any]:
        """As JSON."""
        return self.model_dump(mode="json")


class AdviceBody(Body):
    """Which feeds are wanted."""

    mode: Mode = Field(
        Mode.TC,
        description="TC least time, QC fastest feed that keeps the roughness, EC energy",
    )
    machine: Name = Field("", description="empty: one that suits", examples=["vmc15"])
    material: Name = Field("", description="empty: the one the program names", examples=["c45"])
    units: Units = Field(ISO, description="of feeds and speeds in the file")
    roughness_um: float | None = Field(
        None, gt=0.0, le=1000.0, description="Ra that finished surfaces must keep, µm"
    )
    free: list[Free] = Field(
        [Free.FEED, Free.DEPTH], min_length=1, max_length=3, description="what may change"
    )
    workingsteps: list[Name] = Field(
        [], max_length=10_000, description="ids or #instances; empty: all"
    )
    profile: Profile = Field(Profile.OPTIMISATION, description="how records are written")
    nc_control: NcControl | None = Field(
        None, description="also NC code, for this control", examples=["linuxcnc"]
    )
    has_pareto: bool = Field(False, description="also fronts of time, roughness and energy")
    tool_change_s: float = Field(
        0.0,
        ge=0.0,
        le=86_400.0,
        description="s to change a worn tool; 0: tool life is left out",
    )
    has_corrections: bool = Field(True, description="plan with what was learned and accepted")
    is_confirmed: bool = Field(
        False, description="run the advised program too, and tell what it finds beside the plan"
    )
    stock: Name = Field(
        "",
        description="raw part of a program that draws none, mm: x0,y0,z0,x1,y1,z1 or "
        "diameter,z0,z1",
        examples=["0,0,-30,100,120,5"],
    )
    safety: float = Field(
        USUAL_QUANTILE,
        ge=LEAST_QUANTILE,
        le=GREATEST_QUANTILE,
        description="quantile of k_c at which loads keep their bounds; 0.5: nominal",
    )

    centre_cutting: dict[Name, bool] = Field(
        {},
        max_length=1000,
        description="whether tools cut over centre, by their ids",
        examples=[{"END MILL 10MM": True}],
    )
    allow_plunge: bool = Field(
        False,
        description="tools that do not cut over centre may go straight down into the solid",
    )

    def words(self) -> dict[str, Any]:
        """As the job takes them."""
        found = super().words()
        return {**found, "nc_control": found["nc_control"] or ""}


class RunBody(Body):
    """A program on the virtual machine: the program as it came, or as an advice made it."""

    program_id: Id | None = Field(None, description="a program as it came")
    advice_id: Id | None = Field(None, description="or what an advice made of one")
    machine: Name = Field("", description="empty: one that suits", examples=["vmc15"])
    material: Name = Field("", description="empty: the one the program names", examples=["c45"])
    units: Units = Field(ISO, description="of feeds and speeds in the file")
    seed: int = Field(0, ge=0, le=2**31, description="of noise and scatter")
    pace: PaceOrNone = Field(0.0, description=PACE_WORDS)


class SimulationBody(RunBody):
    """A simulation."""

    rate_hz: float = Field(20.0, ge=1.0, le=1000.0, description="samples a second, Hz")
    control: MotionControl = Field(MotionControl.FIR, description="how the control runs paths")
    noise: NoiseKind = Field(NoiseKind.NONE, description="of the sensors")
    has_lag: bool = Field(False, description="the main drive answers late and too far")
    has_wear: bool = Field(False, description="tools wear while they cut")
    kc_factor: float = Field(1.0, gt=0.0, le=100.0, description="on the specific cutting force")


class ControlBody(RunBody):
    """A program under the force loop."""

    mode: Criterion = Field(Criterion.TC, description="TC fast, QC the programmed chip load")
    law: LawName = Field(LawName.LOG_PI, description="how the override is chosen")
    has_preview: bool = Field(True, description="whether the law knows what is ahead")
    look_ahead: int = Field(LOOK_AHEAD, ge=1, le=50, description="revolutions of preview")
    disturbances: list[Annotated[str, Field(max_length=60)]] = Field(
        [], max_length=50, description="as `stepnc control --disturb`", examples=[["kc:1.3"]]
    )
    force_set_point_n: float | None = Field(
        None, gt=0.0, le=1e6, description="of the cutting force, N; null: the plan's bounds"
    )
    override_low_percent: float = Field(20.0, gt=0.0, le=100.0, description="of the band, %")
    override_high_percent: float = Field(
        120.0, ge=100.0, le=200.0, description="of the band, %"
    )
    sensor: Sensor = Field(Sensor.DYNAMOMETER, description="what the loop measures")
    has_corrections: bool = Field(True, description="expect what was learned and accepted")
    is_recorded: bool = Field(True, description="keep the outcomes in the knowledge base")
    pace: PaceOrNone = Field(10.0, description=PACE_WORDS)


class ControlChanges(Body):
    """What is to be otherwise in a run under control; what is left out stays."""

    mode: Criterion | None = None
    is_on: bool | None = Field(None, description="whether the loop acts")
    motor_power_percent: Percent | None = Field(None, description="that the operator allows, %")
    depth_percent: Percent | None = Field(None, description="of the programmed depth; hidden")
    hardness_percent: Percent | None = Field(None, description="k_c of the workpiece; hidden")
    material: Name | None = Field(None, description="another workpiece; hidden from the loop")
    pace: Pace | None = Field(None, description="s of the machine in one of ours")


def _numbers() -> dict[str, Any]:
    """Numbers of a trial with their bounds, as the trial itself knows them."""
    return {
        field.name: (
            (int if field.is_whole else float) | None,
            Field(
                None, ge=field.low, le=field.high,
                description=f"{field.words}{', ' if field.unit else ''}{field.unit}",
            ),
        )
        for field in FIELDS
    }  # fmt: skip


TrialInputs = create_model(
    "TrialInputs",
    __base__=Body,
    __doc__="Inputs of a trial cut; what is left out stays as it is, at first as usual.",
    milling_type=(MillingType | None, Field(None, description="immersion of the cutter")),
    material=(Name | None, Field(None, description="workpiece", examples=["c45"])),
    mode=(Criterion | None, Field(None, description="TC or QC")),
    is_on=(bool | None, Field(None, description="whether the loop acts")),
    **_numbers(),
)


class TrialBody(Body):
    """A trial cut."""

    inputs: TrialInputs = TrialInputs()
    seed: int = Field(0, ge=0, le=2**31, description="of the sensors' noise")
    pace: Pace = Field(1.0, description="s of the machine in one of ours")


class TrialChanges(Body):
    """What is to be otherwise in a trial; ``restart`` goes on with a new cutter."""

    inputs: TrialInputs = TrialInputs()
    pace: Pace | None = Field(None, description="s of the machine in one of ours")
    restart: bool = Field(False, description="a new cutter, after the loop has stopped")
    end: bool = Field(False, description="end the trial")


class SelectionBody(Body):
    """Which outcomes; null: any."""

    machine: Name | None = None
    material: Name | None = None
    tool: Name | None = None
    feature_kind: Name | None = Field(None, examples=["closed_pocket"])
    program: Name | None = None
    run: Name | None = None
    since: datetime | None = Field(None, description="first moment that counts, with zone")
    until: datetime | None = Field(None, description="first moment that counts no more")


class EvaluationBody(SelectionBody):
    """Which evaluation table."""

    grouping: Grouping = Field(Grouping.FEATURE, description="what a row is for")
    only: RowFilter = Field(RowFilter.ALL, description="which rows to keep")
    sort: SortKey = Field(SortKey.NAME, description="what comes first")


class ReviewBody(SelectionBody):
    """What to learn from."""


class DecisionBody(Body):
    """Who decides."""

    by: str = Field(min_length=1, max_length=100, examples=["A. Smith"])
