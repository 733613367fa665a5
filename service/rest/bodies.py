"""Request bodies, with bounds, in the user's units."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, create_model

from controller.orders import Criterion
from service.ids import PATTERN
from service.live.playback import LEAST, MOST
from service.trial.inputs import FIELDS, MillingType

Id = Annotated[str, Field(pattern=PATTERN, examples=["01jd3m8y7q2v4x6z8b0c1d2e3f"])]
Name = Annotated[str, Field(max_length=200)]
Pace = Annotated[float, Field(ge=LEAST, le=MOST)]


class RequestBody(BaseModel):
    """A request's body: what is not known is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


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
    __base__=RequestBody,
    __doc__="Inputs of a trial cut; what is left out stays as it is, at first as usual.",
    milling_type=(MillingType | None, Field(None, description="immersion of the cutter")),
    material=(Name | None, Field(None, description="workpiece", examples=["c45"])),
    mode=(Criterion | None, Field(None, description="TC or QC")),
    is_on=(bool | None, Field(None, description="whether the loop acts")),
    **_numbers(),
)


class TrialBody(RequestBody):
    """A trial cut."""

    inputs: TrialInputs = TrialInputs()
    seed: int = Field(0, ge=0, le=2**31, description="of the sensors' noise")
    pace: Pace = Field(1.0, description="simulated seconds per wall-clock second")


class TrialChanges(RequestBody):
    """Changes to a trial; ``restart`` goes on with a new cutter."""

    inputs: TrialInputs = TrialInputs()
    pace: Pace | None = Field(None, description="simulated seconds per wall-clock second")
    restart: bool = Field(False, description="a new cutter, after the loop has stopped")
    end: bool = Field(False, description="end the trial")


class DecisionBody(RequestBody):
    """Decision on a correction."""

    by: str = Field(min_length=1, max_length=100, examples=["A. Smith"])
