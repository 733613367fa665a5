"""Requests of runs on the virtual machine: ``simulate`` and ``control``."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any

from annotated_types import Interval, MaxLen

from controller.laws.choice import LawName
from controller.orders import Criterion
from controller.signals.preview import LOOK_AHEAD
from service.ids import PATTERN
from service.live.playback import LEAST, MOST, checked_pace
from service.requests.advice import MachineName, MaterialName
from service.requests.fields import LONGEST_NAME, About, Request
from service.requests.program_facts import Name, ProgramRequest
from simulator.machine.noise_kind import NoiseKind
from simulator.motion.model_name import ControlModelName

GREATEST_SEED = 2**31

GREATEST_LOOK_AHEAD = 50
"""Longest preview, in revolutions."""

GREATEST_OVERRIDE = 200.0
"""Greatest feed override, in %."""

JUNCTION_DEVIATION = 0.01
"""Default path deviation of the junction control, in mm."""


class ForceView(StrEnum):
    """Time resolution of forces in results."""

    MEAN = "mean"
    """Mean force over a revolution."""
    TOOTH = "tooth"
    """Force of the teeth that cut at each time."""


class SensorChoice(StrEnum):
    """Quantity that the control loop measures."""

    DYNAMOMETER = "dynamometer"
    COMPONENTS = "components"
    """Dynamometer that shows the force normal to the edges too."""
    POWER = "power"


@dataclass(frozen=True, slots=True)
class IdPattern:
    """Schema of an optional id of the service."""

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> Any:
        """Return the schema of values; called by pydantic."""
        from pydantic_core import core_schema  # noqa: PLC0415 (slow to import)

        return core_schema.nullable_schema(core_schema.str_schema(pattern=PATTERN))


@dataclass(frozen=True, slots=True)
class PaceOrNone:
    """Schema of a pace: zero, or within the bounds at which a run ends."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Return the schema of values; called by pydantic."""
        from pydantic_core import core_schema  # noqa: PLC0415 (slow to import)

        return core_schema.no_info_after_validator_function(checked_pace, handler(source))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Return the JSON schema for OpenAPI; called by pydantic."""
        return {**handler(schema), "anyOf": [{"const": 0.0}, {"minimum": LEAST}]}


OptionalId = Annotated[str | None, IdPattern()]

MonitorName = Annotated[str, MaxLen(LONGEST_NAME)]
"""Name of a monitored machine; empty: none."""

Seed = Annotated[
    int,
    Interval(ge=0, le=GREATEST_SEED),
    About("seed of noise, power deviation, scatter and missing samples", flag="--seed"),
]

Percent = Interval(gt=0.0, le=1000.0)
"""Bounds of changes, in per cent; larger values are taken for typing errors."""

KeepGoing = Annotated[
    bool,
    About(
        "leave out workingsteps that cannot be run, and those that depend on them; exit code "
        "3 remains",
        flag="--keep-going",
    ),
]

PACE = "simulated seconds per wall-clock second; 0: as fast as possible"


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionRequest(ProgramRequest):
    """Machine that runs a program, and how its control moves."""

    machine: MachineName = ""
    material: MaterialName = ""
    control: Annotated[
        ControlModelName,
        About(
            "motion control of the path: exact-stop (every block from rest to rest), junction, "
            "fir or linuxcnc (its planner, within the path tolerances that post writes); none "
            "was identified on a machine of the library",
            flag="--control",
        ),
    ] = ControlModelName.FIR
    filter_s: Annotated[
        Name,
        About(
            "filter times of the fir control, s, as T1,T2; empty: derived from the axes' "
            "acceleration and jerk",
            flag="--filter-s", metavar="T1,T2",
        ),
    ] = ""  # fmt: skip
    deviation_mm: Annotated[
        float,
        Interval(gt=0.0, le=10.0),
        About(
            "path deviation of the junction control, mm", unit="mm", name="deviation",
            flag="--deviation-mm", metavar="MM",
        ),
    ] = JUNCTION_DEVIATION  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRequest(MotionRequest):
    """Run of an uploaded or an optimised program on the virtual machine."""

    program_id: Annotated[OptionalId, About("an uploaded program")] = None
    advice_id: Annotated[OptionalId, About("or the program optimised by this advice")] = None
    pace: Annotated[float, Interval(ge=0.0, le=MOST), PaceOrNone(), About(PACE)] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationRequest(RunRequest):
    """Request of a simulation."""

    keep_going: KeepGoing = False
    seed: Seed = 0
    rate_hz: Annotated[
        float,
        Interval(ge=1.0, le=10_000.0),
        About("samples per second, 1 to 10000", unit="Hz", name="rate", flag="--rate",
              metavar="HZ"),
    ] = 20.0  # fmt: skip
    force: Annotated[
        ForceView,
        About("force: mean over a revolution (mean), or of each tooth (tooth)", flag="--force"),
    ] = ForceView.MEAN
    kc_factor: Annotated[
        float,
        Interval(gt=0.0, le=100.0),
        About("factor on the specific cutting force k_c (from calibrate)",
              name="factor on k_c", flag="--kc-factor", metavar="K"),
    ] = 1.0  # fmt: skip
    runout_um: Annotated[
        float,
        Interval(ge=0.0, le=500.0),
        About("runout in µm, for --force tooth", unit="µm", name="runout", flag="--runout-um",
              metavar="UM"),
    ] = 0.0  # fmt: skip
    has_wear: Annotated[bool, About("tools wear while they cut (Taylor)", flag="--wear")] = (
        False
    )
    has_lag: Annotated[
        bool, About("simulate delay and overshoot of the main drive", flag="--lag")
    ] = False
    has_power_deviation: Annotated[
        bool,
        About("motor power of each movement deviates at random, by the machine's [deviation]",
              flag="--power-deviation"),
    ] = False  # fmt: skip
    noise: Annotated[
        NoiseKind, About("sensor noise: none, normal or uniform", flag="--noise")
    ] = NoiseKind.NONE
    missing: Annotated[
        float,
        Interval(ge=0.0, lt=1.0),
        About("share of missing samples", flag="--missing", metavar="P"),
    ] = 0.0
    zero: Annotated[
        Name,
        About(
            "position of the program's zero on the axes in mm: x,y,z (default: by the stock)",
            flag="--zero", metavar="X,Y,Z",
        ),
    ] = ""  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRequest(RunRequest):
    """Request to run a program under force control."""

    keep_going: KeepGoing = False
    seed: Seed = 0
    mode: Annotated[Criterion, About("TC fast, QC programmed chip load", flag="--mode")] = (
        Criterion.TC
    )
    law: Annotated[
        LawName,
        About(
            "control law: log-pi, pi, fuzzy, self-tuning, mrac, mpc, or none (monitors only: "
            "the programmed feed)",
            flag="--law",
        ),
    ] = LawName.LOG_PI
    has_preview: Annotated[
        bool, About("let the law use the expected cut ahead", flag="--preview")
    ] = True
    look_ahead: Annotated[
        int,
        Interval(ge=1, le=GREATEST_LOOK_AHEAD),
        About("length of the preview in revolutions, 1 to 50", unit="revolutions",
              name="look-ahead", flag="--look-ahead", metavar="N"),
    ] = LOOK_AHEAD  # fmt: skip
    disturbances: Annotated[
        tuple[Annotated[str, MaxLen(60)], ...],
        MaxLen(50),
        About("disturbance unknown to the loop, as kc:1.3; repeatable", flag="--disturb",
              metavar="WHAT:VALUE[@TIME]", examples=(["kc:1.3"],)),
    ] = ()  # fmt: skip
    force_set_point_n: Annotated[
        float | None,
        Interval(gt=0.0, le=1e6),
        About("set point of the cutting force, N (default: what the plan's limits allow)",
              unit="N", name="force", flag="--force", metavar="N"),
    ] = None  # fmt: skip
    override_low_percent: Annotated[
        float,
        Interval(gt=0.0, le=100.0),
        About("lower end of the override band, %", unit="%", name="override band from"),
    ] = 20.0
    override_high_percent: Annotated[
        float,
        Interval(ge=100.0, le=GREATEST_OVERRIDE),
        About("upper end of the override band, %", unit="%", name="override band to"),
    ] = 120.0
    sensor: Annotated[
        SensorChoice,
        About(
            "sensor of the loop: dynamometer, components (a dynamometer that shows the force "
            "normal to the edges too, from which wear is seen best), or drive power",
            flag="--sensor",
        ),
    ] = SensorChoice.DYNAMOMETER
    has_corrections: Annotated[bool, About("apply accepted corrections of k_c")] = True
    is_recorded: Annotated[bool, About("record the outcomes in the knowledge base")] = True
    pace: Annotated[float, Interval(ge=0.0, le=MOST), PaceOrNone(), About(PACE)] = 10.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlChanges(Request):
    """Changes to a controlled run; omitted fields stay unchanged."""

    mode: Annotated[Criterion | None, About("TC or QC")] = None
    is_on: Annotated[bool | None, About("whether force control is on")] = None
    is_held: Annotated[
        bool | None, About("whether the operator holds the feed; false resumes it")
    ] = None
    override_most_percent: Annotated[
        float | None,
        Interval(gt=0.0, le=GREATEST_OVERRIDE),
        About(
            "greatest override that the operator allows, at most the top of the band, %",
            unit="%", name="override at most",
        ),
    ] = None  # fmt: skip
    motor_power_percent: Annotated[
        float | None,
        Percent,
        About("motor power that the operator allows, %", unit="%", name="motor power"),
    ] = None
    depth_percent: Annotated[
        float | None,
        Percent,
        About("actual over programmed depth; hidden from the loop", unit="%", name="depth"),
    ] = None
    hardness_percent: Annotated[
        float | None,
        Percent,
        About("k_c of the workpiece, %; hidden from the loop", unit="%", name="hardness"),
    ] = None
    material: Annotated[
        Annotated[str, MaxLen(LONGEST_NAME)] | None,
        About("another workpiece material of the library; hidden from the loop"),
    ] = None
    pace: Annotated[
        float | None,
        Interval(ge=LEAST, le=MOST),
        About("simulated seconds per wall-clock second"),
    ] = None


StockId = Annotated[
    OptionalId,
    About("an uploaded raw part (`kind=stock`), an STL or STEP file, in place of stock"),
]
StockSolid = Annotated[
    str,
    MaxLen(LONGEST_NAME),
    About("the solid of a raw part with several, by its place in the file or its name"),
]
