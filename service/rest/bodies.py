"""Request bodies of the REST API, with bounds, in the user's units."""

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
    """Base class of request bodies; unknown fields are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def _numbers() -> dict[str, Any]:
    """Return the numeric inputs of a trial cut as request fields with their bounds."""
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
    __doc__="Inputs of a trial cut; missing ones keep their value, initially the default.",
    milling_type=(MillingType | None, Field(None, description="immersion of the cutter")),
    material=(Name | None, Field(None, description="workpiece material", examples=["c45"])),
    mode=(Criterion | None, Field(None, description="control criterion, TC or QC")),
    is_on=(bool | None, Field(None, description="whether force control is on")),
    **_numbers(),
)


class TrialBody(RequestBody):
    """Request for a trial cut."""

    inputs: TrialInputs = TrialInputs()
    seed: int = Field(0, ge=0, le=2**31, description="seed of the sensor noise")
    pace: Pace = Field(1.0, description="simulated seconds per wall-clock second")


class TrialChanges(RequestBody):
    """Changes to a trial; ``restart`` continues with a new cutter."""

    inputs: TrialInputs = TrialInputs()
    pace: Pace | None = Field(None, description="simulated seconds per wall-clock second")
    restart: bool = Field(False, description="continue with a new cutter after a stop")
    end: bool = Field(False, description="end the trial")


class DecisionBody(RequestBody):
    """Name of the person who decides on a correction."""

    by: str = Field(min_length=1, max_length=100, examples=["A. Smith"])
