"""Raw parts over REST: uploaded once, named by advice and verification, read in the job."""

from pathlib import Path

import httpx
import numpy as np
import pytest

from tests.extras.brep.shapes import block, without, write_step
from tests.extras.verification.files import write_log, write_stl
from tests.extras.verification.model import test_required_part as test_required
from tests.extras.verification.model.box import box
from tests.extras.verification.test_without_program import MILL, POCKET, pocket_inputs
from tests.service.rest.samples import CODE, CODE_STOCK, CODE_TOOLS, SLOT
from tests.service.rest.server import is_problem, made, over

NOBODY = "0" * 26


def uploaded(client: httpx.Client, path: Path, kind: str) -> str:
    answer = client.post(f"/v1/files?kind={kind}&name={path.name}", content=path.read_bytes())
    return made(answer, 201)


def test_a_solid_is_the_stock_of_a_program(client: httpx.Client, tmp_path: Path) -> None:
    """The second solid of a file, which has half of the slot already."""
    plate = block((0.0, 0.0, -12.7), (101.6, 101.6, 0.0))
    half = without(plate, block((-1.0, 46.8, -6.0), (50.8, 54.8, 1.0)))
    stock = uploaded(client, write_step(tmp_path / "raw.step", plate, half), "stock")
    text = SLOT.read_text("utf-8").replace("0.1,$,$,#13,", "0.1,$,$,$,").encode()
    program = made(client.post("/v1/programs?name=slot.stpnc", content=text), 201)
    path, wish = f"/v1/programs/{program}/advice", {"machine": "paper003", "stock_id": stock}
    wish["material"] = "aisi1018"
    job = over(client, made(client.post(path, json=wish)), within=120.0)
    assert job["state"] == "failed"
    told = job["problem"]["detail"]
    assert told.startswith("raw.step: 2 solids: choose one by its place or name")
    job = over(client, made(client.post(path, json={**wish, "stock_solid": "2"})), within=120.0)
    assert job["state"] == "succeeded", job
    found = client.get(f"/v1/advice/{job['id']}").json()
    [told] = [each["message"] for each in found["findings"] if "is a body" in each["message"]]
    assert told.endswith(
        "tool paths are made for the box around it, 0,0,-12.7 to 101.6,101.6,0 mm"
    )
    for wrong, status in (
        ({"stock": CODE_STOCK}, 400),
        ({"stock_id": NOBODY}, 404),
        ({"stock_id": None, "stock_solid": "1"}, 400),
        ({"stock_id": None, "stock": "raw.step"}, 422),
    ):
        is_problem(client.post(path, json={**wish, **wrong}), status)


def test_a_mesh_is_the_stock_of_nc_code(client: httpx.Client, tmp_path: Path) -> None:
    mesh = write_stl(tmp_path / "raw.stl", box((0.0, 0.0, -20.0), (100.0, 50.0, 0.0)))
    program = made(client.post("/v1/programs?name=plate.NC", content=CODE), 201)
    tools = made(client.post("/v1/files?kind=tools&name=t.csv", content=CODE_TOOLS), 201)
    wish = {"tools_id": tools, "material": "c45", "machine": "vmc15"}
    times = []
    for stock in ({"stock": CODE_STOCK}, {"stock_id": uploaded(client, mesh, "stock")}):
        path = f"/v1/programs/{program}/advice"
        job = over(client, made(client.post(path, json={**wish, **stock})), within=120.0)
        assert job["state"] == "succeeded", job
        found = client.get(f"/v1/advice/{job['id']}").json()
        times.append(found["along_path"]["time_s"]["after"])
    assert times[1] == pytest.approx(times[0], rel=0.02)


def test_a_casting_is_the_stock_of_a_verification(client: httpx.Client, tmp_path: Path) -> None:
    given = pocket_inputs(tmp_path)
    assert given.tools is not None
    assert given.required is not None
    cast = write_stl(tmp_path / "cast.stl", test_required.HALF_CAST)
    body = {
        "log_id": uploaded(client, write_log(tmp_path / "log.csv", POCKET), "log"),
        "tools_id": uploaded(client, given.tools, "tools"),
        "required_id": uploaded(client, given.required, "required-part"),
        "stock_id": uploaded(client, cast, "stock"),
        "machine": MILL.machine,
        "cell_mm": MILL.cell_mm,
    }
    job = over(client, made(client.post("/v1/verifications", json=body)))
    assert job["state"] == "succeeded", job
    found = client.get(f"/v1/verifications/{job['id']}").json()
    assert not found["has_errors"]
    half = 12.0 * 16.0 * 5.0 - 0.5 * (4.0 - np.pi) * 9.0 * 5.0
    assert found["volumes"]["logged_mm3"] == pytest.approx(half, rel=0.01)
    less = {key: value for key, value in body.items() if key != "stock_id"}
    refused = is_problem(client.post("/v1/verifications", json=less), 400, "unreadable")
    assert "stock" in refused["detail"]
