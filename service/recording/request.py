"""Request of a recording."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, Request


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingRequest(Request):
    """Request to record what a machine's MTConnect agent tells."""

    duration_s: Annotated[
        float | None,
        Interval(gt=0.0, le=1e7),
        About("seconds to record (default: until interrupted)", unit="s", name="duration",
              flag="--duration", metavar="S"),
    ] = None  # fmt: skip
    is_until_completed: Annotated[
        bool, About("end when the program that runs is completed", flag="--until-completed")
    ] = False
    is_buffered: Annotated[
        bool, About("begin with the oldest observation that the agent keeps", flag="--buffered")
    ] = False
    is_next_run: Annotated[
        bool,
        About("record the next run of a program, from its start until it is completed",
              flag="--next-run"),
    ] = False  # fmt: skip
