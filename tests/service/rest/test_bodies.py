"""Bodies of requests: bounds are kept, what is not known is refused, names carry units."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from service.depot.ids import new_id
from service.rest import bodies
from service.rest.bodies import (
    AdviceBody,
    Body,
    ControlBody,
    ControlChanges,
    DecisionBody,
    EvaluationBody,
    RunBody,
    SimulationBody,
    TrialBody,
    TrialChanges,
)
from service.trial.inputs import FIELDS, Inputs, changed

KINDS = [
    kind
    for kind in vars(bodies).values()
    if isinstance(kind, type) and issubclass(kind, Body) and kind is not Body
]


@pytest.mark.parametrize("kind", KINDS)
def test_a_field_that_is_not_known_is_refused(kind: type[Body]) -> None:
    with pytest.raises(ValidationError, match="Extra inputs are not permitted"):
        kind.model_validate({"by": "A", "surprise": 1})


@pytest.mark.parametrize("kind", KINDS)
def test_a_body_is_json_again(kind: type[Body]) -> None:
    body = kind.model_validate({"by": "A"} if kind is DecisionBody else {})
    assert json.loads(json.dumps(body.words())) == body.words()


NUMBERS: list[tuple[type[Body], str]] = [
    (AdviceBody, "roughness_um"), (AdviceBody, "tool_change_s"), (AdviceBody, "safety"),
    (SimulationBody, "rate_hz"), (SimulationBody, "pace"), (SimulationBody, "kc_factor"),
    (ControlBody, "force_set_point_n"), (ControlBody, "override_low_percent"),
    (ControlBody, "pace"), (ControlChanges, "depth_percent"), (ControlChanges, "pace"),
    (TrialBody, "pace"), (TrialChanges, "pace"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "name"), NUMBERS)
@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", "-1", "1e300", '"x"', "[]"])
def test_no_number_is_beyond_its_bounds(kind: type[Body], name: str, value: str) -> None:
    with pytest.raises(ValidationError):
        kind.model_validate(json.loads(f'{{"{name}": {value}}}'))


@pytest.mark.parametrize("kind", [SimulationBody, ControlBody])
def test_a_run_has_a_pace_that_ends_or_none(kind: type[RunBody]) -> None:
    for pace in (0.0, 0.01, 1000.0):
        assert kind.model_validate({"pace": pace}).pace == pace
    for pace in (1e-300, 5e-324, 0.0099):
        with pytest.raises(ValidationError, match=r"0 or at least 0\.01"):
            kind.model_validate({"pace": pace})


@pytest.mark.parametrize("field", FIELDS, ids=lambda field: field.name)
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
        SimulationBody.model_validate({"program_id": f"{word}/"})
    with pytest.raises(ValidationError):
        SimulationBody.model_validate({"program_id": f"{new_id()}\n"})


def test_nc_code_is_left_out_by_default() -> None:
    assert AdviceBody().words()["nc_control"] == ""
    assert AdviceBody.model_validate({"nc_control": "linuxcnc"}).words()["nc_control"] == (
        "linuxcnc"
    )


def test_moments_go_through_json() -> None:
    body = EvaluationBody.model_validate({"since": "2026-03-05T12:00:00+01:00"})
    assert body.words()["since"] == "2026-03-05T12:00:00+01:00"
