"""``/v1/machines`` and ``/v1/materials``: the library's stay, the shop's are the shop's."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import httpx
import pytest

from simulator.library import DATA
from tests.every_case import every_case
from tests.service.rest.server import Server, is_problem
from tests.service.storage.test_library import BAD

MACHINE = (DATA / "machines" / "vmc15.toml").read_bytes()
MATERIAL = (DATA / "materials" / "c45.toml").read_bytes()


@pytest.fixture(params=[("machines", MACHINE, "vmc15"), ("materials", MATERIAL, "c45")])
def section(
    request: pytest.FixtureRequest, client: httpx.Client
) -> Iterator[tuple[str, bytes, str]]:
    path, data, name = request.param
    yield f"/v1/{path}", data, name
    client.delete(f"/v1/{path}/ours-1")


def test_one_is_kept_shown_and_deleted(
    client: httpx.Client, section: tuple[str, bytes, str]
) -> None:
    path, data, of_library = section
    kept = client.put(f"{path}/ours-1", content=data)
    assert (kept.status_code, kept.json()["is_own"]) == (200, True)
    names = {each["name"]: each["is_own"] for each in client.get(path).json()}
    assert (names["ours-1"], names[of_library]) == (True, False)
    assert client.get(f"{path}/ours-1").json()["name"] == "ours-1"
    assert client.delete(f"{path}/ours-1").status_code == 204
    is_problem(client.get(f"{path}/ours-1"), 404)
    is_problem(client.delete(f"{path}/ours-1"), 404)


def test_who_has_seen_it_may_change_it_and_nobody_else(
    client: httpx.Client, section: tuple[str, bytes, str]
) -> None:
    path, data, _ = section
    for condition in ('"x"', "*"):
        answer = client.put(f"{path}/ours-1", content=data, headers={"if-match": condition})
        is_problem(answer, 412, "precondition-failed")
    put = client.put(f"{path}/ours-1", content=data)
    seen = client.get(f"{path}/ours-1").headers["etag"]
    assert seen == put.headers["etag"]
    changed = data.replace(b"\n", b"\n# changed\n", 1)
    first = client.put(f"{path}/ours-1", content=changed, headers={"if-match": seen})
    assert first.status_code == 200
    late = client.put(f"{path}/ours-1", content=data, headers={"if-match": seen})
    found = is_problem(late, 412, "precondition-failed")
    assert "has changed since it was read" in found["detail"]
    is_problem(client.delete(f"{path}/ours-1", headers={"if-match": seen}), 412)
    again = client.get(f"{path}/ours-1", headers={"if-none-match": first.headers["etag"]})
    assert again.status_code == 304
    tag = again.headers["etag"]
    assert client.delete(f"{path}/ours-1", headers={"if-match": tag}).status_code == 204


def test_of_many_who_saw_the_same_one_alone_changes_it(
    client: httpx.Client, section: tuple[str, bytes, str]
) -> None:
    path, data, _ = section
    seen = client.put(f"{path}/ours-1", content=data).headers["etag"]
    begin = Barrier(6)

    def put(number: int) -> int:
        begin.wait(120.0)
        text = data + f"\n# {number}".encode()
        headers = {"if-match": seen}
        return client.put(f"{path}/ours-1", content=text, headers=headers).status_code

    with ThreadPoolExecutor(6) as pool:
        assert sorted(pool.map(put, range(6))) == [200, *[412] * 5]


def test_one_that_is_broken_hides_no_other(
    service: Server, client: httpx.Client, section: tuple[str, bytes, str]
) -> None:
    path, _, of_library = section
    folder = service.data / path.removeprefix("/v1/")
    (folder / "ours-1.toml").write_text("[[[[", encoding="utf-8")
    found = {each["name"]: each["problem"] for each in client.get(path).json()}
    assert found[of_library] is None
    assert found["ours-1"].startswith("ours-1.toml: ")
    is_problem(client.get(f"{path}/ours-1"), 422)


def test_those_of_the_library_stay(
    client: httpx.Client, section: tuple[str, bytes, str]
) -> None:
    path, data, name = section
    is_problem(client.put(f"{path}/{name}", content=data), 409)
    is_problem(client.delete(f"{path}/{name}"), 409)


@every_case(
    "name", ["..%2fx", "%2fetc%2fpasswd", "x.toml", "x%00", "X", "a%20b", "x%0a", "%2e%2e", "é"]
)
def test_a_name_that_could_be_a_path_is_refused(
    client: httpx.Client, section: tuple[str, bytes, str], name: str
) -> None:
    path, data, _ = section
    for answer in (
        client.put(f"{path}/{name}", content=data),
        client.get(f"{path}/{name}"),
        client.delete(f"{path}/{name}"),
    ):
        is_problem(answer, answer.status_code)
        assert answer.status_code in {404, 405, 422}


@every_case("name", [name for name in BAD if name != "deep tables"])
def test_a_bad_file_is_refused_without_a_word_of_folders(
    client: httpx.Client, section: tuple[str, bytes, str], name: str
) -> None:
    path, _, _ = section
    answer = client.put(f"{path}/ours-1", content=BAD[name])
    is_problem(answer, answer.status_code)
    assert answer.status_code in {413, 422}
    assert "/tmp" not in answer.text
    is_problem(client.get(f"{path}/ours-1"), 404)


def test_an_empty_file_is_refused(client: httpx.Client) -> None:
    is_problem(client.put("/v1/machines/ours-1", content=b""), 400)
