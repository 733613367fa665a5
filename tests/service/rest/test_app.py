"""The application as a whole: problems after RFC 9457, one document of all routes."""

from pathlib import Path

import httpx
import pytest

from service.errors import Unavailable
from service.processes import log_lines
from service.rest.app import application, from_environment
from service.rest.settings import VARIABLE, Settings
from service.storage.folder import open_data_folder
from tests.every_case import every_case
from tests.service.rest.conftest import Done
from tests.service.rest.server import Server, is_problem


def test_a_field_that_is_not_known_is_named(client: httpx.Client, done: Done) -> None:
    for path, body in (
        (f"/v1/programs/{done.program}/advice", {"mod": "TC"}),
        ("/v1/simulations", {"program_id": done.program, "speed": 1}),
        ("/v1/control-runs", {"program_id": done.program, "speed": 1}),
        ("/v1/trials", {"inputs": {"depth": 1}}),
        ("/v1/evaluations", {"machines": "x"}),
        ("/v1/corrections/1/accept", {"by": "A", "why": "x"}),
    ):
        found = is_problem(client.post(path, json=body), 422, "invalid-request")
        unknown = next(name for name in ("mod", "speed", "depth", "machines", "why")
                       if name in str(body))  # fmt: skip
        assert any(unknown in each["place"] for each in found["errors"])


def test_a_body_that_is_no_json_says_where(client: httpx.Client, done: Done) -> None:
    path, headers = f"/v1/programs/{done.program}/advice", {"content-type": "application/json"}
    answer = client.post(path, content=b'{"mode": TC}', headers=headers)
    found = is_problem(answer, 400, "malformed-json")
    assert found["detail"].endswith("at character 9")


def test_a_body_of_another_media_type_is_refused(client: httpx.Client, done: Done) -> None:
    for media_type in ("text/plain", "application/xml; charset=utf-8"):
        headers = {"content-type": media_type}
        path = f"/v1/programs/{done.program}/advice"
        answer = client.post(path, content=b'{"mode": "TC"}', headers=headers)
        found = is_problem(answer, 415, "unsupported-media-type")
        assert media_type.partition(";")[0] in found["detail"]


def test_what_is_not_there_is_a_problem_too(client: httpx.Client) -> None:
    is_problem(client.get("/v1/none"), 404)
    is_problem(client.get("/../../etc/passwd"), 404)
    is_problem(client.get("/dashboard/..%2f..%2fsettings.py"), 404)
    found = client.patch("/v1/programs")
    is_problem(found, 405)
    assert "GET" in found.headers["allow"] or "POST" in found.headers["allow"]


@every_case("id", ["x", "0" * 25, "0" * 27, "0" * 25 + "U", "..%2f" * 5, "%00" * 26])
def test_what_is_no_id_is_refused_everywhere(client: httpx.Client, id: str) -> None:
    for path in ("programs", "jobs", "advice", "simulations", "control-runs", "trials"):
        answer = client.get(f"/v1/{path}/{id}")
        is_problem(answer, answer.status_code)
        assert answer.status_code in {404, 422}


def test_every_route_is_in_the_document_and_says_what_it_answers(
    client: httpx.Client,
) -> None:
    document = client.get("/v1/openapi.json").json()
    assert document["openapi"].startswith("3.")
    for path, methods in document["paths"].items():
        for operation in methods.values():
            assert operation["summary"], path
            assert operation["description"], path
            assert "422" in operation["responses"]
            problem = operation["responses"]["404"]["content"]
            assert "application/problem+json" in problem
    ids = [each["operationId"] for methods in document["paths"].values()
           for each in methods.values()]  # fmt: skip
    assert len(ids) == len(set(ids))


def test_no_answer_tells_where_the_data_lies(
    service: Server, client: httpx.Client, done: Done
) -> None:
    document = client.get("/v1/openapi.json").json()
    hidden = [str(service.data).encode(), str(service.folder).encode(), b"Traceback", b'File "']
    ids = {
        "programs": done.program, "jobs": done.simulation, "advice": done.advice,
        "simulations": done.simulation, "control-runs": done.control, "trials": done.trial,
        "evaluations": done.evaluation, "reviews": done.review,
    }  # fmt: skip
    looked = 0
    for path, methods in document["paths"].items():
        if "get" not in methods or path.endswith("/events"):
            continue
        id = ids.get(path.split("/")[2] if path.startswith("/v1/") else "", "")
        for name in (id, "0" * 26, "x"):
            filled = path.replace("{id}", name).replace("{number}", "1")
            filled = filled.replace("{name}", "vmc15").replace("{run}", "run-00001")
            filled = filled.replace("{workingstep}", "ROUGH THE FACE")
            answer = client.get(filled)
            assert answer.status_code < 500, (filled, answer.text)
            assert not [word for word in hidden if word in answer.content], filled
            looked += answer.status_code == 200
    assert looked > 40


def test_a_folder_that_cannot_be_used_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(Unavailable):
        application(Settings(data=str(tmp_path / "file" / "data")))


def test_a_process_gets_its_settings_from_the_one_that_started_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    monkeypatch.setenv(VARIABLE, "{}")
    monkeypatch.setattr(log_lines, "configure", told.append)
    monkeypatch.delenv("STEPNC_KB", raising=False)
    settings = Settings(data=str(tmp_path / "data"), upload_bytes=7, level="warning")
    settings.hand_on()
    with pytest.raises(Unavailable, match="not found in the data folder"):
        from_environment()
    assert not (tmp_path / "data").exists()
    open_data_folder(settings.root)
    assert told == ["warning"]
    assert from_environment().state.settings == settings
