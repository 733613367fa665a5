"""Options by kind of program: one declaration for command line and REST.

An option that a kind of program cannot use is refused with its reason. An option that is not
named here serves both kinds.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from optimiser.modes import Mode
from service.inputs.program_kind import ProgramKind
from service.requests.fields import Request, fields_of
from stepnc_model.errors import StepNcError

STEP_NC, NC_CODE = ProgramKind.STEP_NC, ProgramKind.NC_CODE


@dataclass(frozen=True, slots=True, kw_only=True)
class Serves:
    """Kind of program that an option serves alone, and why no other."""

    kind: ProgramKind
    why: str
    """Reason why another kind of program cannot use it."""
    is_concerned: Callable[[object], bool] = bool
    """Whether the option, if it has some value, serves this kind alone."""


_NO_STEPS = "NC code has no workingsteps and no technologies"
_NO_ENTITIES = "NC code has no instances whose values could be given"
_ALWAYS_RUN = "NC code is run on the virtual machine without it"
_OWN_TOOLS = "a STEP-NC program names its tools and their use itself"

SERVES: Mapping[str, Serves] = {
    **{
        name: Serves(kind=STEP_NC, why=why)
        for name, why in {
            "units": "NC code states its own units",
            "given": _NO_ENTITIES,
            "teeth": "the tool table gives the teeth of NC code's tools",
            "feed": _NO_ENTITIES,
            "free": "feeds alone change in NC code",
            "workingsteps": _NO_STEPS,
            "profile": "no record is written into NC code",
            "records": "no record is written into NC code",
            "nc_control": "NC code is rewritten for the control that it was written for",
            "is_exact_path": "NC code keeps its own path mode",
            "has_pareto": _NO_STEPS,
            "tool_change_s": "the spindle speeds of NC code stay",
            "centre_cutting": "the tool table tells it of NC code's tools",
            "ignore_record": "NC code has no records",
            "keep_going": "what cannot be used of NC code is left out, or as it is, without it",
            "is_confirmed": _ALWAYS_RUN,
            "writes_toolpaths": "tool paths are written into STEP-NC programs",
        }.items()
    },
    "mode": Serves(
        kind=STEP_NC,
        why="NC code is advised for least time (TC), or for surfaces of a roughness (QC)",
        is_concerned=lambda mode: str(mode).upper() in {Mode.EC.value, Mode.CC.value},
    ),
    **{
        name: Serves(kind=NC_CODE, why=why)
        for name, why in {
            "finish": _OWN_TOOLS,
            "keep": _OWN_TOOLS,
            "keeps_state": "a STEP-NC program calls no other one",
            "spindle": "a STEP-NC program states the speeds of its technologies",
            "setup": "a STEP-NC program has its own tools, stock and material",
            "is_unrolled": "a STEP-NC program has no calls and repeats",
            "dialect": "a STEP-NC program is for no control",
            "is_marked": "a STEP-NC program has records instead",
            "greatest_rise": "advice for a STEP-NC program follows from its own limits",
            "most_repeats": "a STEP-NC program has no calls and repeats",
        }.items()
    },
}  # fmt: skip
"""Options that serve one kind of program alone, by the names of their fields."""


OF_PATHS = (
    "levels", "smooth_share", "writes_toolpaths", "motion", "is_jerk_limited",
    "stock_margin_mm", "corner_tolerance_mm", "max_feed_mm_min", "least_feed_mm_min",
)  # fmt: skip
"""Fields that have no effect for a STEP-NC program without feeds along its paths."""


def require_served(request: Request, kind: ProgramKind) -> None:
    """Refuse values of a request that a kind of program cannot use.

    Raises
    ------
    StepNcError
        With the name of the first such value, and the reason.
    """
    flags = {each.name: each.about.flag for each in fields_of(type(request))}
    require_options_served(changed_values(request), kind, flags=flags)


def changed_values(request: Request) -> dict[str, object]:
    """Values of a request that are not the default ones, by the names of their fields."""
    return {
        each.name: getattr(request, each.name)
        for each in fields_of(type(request))
        if getattr(request, each.name) != each.default
    }


def require_options_served(
    values: Mapping[str, object], kind: ProgramKind, *, flags: Mapping[str, str]
) -> None:
    """Refuse options that a kind of program cannot use.

    Parameters
    ----------
    values : mapping
        Values by the names of the options; those that were not given are absent.
    flags : mapping
        Names of options on the command line; others are called by their names.

    Raises
    ------
    StepNcError
        With the name of the first such option, and the reason.
    """
    for name, serves in _refused(values, kind):
        shown = flags.get(name) or name
        other = "NC code" if kind is NC_CODE else "a STEP-NC program"
        raise StepNcError(f"{shown} cannot be used with {other}: {serves.why}")


def _refused(values: Mapping[str, object], kind: ProgramKind) -> Iterator[tuple[str, Serves]]:
    for name, value in values.items():
        serves = SERVES.get(name)
        if serves is not None and serves.kind is not kind and serves.is_concerned(value):
            yield name, serves
