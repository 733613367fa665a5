"""Errors as RFC 9457 bodies: each has a status, none shows where the data lies."""

import json
from collections.abc import Iterator
from importlib import import_module
from math import inf, nan

import service.errors
from kbe.errors import (
    StoreBusy,
    StoreDamaged,
    StoreFull,
    StoreUnavailable,
    UnknownCorrection,
)
from optimiser.errors import Infeasible, SolverFailed
from service.errors import (
    Conflict,
    NotFound,
    PreconditionFailed,
    StorageFull,
    TooLarge,
    TooMany,
    Unauthorised,
    Unavailable,
)
from service.web.problem import plain_problem, problem_of, status_of, type_of
from simulator.errors import LibraryError, OutOfTravel, UnknownMachine
from stepnc_model.errors import Part21Error, SchemaError, StepNcError, WriteError
from tests.every_case import every_case

ROOT = "/srv/shop/data"

MODULES = (
    "stepnc_model.errors", "simulator.errors", "optimiser.errors", "controller.errors",
    "kbe.errors", "service.errors",
)  # fmt: skip

RESERVED = {"type", "title", "status", "detail", "instance"}


def kinds() -> Iterator[type[StepNcError]]:
    for name in MODULES:
        for kind in vars(import_module(name)).values():
            if isinstance(kind, type) and issubclass(kind, StepNcError):
                yield kind


@every_case("kind", sorted(set(kinds()), key=str))
def test_every_error_has_a_status_and_a_type(kind: type[StepNcError]) -> None:
    error = kind.__new__(kind, "why")
    assert 400 <= status_of(error) < 600
    assert type_of(kind.__name__).removeprefix("urn:stepnc:problem:").replace("-", "").isalnum()


@every_case(
    ("error", "status", "type"),
    [
        (NotFound("program", "x"), 404, "not-found"),
        (UnknownCorrection("kb", id=3), 404, "unknown-correction"),
        (Conflict("busy"), 409, "conflict"),
        (PreconditionFailed("changed"), 412, "precondition-failed"),
        (StorageFull("no room"), 507, "storage-full"),
        (TooLarge("it", bound=3), 413, "too-large"),
        (Unauthorised("who"), 401, "unauthorised"),
        (TooMany(2.0), 429, "too-many"),
        (Unavailable("gone"), 503, "unavailable"),
        (StoreBusy("kb"), 503, "store-busy"),
        (StoreUnavailable("kb", reason="r"), 503, "store-unavailable"),
        (StoreFull("kb"), 507, "store-full"),
        (StoreDamaged("kb", reason="r"), 500, "store-damaged"),
        (WriteError("no room", path="x"), 507, "write-error"),
        (Part21Error("what", line=3, column=4), 422, "part21-error"),
        (SchemaError("no tool", entity="#1 X", line=3), 422, "schema-error"),
        (StepNcError("other"), 422, "step-nc-error"),
    ],
)
def test_statuses_and_types(error: StepNcError, status: int, type: str) -> None:
    found = problem_of(error)
    assert (found["status"], found["type"]) == (status, f"urn:stepnc:problem:{type}")
    assert found["detail"] == str(error)
    assert found["title"]


def test_fields_of_an_error_are_fields_of_its_body() -> None:
    found = problem_of(SchemaError("no tool", entity="#1 X", attribute="its_tool", line=3))
    assert (found["entity"], found["attribute"], found["line"]) == ("#1 X", "its_tool", 3)
    found = problem_of(Infeasible("both", limits=("power", "chip load")))
    assert found["limits"] == ("power", "chip load")
    found = problem_of(OutOfTravel("X", 7.0, travel=(0.0, 1.0), line=2))
    assert (found["axis"], found["position"], found["line"]) == ("X", 7.0, 2)


def test_no_field_of_an_error_takes_the_place_of_a_standard_one() -> None:
    found = problem_of(SolverFailed("infeasible"))
    assert found["status"] == 500
    assert found["detail"].endswith("infeasible")
    assert all(isinstance(found[name], str) for name in ("type", "title", "detail"))


def test_the_data_folder_is_nobodys_business() -> None:
    for error in (
        LibraryError("bad", path=f"{ROOT}/machines/ours.toml", key="k"),
        WriteError("no room", path=f"{ROOT}/jobs/x/report.html"),
        StoreDamaged(f"{ROOT}/knowledge.db", reason=f"{ROOT} is gone"),
        UnknownMachine("x", (f"{ROOT}/machines/ours.toml", "vmc15")),
        NotFound("program", ROOT),
    ):
        found = problem_of(error, hidden=ROOT)
        assert ROOT not in json.dumps(found), error
        assert found["status"] == status_of(error)


def test_numbers_that_are_none_stay_readable() -> None:
    error = OutOfTravel("X", nan, travel=(0.0, inf), line=2)
    assert json.loads(json.dumps(problem_of(error)))["status"] == 422


def test_a_problem_without_an_error() -> None:
    found = plain_problem(422, "Invalid request", "why", errors=[1])
    assert found == {
        "type": "urn:stepnc:problem:invalid-request",
        "title": "Invalid request",
        "status": 422,
        "detail": "why",
        "errors": [1],
    }


def test_every_error_of_the_service_has_a_line_of_its_own_in_the_table() -> None:
    of_service = {
        kind
        for kind in vars(service.errors).values()
        if isinstance(kind, type)
        and issubclass(kind, service.errors.ServiceError)
        and kind is not service.errors.ServiceError
    }
    assert all(status_of(kind.__new__(kind, "x")) != 422 for kind in of_service)
