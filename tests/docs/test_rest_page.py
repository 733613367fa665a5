"""The REST page says everything that an OpenAPI document says of its routes."""

import re
from enum import StrEnum
from typing import Annotated

import pytest
from fastapi import FastAPI, Header, Path, Query, Security
from fastapi.openapi.utils import get_openapi
from fastapi.security import HTTPBearer
from pydantic import BaseModel, Field

from docs.hooks import rest_page
from docs.hooks.rest_page import JsonObject, curl, fields, operations, shared_answers
from docs.hooks.rest_page import rest_page as page_of

PART21 = {"type": "string", "format": "binary", "description": "Part 21"}


class Mode(StrEnum):
    TC = "TC"
    QC = "QC"


class Limit(BaseModel):
    name: str = Field(description="what limits")
    bound: float = Field(description="bound of it, N")


class Request(BaseModel):
    mode: Mode = Field(Mode.TC, description="what is best")
    machine: str = Field(examples=["vmc15"], description="name of a machine")
    roughness_um: float | None = Field(None, gt=0.0, description="Ra in µm")
    passes: int = Field(ge=1, le=100, description="how many")


class Answer(BaseModel):
    feed_mm_min: float = Field(description="feed in mm/min")
    limits: list[Limit] = Field(description="all of them")
    before: "Answer | None" = Field(None, description="the one before")


class Problem(BaseModel):
    detail: str


def made() -> FastAPI:
    app = FastAPI(
        title="shop", description="What it is for.", responses={429: {"model": Problem}}
    )

    @app.post("/v1/advice", summary="Advise feeds", status_code=201, responses={
        201: {"description": "advised"}, 409: {"description": "infeasible"},
    }, dependencies=[Security(HTTPBearer())])  # fmt: skip
    def advise(body: Request) -> Answer:
        """The greatest feed that all limits allow."""
        raise NotImplementedError(body)

    @app.get("/v1/runs/{run}", summary="Show a run")
    def show(
        run: Annotated[str, Path(description="id of the run")],
        step: Annotated[float, Query(gt=0.0, description="s between samples")],
        limit: Annotated[int, Query(description="most | rows")] = 50,
        accept: Annotated[str, Header()] = "application/json",
    ) -> list[Limit]:
        raise NotImplementedError(run, step, limit, accept)

    form = {"type": "object", "required": ["file"], "properties": {"file": PART21}}
    for path, media, schema in (
        ("/v1/programs", "application/octet-stream", PART21),
        ("/v1/forms", "multipart/form-data", form),
    ):
        body = {"required": True, "content": {media: {"schema": schema}}}

        @app.put(path, summary="Send a program", openapi_extra={"requestBody": body})
        def send() -> None:
            raise NotImplementedError

    return app


@pytest.fixture(scope="module")
def document() -> JsonObject:
    app = made()
    found: JsonObject = get_openapi(
        title=app.title, version="1", description=app.description, routes=app.routes
    )
    return found


@pytest.fixture(scope="module")
def text(document: JsonObject) -> str:
    return page_of(document)


def section(text: str, title: str) -> str:
    found = re.search(
        rf"^## {re.escape(title)}(?=[ \n]).*?(?=^## |\Z)", text, flags=re.S | re.M
    )
    assert found is not None
    return found[0]


def test_every_route_has_a_section_and_a_row(document: JsonObject, text: str) -> None:
    assert text.startswith("# REST: shop\n\nWhat it is for.\n")
    for path, method, operation in operations(document):
        own = section(text, f"{method.upper()} {path}")
        assert operation["summary"] in own
        anchor = rest_page.anchor(path, method)
        assert f"{{#{anchor}}}" in own
        assert f"(#{anchor})" in text


def test_fields_of_a_body_have_type_meaning_bounds_and_default(text: str) -> None:
    own = section(text, "POST /v1/advice")
    assert "The greatest feed that all limits allow." in own
    assert "| `machine`, required | string | name of a machine |" in own
    assert '| `mode` | one of `TC`, `QC` | what is best; default `"TC"` |' in own
    assert "| `roughness_um` | number or null | Ra in µm; > 0 |" in own
    assert "| `passes`, required | integer | how many; ≥ 1, ≤ 100 |" in own


def test_fields_within_fields_are_told_once(document: JsonObject, text: str) -> None:
    own = section(text, "POST /v1/advice")
    assert "| `feed_mm_min`, required | number | feed in mm/min |" in own
    assert "| `limits[].bound`, required | number | bound of it, N |" in own
    schema = document["components"]["schemas"]["Answer"]
    names = [each.name for each in fields(document, schema)]
    assert "before" in names
    assert len(names) == len(set(names)) < 20


def test_parameters_are_told_and_bars_in_text_end_no_cell(text: str) -> None:
    own = section(text, "GET /v1/runs/{run}")
    assert "| `run`, required | path | string | id of the run |" in own
    assert "| `step`, required | query | number | s between samples; > 0 |" in own
    assert "| `limit` | query | integer | most \\| rows; default `50` |" in own


def test_answers_are_told_with_their_status(text: str) -> None:
    own = section(text, "POST /v1/advice")
    assert "| 201 Created | advised | `application/json` |" in own
    assert "| 409 Conflict | infeasible | none |" in own


def test_what_all_routes_answer_is_told_once(document: JsonObject, text: str) -> None:
    assert set(shared_answers(document)) == {"429"}
    assert "429 Too Many Requests" in section(text, "Answers of every route")
    assert "429" not in section(text, "POST /v1/advice")


def test_a_body_that_is_a_file_says_so(text: str) -> None:
    own = section(text, "PUT /v1/programs")
    assert "**Body**, `application/octet-stream`\n\nfile. Part 21" in own


def test_curl_can_be_copied(document: JsonObject) -> None:
    calls = {
        (method, path): curl(document, path, method, operation)
        for path, method, operation in operations(document)
    }
    assert calls["get", "/v1/runs/{run}"] == (
        "curl 'http://127.0.0.1:8000/v1/runs/RUN?step=1.0'"
    )
    assert calls["post", "/v1/advice"] == (
        "curl -X POST http://127.0.0.1:8000/v1/advice -H 'Authorization: Bearer KEY' "
        '-H \'Content-Type: application/json\' -d \'{"machine": "vmc15", "passes": 1}\''
    )
    assert calls["put", "/v1/programs"] == (
        "curl -X PUT http://127.0.0.1:8000/v1/programs "
        "-H 'Content-Type: application/octet-stream' --data-binary @FILE"
    )
    assert calls["put", "/v1/forms"] == (
        "curl -X PUT http://127.0.0.1:8000/v1/forms -F file=@FILE"
    )


def test_without_a_service_there_is_no_document(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rest_page, "APPLICATION", "service.no_such_folder.app")
    assert rest_page.openapi_document() is None
    monkeypatch.setattr(rest_page, "APPLICATION", "service.no_such_module")
    assert rest_page.openapi_document() is None
