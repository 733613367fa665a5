"""NC code over REST: recognised by its content, checked, and rewritten with other feeds."""

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass

import httpx
import pytest

from service.rest.advice_views import AdviceView, CodeAdviceView, CodeContentsView, CurvesView
from tests.every_case import every_case
from tests.service.rest.conftest import Done
from tests.service.rest.samples import CODE, CODE_STOCK, CODE_TOOLS, SAMPLE
from tests.service.rest.server import Server, is_problem, made, over

POINTS = 2000
"""Greatest number of points of a curve."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeDone:
    """NC code, its tool table, and an advice on it."""

    program: str
    tools: str
    advice: str
    wish: dict[str, object]


@pytest.fixture(scope="module")
def code(service: Server) -> Iterator[CodeDone]:
    with service.client() as client:
        program = made(client.post("/v1/programs?name=plate.NC", content=CODE), 201)
        path = "/v1/files?kind=tools&name=plate.csv"
        tools = made(client.post(path, content=CODE_TOOLS), 201)
        wish: dict[str, object] = {
            "tools_id": tools, "stock": CODE_STOCK, "material": "c45", "machine": "vmc15",
            "is_marked": True,
        }  # fmt: skip
        advice = made(client.post(f"/v1/programs/{program}/advice", json=wish))
        job = over(client, advice, within=120.0)
        assert job["state"] == "succeeded", job
        yield CodeDone(program=program, tools=tools, advice=advice, wish=wish)


def test_code_is_recognised_by_its_content(client: httpx.Client, code: CodeDone) -> None:
    assert client.get(f"/v1/programs/{code.program}").json()["kind"] == "nc-code"
    file = client.get(f"/v1/programs/{code.program}/file")
    assert (file.content, file.headers["content-type"]) == (CODE, "text/plain; charset=utf-8")
    other = client.post("/v1/programs?name=part.nc", content=SAMPLE.read_bytes()).json()
    assert other["kind"] == "step-nc"


def test_code_shows_its_check(client: httpx.Client, code: CodeDone) -> None:
    found = client.get(f"/v1/programs/{code.program}/findings").json()
    contents = CodeContentsView.model_validate(found)
    assert (contents.program, contents.units, contents.is_lossless) == ("plate.NC", "mm", True)
    assert {(row.tool, row.kind) for row in contents.moves} >= {(1, "line"), (1, "rapid")}
    assert (contents.control, contents.machine) == ("fanuc", "mill")


def test_code_comes_back_with_its_name_and_other_feeds(
    client: httpx.Client, code: CodeDone
) -> None:
    result = client.get(f"/v1/advice/{code.advice}").json()
    view = CodeAdviceView.model_validate(result)
    assert (view.program, view.machine, view.nc_control) == ("plate.NC", "vmc15", view.control)
    assert 0.0 < (view.along_path.time_s.after or 0.0) < (view.along_path.time_s.before or 0.0)
    assert sum(view.along_path.active_limits.values()) == pytest.approx(1.0)
    rewritten = client.get(f"/v1/advice/{code.advice}/nc")
    assert 'filename="plate.optimised.NC"' in rewritten.headers["content-disposition"]
    assert rewritten.content != CODE
    assert b"T1 M6" in rewritten.content
    report = client.get(f"/v1/advice/{code.advice}/report")
    assert "<h1>plate.NC</h1>" in report.text
    is_problem(client.get(f"/v1/advice/{code.advice}/file"), 404, "not-found")
    is_problem(client.get(f"/v1/advice/{code.advice}/workingsteps/T1"), 404, "not-found")


def test_feeds_and_curves_are_given_in_bounds(client: httpx.Client, code: CodeDone) -> None:
    table = client.get(f"/v1/advice/{code.advice}/feeds")
    assert "plate.feeds.csv" in table.headers["content-disposition"]
    rows = list(csv.DictReader(io.StringIO(table.text)))
    blocks = client.get(f"/v1/advice/{code.advice}").json()["along_path"]["blocks"]
    assert len({row["block"] for row in rows}) == blocks
    assert {row["unit"] for row in rows} == {"mm/min"}
    answer = client.get(f"/v1/advice/{code.advice}/curves")
    curves = CurvesView.model_validate(answer.json())
    for pair in (curves.length_mm, curves.time_s):
        for run in (pair.before, pair.after):
            assert 0 < 2 * len(run.begin) <= POINTS
            assert {len(run.end), *(len(each.low) for each in run.signals.values())} == {
                len(run.begin)
            }
    assert max(curves.limits.limit) < len(curves.limits.names)
    again = client.get(
        f"/v1/advice/{code.advice}/curves",
        headers={"if-none-match": answer.headers["etag"]},
    )
    assert again.status_code == 304


@every_case(
    ("change", "detail"),
    [
        ({"tools_id": None}, "missing: tools_id"),
        ({"stock": "", "material": ""}, "missing: stock, material: material"),
        ({"material": ""}, "missing: material: material (`stepnc materials`)"),
        ({"stock": "/etc/passwd"}, "stock '/etc/passwd'"),
        ({"stock": "part.stl"}, "stock 'part.stl': expected 2, 3, 5 or 6 numbers"),
        ({"finish": ["mill"]}, "tool 'mill'"),
        ({"dialect": "canonical"}, "canonical"),
        ({"machine": "none"}, "none"),
    ],
)
def test_advice_on_code_is_refused_before_there_is_a_job(
    client: httpx.Client, code: CodeDone, change: dict[str, object], detail: str
) -> None:
    answer = client.post(f"/v1/programs/{code.program}/advice", json={**code.wish, **change})
    assert detail in is_problem(answer, 422)["detail"]


def test_code_that_tells_tools_and_stock_needs_neither(client: httpx.Client) -> None:
    told = b"(T1 D=10. - FLAT END MILL)\n"
    program = made(client.post("/v1/programs?name=told.NC", content=told + CODE), 201)
    wish = {"material": "c45", "machine": "vmc15"}
    job = made(client.post(f"/v1/programs/{program}/advice", json=wish))
    assert over(client, job, within=120.0)["state"] == "succeeded"
    findings = str(client.get(f"/v1/advice/{job}").json()["findings"])
    assert "no stock is given: a box around the cutting moves is taken" in findings


def test_a_table_without_the_tool_is_told(client: httpx.Client, code: CodeDone) -> None:
    other = CODE_TOOLS.replace(b"\n1,", b"\n9,")
    tools = made(client.post("/v1/files?kind=tools&name=o.csv", content=other), 201)
    wish = {**code.wish, "tools_id": tools}
    job = made(client.post(f"/v1/programs/{code.program}/advice", json=wish))
    ended = over(client, job, within=120.0)
    assert ended["state"] == "succeeded"
    result = client.get(f"/v1/advice/{job}").json()
    assert result["along_path"]["blocks"] == 0
    assert "the tool is not in the tool table" in str(result["findings"])


def test_a_program_of_the_wrong_kind_is_refused_in_words(
    service: Server, client: httpx.Client, code: CodeDone, done: Done
) -> None:
    run = {"program_id": code.program}
    shop = {
        "machine": [{"name": "mill", "machine": "vmc15"}],
        "product": [{"name": "a", "step": [{"machines": ["mill"], "program": code.program}]}],
    }
    for path, body in (
        ("/v1/simulations", run),
        ("/v1/control-runs", run),
        ("/v1/cycle-times", run),
        ("/v1/verifications", {**run, "log_id": done.file}),
        ("/v1/simulations", {"advice_id": code.advice}),
        ("/v1/factories", {"shop": shop}),
    ):
        found = is_problem(client.post(path, json=body), 422)
        words = "program 'plate.NC' is NC code; this needs a STEP-NC program"
        assert words in found["detail"], path
    assert service.faults() == ""


def test_a_step_nc_program_gets_feeds_along_its_paths(client: httpx.Client, done: Done) -> None:
    wish = {
        "machine": "vmc15", "is_along_path": True, "levels": 3, "nc_control": "linuxcnc",
        "max_feed_mm_min": 5000.0, "smooth_share": 0.05,
    }  # fmt: skip
    path = f"/v1/programs/{done.program}/advice"
    id = made(client.post(path, json=wish))
    assert over(client, id, within=120.0)["state"] == "succeeded"
    view = AdviceView.model_validate(client.get(f"/v1/advice/{id}").json())
    assert view.along_path is not None
    assert [part.id for part in view.along_path.parts if part.feeds] == ["ROUGH THE FACE"]
    smoothest = view.along_path.free_profile.smoothest
    assert smoothest is not None
    assert smoothest.fastest_time_s < smoothest.time_s <= 1.05 * smoothest.fastest_time_s
    assert smoothest.unevenness_ratio < 1.0
    assert all((part.feeds or 0) <= 3 for part in view.along_path.parts)
    assert client.get(f"/v1/advice/{id}/feeds").text.startswith("block,part,")
    CurvesView.model_validate(client.get(f"/v1/advice/{id}/curves").json())
    assert "Along the paths" in client.get(f"/v1/advice/{id}/report").text
    code = client.get(f"/v1/advice/{id}/nc").text
    feeds = {float(word) for word in re.findall(r"(?<=\bF)[0-9.]+", code)}
    assert max(feeds) == 5000.0
    assert len(feeds) > 1


def test_advice_without_feeds_along_the_path_has_none(client: httpx.Client, done: Done) -> None:
    assert client.get(f"/v1/advice/{done.advice}").json().get("along_path") is None
    for path in ("feeds", "curves"):
        found = is_problem(client.get(f"/v1/advice/{done.advice}/{path}"), 404, "not-found")
        assert "is_along_path" in found["detail"]
    of_paths = (("levels", 3), ("smooth_share", 0.1), ("max_feed_mm_min", 900.0))
    for name, value in of_paths:
        answer = client.post(f"/v1/programs/{done.program}/advice", json={name: value})
        words = f"{name} has no effect without is_along_path"
        assert words in is_problem(answer, 422)["detail"]


def test_fields_of_nc_code_are_refused_with_a_step_nc_program(
    client: httpx.Client, done: Done
) -> None:
    for name, value in (("greatest_rise", 2.0), ("keep", ["T1"])):
        answer = client.post(f"/v1/programs/{done.program}/advice", json={name: value})
        words = f"{name} cannot be used with a STEP-NC program: "
        assert words in is_problem(answer, 422)["detail"]


@pytest.mark.parametrize(
    ("name", "body", "status"),
    [
        ("t.tbl", b"T1 P1 D10 ;end mill\n", 201),
        ("t.csv", CODE_TOOLS, 201),
        ("t.json", b'{"tools": [{"nr": 1, "path": "x.fctb"}]}', 422),
        ("t.fctl", b"{}", 400),
    ],
)
def test_tool_tables_of_other_formats_are_taken(
    client: httpx.Client, name: str, body: bytes, status: int
) -> None:
    answer = client.post("/v1/files", params={"kind": "tools", "name": name}, content=body)
    assert answer.status_code == status, answer.text
