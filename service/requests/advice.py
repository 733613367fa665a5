"""Request of ``optimise``: optimise the feeds of a program."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Interval, Len, MaxLen

from optimiser.modes import Free, Mode
from optimiser.safety import (
    GREATEST_QUANTILE,
    GREATEST_SHARE,
    LEAST_QUANTILE,
    LEAST_SHARE,
    USUAL_QUANTILE,
    USUAL_RISE,
)
from service.requests.fields import About
from service.requests.files import KeepsState
from service.requests.program_facts import Name, ProgramRequest
from simulator.motion.model_name import ControlModelName
from stepnc_model.editing.file_profile import FileProfile, RecordChoice
from stepnc_model.post.dialect import Dialect

MachineName = Annotated[
    Name,
    About(
        "one of `stepnc machines`, or your own TOML or XML file (default: a suitable one)",
        flag="--machine", examples=("vmc15",),
    ),
]  # fmt: skip
MaterialName = Annotated[
    Name,
    About(
        "one of `stepnc materials`, or your own TOML file (default: as the program says)",
        flag="--material", examples=("c45",),
    ),
]  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class AdviceRequest(ProgramRequest):
    """Request to optimise the feeds of a program."""

    mode: Annotated[
        Mode,
        About(
            "TC least time, QC fastest feed that keeps the roughness, EC least energy, "
            "CC least cost of machine time and worn edges",
            flag="--mode",
        ),
    ] = Mode.TC
    machine: MachineName = ""
    material: MaterialName = ""
    roughness_um: Annotated[
        float | None,
        Interval(gt=0.0, le=1000.0),
        About(
            "largest Ra of finished surfaces, in µm", unit="µm", name="roughness",
            group="limits", flag="--roughness", metavar="UM",
        ),
    ] = None  # fmt: skip
    roughness_quantile: Annotated[
        float,
        Interval(ge=LEAST_SHARE, le=GREATEST_SHARE),
        About(
            "share of real surfaces that must keep their Ra; 0.5: half of them",
            name="roughness quantile", group="limits", flag="--roughness-quantile",
            metavar="Q",
        ),
    ] = LEAST_SHARE  # fmt: skip
    free: Annotated[
        tuple[Free, ...],
        Len(1, 3),
        About("quantities to optimise: feed,depth,speed", flag="--free", metavar="WORDS"),
    ] = (Free.FEED, Free.DEPTH)
    workingsteps: Annotated[
        tuple[Name, ...],
        MaxLen(10_000),
        About(
            "only this workingstep, by its id or #instance; repeatable (default: all)",
            flag="--workingstep", metavar="ID",
        ),
    ] = ()  # fmt: skip
    profile: Annotated[
        FileProfile | None,
        About(
            "how advice is recorded: in entities of its own schema, optimisation, or in those "
            "that every reader knows, standard (default: standard, or optimisation where the "
            "program holds such entities)",
            group="what is written",
            flag="--profile",
        ),
    ] = None
    records: Annotated[
        RecordChoice,
        About(
            "all, or none: advice is written into the technologies only, without a plunge feed "
            "of its own",
            group="what is written",
            flag="--records",
        ),
    ] = RecordChoice.ALL
    nc_control: Annotated[
        Dialect | None,
        About(
            "also write NC code with the advised feeds, for linuxcnc, fanuc, haas, sinumerik, "
            "heidenhain or canonical",
            group="what is written",
            name="control", flag="--nc", metavar="CONTROL", examples=("linuxcnc",),
        ),
    ] = None  # fmt: skip
    is_exact_path: Annotated[
        bool,
        About(
            "NC code with exact stops at corners, instead of rounding them within the path "
            "tolerance",
            name="exact_path",
            group="what is written",
            flag="--exact-path",
        ),
    ] = False
    has_pareto: Annotated[
        bool, About("also compute the front of time, roughness and energy", flag="--pareto")
    ] = False
    tool_change_s: Annotated[
        float,
        Interval(ge=0.0, le=86_400.0),
        About(
            "time to change a worn tool, in s; tool life is then considered", unit="s",
            name="tool change", group="limits", flag="--tool-change-s", metavar="S",
        ),
    ] = 0.0  # fmt: skip
    has_corrections: Annotated[bool, About("apply accepted corrections of k_c")] = True
    is_confirmed: Annotated[
        bool,
        About(
            "run the advised program on the virtual machine and compare the results with "
            "the plan; exit 5 where a bound is exceeded",
            flag="--confirm",
        ),
    ] = False
    safety: Annotated[
        float,
        Interval(ge=LEAST_QUANTILE, le=GREATEST_QUANTILE),
        About(
            "quantile of k_c, by its spread in catalogues or as learned, at which loads keep "
            "their bounds; 0.5: nominal",
            group="limits", flag="--safety", metavar="Q",
        ),
    ] = USUAL_QUANTILE  # fmt: skip
    centre_cutting: Annotated[
        Mapping[Name, bool],
        MaxLen(1000),
        About(
            "whether tools cut over centre, by their ids", examples=({"END MILL 10MM": True},)
        ),
    ] = field(default_factory=dict, hash=False)
    ignore_record: Annotated[
        bool,
        About(
            "ignore the limits of optimisation records in the file: motor power, greatest feed "
            "per tooth, greatest depth",
            group="limits",
            flag="--ignore-record",
        ),
    ] = False
    keep_going: Annotated[
        bool,
        About(
            "advise what can be advised and leave every other workingstep as it is; exit 3 "
            "where the data of one are bad, 4 where one is infeasible",
            flag="--keep-going",
        ),
    ] = False
    allow_plunge: Annotated[
        bool,
        About(
            "let tools that do not cut over centre plunge straight into solid material; "
            "without it: exit 5; of NC code: let straight plunges be faster than programmed, "
            "by their depth",
            group="limits",
            flag="--allow-plunge",
        ),
    ] = False
    is_along_path: Annotated[
        bool,
        About(
            "also choose the feed along each path, within its limits at every place; the NC "
            "code of --nc gets these feeds",
            group="along the path",
            flag="--along-path",
        ),
    ] = False
    levels: Annotated[
        int | None,
        Interval(ge=1, le=10_000),
        About(
            "largest number of different feeds in a workingstep along its path (default: any)",
            group="along the path", flag="--levels", metavar="K",
        ),
    ] = None  # fmt: skip
    motion: Annotated[
        ControlModelName,
        About(
            "motion control along the path, which decides how early a feed is commanded: fir, "
            "junction, exact-stop or linuxcnc",
            group="along the path",
            flag="--motion",
        ),
    ] = ControlModelName.FIR
    is_jerk_limited: Annotated[
        bool,
        About(
            "also compute the profile along the path with the jerk of the axes limited",
            group="along the path",
            flag="--jerk",
        ),
    ] = False
    smooth_share: Annotated[
        float | None,
        Interval(gt=0.0, le=1.0),
        About(
            "also compute the smoothest profile along the path that takes at most this share "
            "longer than the fastest",
            group="along the path", flag="--smooth", metavar="SHARE",
        ),
    ] = None  # fmt: skip
    writes_toolpaths: Annotated[
        bool,
        About(
            "with --along-path: write each path into the program, with its feeds along it",
            group="along the path",
            flag="--write-toolpaths",
        ),
    ] = False
    stock_margin_mm: Annotated[
        float,
        Interval(ge=0.0, le=100.0),
        About(
            "distance from the stock within which nothing counts as air, in mm; 3 for castings",
            group="along the path",
            unit="mm", name="stock margin", flag="--stock-margin", metavar="MM",
        ),
    ] = 1.0  # fmt: skip
    corner_tolerance_mm: Annotated[
        float,
        Interval(gt=0.0, le=10.0),
        About(
            "rounding of corners by the control that is always permitted along the path, in mm",
            group="along the path",
            unit="mm", name="corner tolerance", flag="--corner-tolerance", metavar="MM",
        ),
    ] = 0.05  # fmt: skip
    max_feed_mm_min: Annotated[
        float | None,
        Interval(gt=0.0, le=1e6),
        About(
            "greatest feed along the path, in mm/min (default: that of the machine)",
            group="along the path",
            unit="mm/min", name="greatest feed", flag="--max-feed", metavar="MM_MIN",
        ),
    ] = None  # fmt: skip
    greatest_rise: Annotated[
        float,
        Interval(ge=1.0, le=1000.0),
        About(
            "of NC code: greatest feed along the path over the programmed one",
            name="greatest rise", group="NC code", flag="--greatest-rise", metavar="N",
        ),
    ] = USUAL_RISE  # fmt: skip
    least_feed_mm_min: Annotated[
        float | None,
        Interval(gt=0.0, le=1e6),
        About(
            "feed along the path that is always permitted, in mm/min: where limits demand "
            "less, it is taken, and a warning says where",
            group="along the path",
            unit="mm/min", name="least feed", flag="--least-feed", metavar="MM_MIN",
        ),
    ] = None  # fmt: skip
    finish: Annotated[
        tuple[Name, ...],
        MaxLen(1000),
        About(
            "of NC code: a tool that leaves final surfaces, such as T3; repeatable; what "
            "follows a comment with the word FINISH does too",
            group="NC code", flag="--finish", metavar="TOOL",
        ),
    ] = ()  # fmt: skip
    keep: Annotated[
        tuple[Name, ...],
        MaxLen(1000),
        About(
            "of NC code: a tool whose feeds stay as programmed; repeatable",
            group="NC code", flag="--keep", metavar="TOOL",
        ),
    ] = ()  # fmt: skip
    keeps_state: KeepsState = ()
    spindle: Annotated[
        tuple[Name, ...],
        MaxLen(1000),
        About(
            "of NC code: speed in rpm of a tool that turns at one which the code does not "
            "state, T1=18000, or 18000 for all such tools; repeatable",
            group="NC code", flag="--spindle", metavar="TOOL=RPM",
        ),
    ] = ()  # fmt: skip
    is_unrolled: Annotated[
        bool,
        About(
            "of NC code: write each block as often as it is executed, without calls and "
            "repeats, so that each call has feeds of its own",
            group="NC code",
            flag="--unroll",
        ),
    ] = False
    dialect: Annotated[
        Dialect | None,
        About(
            "of NC code: its control (default: recognised by what it says)",
            group="NC code", flag="--dialect", metavar="CONTROL",
        ),
    ] = None  # fmt: skip
    is_marked: Annotated[
        bool,
        About(
            "of NC code: add the reason of each changed feed as a comment",
            group="NC code",
            flag="--mark",
        ),
    ] = False
