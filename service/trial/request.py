"""Request to run a trial cut."""

from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Interval

from service.live.playback import LEAST, MOST
from service.requests.fields import About, Request
from service.requests.runs import GREATEST_SEED
from service.trial.inputs import Inputs


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialRequest(Request):
    """Request to run a trial cut."""

    inputs: Inputs = field(default_factory=Inputs)
    seed: Annotated[
        int, Interval(ge=0, le=GREATEST_SEED), About("seed of the sensor noise")
    ] = 0
    pace: Annotated[
        float,
        Interval(ge=LEAST, le=MOST),
        About("simulated seconds per wall-clock second"),
    ] = 1.0
