"""The dashboard's files: whole, tagged, from here alone."""

import gzip

import httpx
import pytest

from service.rest.pages import KINDS, files
from tests.service.rest.server import is_problem


def test_the_first_page_is_the_planners(client: httpx.Client) -> None:
    first = client.get("/")
    assert (first.status_code, first.headers["location"]) == (307, "/dashboard/plan.html")
    assert client.get("/favicon.ico").headers["location"] == "/dashboard/icon.svg"


def test_every_file_is_served_as_what_it_is(client: httpx.Client) -> None:
    assert files()
    for name, path in files().items():
        answer = client.get(f"/dashboard/{name}")
        assert answer.status_code == 200, name
        assert answer.headers["content-type"] == KINDS[path.suffix]
        tag = answer.headers["etag"]
        again = client.get(f"/dashboard/{name}", headers={"if-none-match": tag})
        assert (again.status_code, again.content) == (304, b"")


def test_plotly_comes_from_the_installed_package(client: httpx.Client) -> None:
    packed = client.get("/dashboard/plotly.min.js", headers={"accept-encoding": "gzip"})
    plain = client.get("/dashboard/plotly.min.js", headers={"accept-encoding": "identity"})
    assert packed.headers["content-encoding"] == "gzip"
    assert "content-encoding" not in plain.headers
    assert packed.content == plain.content
    assert len(gzip.compress(plain.content, 1)) > 100_000
    tag = plain.headers["etag"]
    again = client.get("/dashboard/plotly.min.js", headers={"if-none-match": tag})
    assert again.status_code == 304


@pytest.mark.parametrize(
    "name", ["../settings.py", "%2e%2e%2fsettings.py", "none.html", "plan.html%00", "app.py"]
)
def test_nothing_else_is_a_page(client: httpx.Client, name: str) -> None:
    is_problem(client.get(f"/dashboard/{name}"), 404)


def test_the_manual_comes_from_the_service(client: httpx.Client) -> None:
    page = client.get("/manual/index.html")
    assert page.status_code == 200
    assert page.headers["content-type"] in {KINDS[".html"], "text/plain; charset=utf-8"}
    assert client.get("/manual/service.md").text.startswith("#")


@pytest.mark.parametrize(
    "name", ["../pyproject.toml", "%2e%2e/pyproject.toml", "hooks/site.py", "none.html", ""]
)
def test_nothing_else_is_in_the_manual(client: httpx.Client, name: str) -> None:
    is_problem(client.get(f"/manual/{name}"), 404)
