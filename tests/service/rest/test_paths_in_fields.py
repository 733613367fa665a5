"""Paths and addresses in every text field of the API: none is opened, or even looked up.

The fields are those of the OpenAPI document. A watch tells which files any process of
the server opens; that a file is there must not change an answer either.
"""

import json
import os
import socket
import tempfile
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx
import pytest

from simulator.library import DATA
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box
from tests.service.rest.conftest import Done, id_of
from tests.service.rest.opened_files import OpenedFiles
from tests.service.rest.samples import SAMPLE
from tests.service.rest.server import Server, over

UNKNOWN = "0" * 26

Place = tuple[str | int, ...]
"""Keys that lead to a value in a body."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TextField:
    """Text field of an operation."""

    method: str
    route: str
    where: str
    """``path``, ``query``, ``header`` or ``body``."""
    place: Place

    def __str__(self) -> str:
        return f"{self.method} {self.route} {self.where} {'.'.join(map(str, self.place))}"


def text_fields(document: dict[str, Any]) -> Iterator[TextField]:
    """All fields of all operations that can hold a text."""
    for route, operations in document["paths"].items():
        for method, operation in operations.items():
            for each in operation.get("parameters", ()):
                if list(texts(document, each["schema"])):
                    yield TextField(
                        method=method, route=route, where=each["in"], place=(each["name"],)
                    )
            for content in operation.get("requestBody", {}).get("content", {}).values():
                for place in texts(document, content.get("schema", {})):
                    yield TextField(method=method, route=route, where="body", place=place)


def texts(document: dict[str, Any], schema: dict[str, Any]) -> Iterator[Place]:
    """Places of the texts in a value of a schema; keys of mappings are texts as well."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        yield from texts(document, document["components"]["schemas"][name])
    for each in (*schema.get("anyOf", ()), *schema.get("allOf", ()), *schema.get("oneOf", ())):
        yield from texts(document, each)
    if schema.get("type") == "string":
        yield ()
    for name, each in schema.get("properties", {}).items():
        yield from ((name, *rest) for rest in texts(document, each))
    if isinstance(schema.get("items"), dict):
        yield from ((0, *rest) for rest in texts(document, schema["items"]))
    if schema.get("additionalProperties"):
        yield (KEY,)


KEY = "(key)"
"""Place of the key of a mapping."""


def with_text(body: Any, place: Place, text: str) -> Any:
    """A body with a text in a place, and all that the place needs around it."""
    if not place:
        return text
    key, *rest = place
    if key == KEY:
        return {text: True}
    if key == 0:
        return [with_text(None, tuple(rest), text)]
    found = dict(body) if isinstance(body, dict) else {}
    found[key] = with_text(found.get(key), tuple(rest), text)
    return found


def bodies(done: Done) -> dict[str, Any]:
    """Bodies that are accepted, but for the field that is tried."""
    run = {"program_id": done.program, "machine": "vmc15"}
    logged = {"program_id": done.program, "run_id": done.simulation, "machine": "vmc15"}
    return {
        "/v1/simulations": run,
        "/v1/control-runs": {**run, "pace": 0.0, "is_recorded": False},
        "/v1/cycle-times": logged,
        "/v1/verifications": {**logged, "cell_mm": 1.0},
        "/v1/factories": {"sample": "line"},
        "/v1/factories/{id}/changes": {"failure": {"repair_min": 1.0}},
    }


RAW = {"/v1/programs": SAMPLE, "/v1/files": None}
"""Operations that take the bytes of a file."""

QUERY = {"/v1/files": {"name": "raw.stl", "kind": "stock"}}


@dataclass(frozen=True, slots=True, kw_only=True)
class Asker:
    """Sends requests with a text in one field."""

    client: httpx.Client
    done: Done
    mesh: bytes

    def ask(self, field: TextField, text: str) -> httpx.Response:
        """Answer to a request, whose stream is not waited for."""
        route, headers = field.route, {}
        query: dict[str, Any] = dict(QUERY.get(field.route, {}))
        if field.where == "path":
            route = route.replace(f"{{{field.place[0]}}}", quote(text, safe=""))
        elif field.where == "query":
            query[str(field.place[0])] = text
        elif field.where == "header":
            headers[str(field.place[0])] = text
        route = self._filled(route, field)
        request = self.client.build_request(
            field.method.upper(),
            route,
            params=query,
            headers=headers,
            **self._body(field, text),
        )
        return self.client.send(request)

    def _filled(self, route: str, field: TextField) -> str:
        """Route with ids of what is there, or of nothing where it would be lost."""
        if "{id}" in route:
            is_kept = field.method in {"get", "post"} and not route.endswith("cancel")
            id = id_of(self.done, field.route) if is_kept else UNKNOWN
            route = route.replace("{id}", id)
        for name in ("workingstep", "name", "number", "machine", "run"):
            route = route.replace(f"{{{name}}}", "999999")
        return route

    def _body(self, field: TextField, text: str) -> dict[str, Any]:
        if field.where == "body" and not field.place:
            return {"content": text.encode()}
        if field.route in RAW and field.method == "post":
            return {"content": SAMPLE.read_bytes() if RAW[field.route] else self.mesh}
        if field.method not in {"post", "put"}:
            return {}
        body = deepcopy(bodies(self.done).get(field.route, {}))
        if field.where == "body":
            body = with_text(body, field.place, text)
        return {"json": body}

    def undo(self, field: TextField, answer: httpx.Response, *, is_run: bool) -> str:
        """Problem of the job that an answer has made, if it is run; all is deleted again."""
        if answer.status_code not in {201, 202} or "id" not in answer.json():
            return ""
        id, told = answer.json()["id"], ""
        if answer.status_code == 201:
            self.client.delete(f"{field.route}/{id}")
            return ""
        if not is_run:
            self.client.post(f"/v1/jobs/{id}/cancel")
        job = over(self.client, id)
        if is_run:
            told = json.dumps(job.get("problem"))
        self.client.delete(f"/v1/jobs/{id}")
        return told


@pytest.fixture
def short_folder() -> Iterator[Path]:
    """Folder whose path is short enough to stay whole in every message."""
    with tempfile.TemporaryDirectory() as name:
        yield Path(name)


def test_no_text_of_a_request_is_a_path(
    service: Server, client: httpx.Client, done: Done, short_folder: Path
) -> None:
    folder = short_folder
    mesh = write_stl(folder / "there.stl", box((0.0, 0.0, -20.0), (60.0, 40.0, 0.0)))
    for name, suffix in (("machines", ".toml"), ("materials", ".toml")):
        source = next((DATA / name).glob("*.toml"))
        (folder / f"{name}{suffix}").write_bytes(source.read_bytes())
    os.mkfifo(folder / "pipe.stl")
    asker = Asker(client=client, done=done, mesh=mesh.read_bytes())
    fields = list(text_fields(client.get("/v1/openapi.json").json()))
    assert {str(each) for each in fields} >= {
        "post /v1/simulations body stock", "post /v1/cycle-times body stock",
        "post /v1/control-runs body disturbances.0", "get /v1/outcomes query program",
    }  # fmt: skip
    near = os.path.relpath(folder, service.folder)
    faults: list[str] = []
    with socket.create_server(("127.0.0.1", 0)) as web, OpenedFiles(folder) as opened:
        web.setblocking(False)
        others = (
            f"{folder}/pipe.stl", "/dev/zero", f"{near}/machines.toml",
            f"file://{mesh}", f"http://127.0.0.1:{web.getsockname()[1]}/there.stl",
        )  # fmt: skip
        for field in fields:
            answers = []
            for name in ("there.stl", "other.stl"):
                answer = asker.ask(field, f"{folder}/{name}")
                told = asker.undo(field, answer, is_run=field.where == "body")
                shown = "" if answer.is_success else _without_instance(answer)
                words = f"{answer.status_code} {shown} {told}"
                answers.append(words.replace(name, "NAME"))
            if answers[0] != answers[1]:
                faults.append(f"{field}: tells that a file is there: {answers}")
            for text in (*others, f"{folder}/materials.toml"):
                answer = asker.ask(field, text)
                asker.undo(field, answer, is_run=False)
                if answer.status_code >= 500:
                    faults.append(f"{field}: {text}: {answer.text}")
            if seen := opened.taken():
                faults.append(f"{field}: opens {seen}")
        with pytest.raises(BlockingIOError):
            web.accept()
        mesh.read_bytes()
        assert opened.taken() == {"there.stl"}
    assert not faults, "\n".join(faults)
    assert client.get("/readyz").status_code == 200


def _without_instance(answer: httpx.Response) -> str:
    """A problem without the id of its request."""
    found = answer.json() if "json" in answer.headers.get("content-type", "") else {}
    return answer.text.replace(str(found.get("instance", "\0")), "ID")
