"""Request of a run of the virtual factory."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, Request
from service.requests.runs import Seed


@dataclass(frozen=True, slots=True, kw_only=True)
class FactoryRequest(Request):
    """Request to run a shop."""

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
class LiveFactoryRequest(Request):
    """Request of a shop that runs live, for clients of its MTConnect agent."""

    speed: Annotated[
        float,
        Interval(ge=0.01, le=10_000.0),
        About("with --live: simulated seconds per wall-clock second", name="speed",
              flag="--speed", metavar="X"),
    ] = 60.0  # fmt: skip
    port: Annotated[
        int,
        Interval(ge=0, le=65535),
        About("with --live: port to listen on; 0: any that is free", flag="--port",
              metavar="N"),
    ] = 5000  # fmt: skip
    host: Annotated[str, About("with --live: address to listen on", flag="--host")] = (
        "127.0.0.1"
    )
    buffer: Annotated[
        int,
        Interval(ge=1000, le=1 << 22),
        About("with --live: observations that are kept", flag="--buffer", metavar="N"),
    ] = 1 << 17  # fmt: skip
