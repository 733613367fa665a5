"""Bodies of requests: bounds are kept, what is not known is refused, names carry units."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, TypeAdapter, ValidationError

from service.ids import new_id
from service.requests.advice import AdviceRequest
from service.requests.fields import Request, dumped, fields_of, loaded
from service.requests.knowledge import EvaluationRequest, ReviewRequest
from service.requests.runs import ControlChanges, ControlRequest, RunRequest, SimulationRequest
from service.rest.bodies import DecisionBody, TrialBody, TrialChanges
from service.trial.inputs import FIELDS, Inputs, changed
from service.trial.request import TrialRequest
from tests.every_case import every_case

Kind = type[Request] | type[BaseModel]

REQUESTS: list[type[Request]] = [
    AdviceRequest, SimulationRequest, ControlRequest, TrialRequest, EvaluationRequest,
    ReviewRequest,
]  # fmt: skip

KINDS: list[Kind] = [*REQUESTS, ControlChanges, TrialBody, TrialChanges, DecisionBody]


def read(kind: Kind, values: Any) -> Any:
    return TypeAdapter(kind).validate_python(values)


@every_case("kind", KINDS)
def test_a_field_that_is_not_known_is_refused(kind: Kind) -> None:
    with pytest.raises(ValidationError, match="surprise"):
        read(kind, {"by": "A", "surprise": 1} if kind is DecisionBody else {"surprise": 1})


@every_case("kind", REQUESTS)
def test_a_request_is_the_same_after_it_was_kept_as_json(kind: type[Request]) -> None:
    request = kind()
    assert loaded(kind, json.loads(json.dumps(dumped(request)))) == request


@every_case("kind", REQUESTS)
def test_each_field_is_documented_in_openapi(kind: type[Request]) -> None:
    properties = TypeAdapter(kind).json_schema()["properties"]
    for field in fields_of(kind):
        assert properties[field.name]["description"] == field.about.text


NUMBERS: list[tuple[Kind, str]] = [
    (AdviceRequest, "roughness_um"), (AdviceRequest, "tool_change_s"),
    (AdviceRequest, "safety"), (SimulationRequest, "rate_hz"), (SimulationRequest, "pace"),
    (SimulationRequest, "kc_factor"), (SimulationRequest, "missing"),
    (SimulationRequest, "runout_um"), (ControlRequest, "force_set_point_n"),
    (ControlRequest, "override_low_percent"), (ControlRequest, "pace"),
    (ControlRequest, "deviation_mm"), (ControlChanges, "depth_percent"),
    (ControlChanges, "pace"), (TrialBody, "pace"), (TrialChanges, "pace"),
    (TrialRequest, "pace"),
]  # fmt: skip


@every_case(("kind", "name"), NUMBERS)
@every_case("value", ["NaN", "Infinity", "-Infinity", "-1", "1e300", '"x"', "[]"])
def test_no_number_is_beyond_its_bounds(kind: Kind, name: str, value: str) -> None:
    with pytest.raises(ValidationError):
        read(kind, json.loads(f'{{"{name}": {value}}}'))


@pytest.mark.parametrize("kind", [SimulationRequest, ControlRequest])
def test_a_run_has_a_pace_that_ends_or_none(kind: type[RunRequest]) -> None:
    for pace in (0.0, 0.01, 1000.0):
        assert read(kind, {"pace": pace}).pace == pace
    for pace in (1e-300, 5e-324, 0.0099):
        with pytest.raises(ValidationError, match=r"0\.01 to 1000, or 0"):
            read(kind, {"pace": pace})


@every_case("field", FIELDS)
def test_a_trials_numbers_have_the_bounds_of_the_trial(field: Any) -> None:
    for value in (field.low, field.high):
        body = TrialBody.model_validate({"inputs": {field.name: value}})
        words = body.inputs.model_dump(mode="json", exclude_none=True)
        assert words == {field.name: value}
    for value in (field.low - 1e-6 - field.is_whole, field.high * 1.001 + 1.0, float("nan")):
        with pytest.raises(ValidationError):
            TrialBody.model_validate({"inputs": {field.name: value}})


def test_what_is_left_out_of_a_change_stays() -> None:
    words = TrialChanges.model_validate({}).inputs.model_dump(exclude_none=True)
    assert words == {}
    assert changed(Inputs(), **words) == Inputs()


@given(st.text(max_size=30))
def test_nothing_but_an_id_names_a_program(word: str) -> None:
    with pytest.raises(ValidationError):
        read(SimulationRequest, {"program_id": f"{word}/"})
    with pytest.raises(ValidationError):
        read(SimulationRequest, {"program_id": f"{new_id()}\n"})


def test_nc_code_is_left_out_by_default() -> None:
    assert dumped(AdviceRequest())["nc_control"] is None
    assert dumped(read(AdviceRequest, {"nc_control": "linuxcnc"}))["nc_control"] == "linuxcnc"


def test_moments_go_through_json() -> None:
    body = read(EvaluationRequest, {"since": "2026-03-05T12:00:00+01:00"})
    assert dumped(body)["since"] == "2026-03-05T12:00:00+01:00"
