"""Request of a run of the virtual factory."""

from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Interval, MaxLen

from service.live.playback import LEAST, MOST
from service.requests.fields import About, Request
from service.requests.program_facts import Name
from service.requests.runs import PaceOrNone, Seed

MOST_REPLICATIONS = 500
"""Most replications that the service runs."""

LIVE = "a shop that runs live"
"""Heading in the help."""

SHORTEST_REPAIR, LONGEST_REPAIR = 0.0, 10_000.0
"""Bounds of the repair time of an ordered failure, in min."""

EXAMPLE = {
    "machine": [{"name": "mill", "machine": "vmc15", "count": 2}],
    "product": [{"name": "plate", "batch": 5, "step": [{"machines": ["mill"], "time_s": 300}]}],
}
"""A small shop."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShopTimes(Request):
    """Times and seed of a run of a shop."""

    hours: Annotated[
        float | None,
        Interval(gt=0.0, le=1e6),
        About("simulated time, h (default: that of the shop file)", unit="h", flag="--hours",
              metavar="H"),
    ] = None  # fmt: skip
    warm_up_hours: Annotated[
        float | None,
        Interval(ge=0.0, le=1e6),
        About("time at the beginning that does not count, h (default: that of the shop file)",
              unit="h", name="warm-up", flag="--warm-up-hours", metavar="H"),
    ] = None  # fmt: skip
    seed: Seed = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class FactoryRequest(ShopTimes):
    """Request to run a shop."""

    replications: Annotated[
        int,
        Interval(ge=1, le=10_000),
        About("independent runs; two and more give 95 % intervals", flag="--replications",
              metavar="N"),
    ] = 1  # fmt: skip
    sweep: Annotated[
        tuple[str, ...],
        About(
            "compare values of a key of the shop file, as product[1].batch=1,5,10 or "
            "machine[2].failure[1].every_h.mean=5,10; may be repeated: all combinations",
            flag="--sweep", metavar="KEY=V,V",
        ),
    ] = ()  # fmt: skip
    has_energy: Annotated[
        bool,
        About("add machining power and energy to the tables of parts", flag="--energy"),
    ] = False
    documents: Annotated[
        int,
        Interval(ge=0, le=100_000),
        About("write an MTConnect document of each of the first parts of a machine, N of them",
              flag="--documents", metavar="N"),
    ] = 0  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveFactoryRequest(FactoryRequest):
    """Request of a shop that may run live, for clients of its MTConnect agent."""

    is_live: Annotated[
        bool,
        About(
            "run the shop at a pace, each machine as a device of one MTConnect agent",
            group=LIVE, flag="--live",
        ),
    ] = False  # fmt: skip

    speed: Annotated[
        float,
        Interval(ge=0.01, le=10_000.0),
        About("simulated seconds per wall-clock second", name="speed",
              group=LIVE, flag="--speed", metavar="X"),
    ] = 60.0  # fmt: skip
    port: Annotated[
        int,
        Interval(ge=0, le=65535),
        About("port to listen on; 0: any that is free", group=LIVE, flag="--port",
              metavar="N"),
    ] = 5000  # fmt: skip
    host: Annotated[str, About("address to listen on", group=LIVE, flag="--host")] = "127.0.0.1"
    host_names: Annotated[
        tuple[Name, ...],
        MaxLen(100),
        About(
            "a host name by which clients reach this computer, beside its "
            "addresses; repeatable",
            group=LIVE, flag="--name", metavar="HOST",
        ),
    ] = ()  # fmt: skip
    buffer: Annotated[
        int,
        Interval(ge=1000, le=1 << 22),
        About("observations that are kept", group=LIVE, flag="--buffer", metavar="N"),
    ] = 1 << 17  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class FactoryOrder(ShopTimes):
    """Request to run a shop in the service; programs and machines by name, never by path."""

    shop: Annotated[
        dict[str, Any] | str | None,
        About("content of a shop file: a JSON object, or TOML text", examples=(EXAMPLE,)),
    ] = None
    sample: Annotated[Name, About("or a sample shop", examples=("line",))] = ""
    replications: Annotated[
        int,
        Interval(ge=1, le=MOST_REPLICATIONS),
        About("independent runs; two and more give 95 % intervals"),
    ] = 1
    sweep: Annotated[
        tuple[Annotated[str, MaxLen(300)], ...],
        MaxLen(8),
        About("values of a key of the shop file to compare, as product[1].batch=1,5,10"),
    ] = ()
    pace: Annotated[
        float,
        Interval(ge=0.0, le=MOST),
        PaceOrNone(),
        About(
            "simulated seconds per wall-clock second of a live run, which counts from its "
            "beginning unless it has a warm-up; 0: not live"
        ),
    ] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineFailure(Request):
    """Failure of a machine."""

    machine: Annotated[Name, About("name of the machine in the shop")]
    repair_min: Annotated[
        float,
        Interval(gt=SHORTEST_REPAIR, le=LONGEST_REPAIR),
        About("time of the repair, min", unit="min", name="repair"),
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class FactoryChanges(Request):
    """Orders to a live shop; omitted fields change nothing."""

    pace: Annotated[
        float | None,
        Interval(ge=LEAST, le=MOST),
        About("simulated seconds per wall-clock second"),
    ] = None
    failure: Annotated[MachineFailure | None, About("let a machine fail now")] = None
    is_ended: Annotated[bool, About("end the run; its result counts until now")] = False
