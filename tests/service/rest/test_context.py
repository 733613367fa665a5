"""What tells one request from another."""

from dataclasses import replace

import pytest
from fastapi import Request

from service.errors import Unreadable
from service.rest.access import ANYBODY
from service.rest.context import PROBLEMS, cursor_of, idempotency_of
from service.storage.jobs import LOCAL


def request(path: str = "/v1/programs", query: str = "", owner: str = "anna") -> Request:
    return Request({
        "type": "http", "method": "POST", "path": path, "query_string": query.encode(),
        "headers": [(b"host", b"x")], "state": {"key": replace(ANYBODY, name=owner)},
        "server": ("x", 80), "scheme": "http",
    })  # fmt: skip


def test_a_request_without_a_key_may_be_repeated() -> None:
    assert idempotency_of(request(), None, b"") is None


def test_an_empty_key_is_refused() -> None:
    for key in ("", " ", "\t"):
        with pytest.raises(Unreadable, match="Idempotency-Key"):
            idempotency_of(request(), key, b"")


def test_path_query_and_body_make_another_request() -> None:
    prints = [
        idempotency_of(one, "k", body)
        for one, body in (
            (request(), b""), (request(), b"x"), (request(query="name=a"), b""),
            (request("/v1/simulations"), b""),
        )
    ]  # fmt: skip
    assert len({each.fingerprint for each in prints if each}) == 4
    assert idempotency_of(request(), "k", b"x") == idempotency_of(request(), "k", b"x")
    other = idempotency_of(request(owner="bert"), "k", b"")
    assert other is not None
    assert other.owner == "bert"


def test_problems_are_documented_by_their_content_type() -> None:
    assert {401, 403, 404, 409, 412, 413, 422, 429, 503, 507} <= set(PROBLEMS)
    for each in PROBLEMS.values():
        assert "application/problem+json" in each["content"]


def test_a_place_is_the_first_page_without_a_cursor() -> None:
    assert cursor_of(limit=3, cursor=None).limit == 3
    with pytest.raises(Unreadable):
        cursor_of(limit=3, cursor="/etc/passwd")


def test_who_needs_no_key_has_the_whole_queue() -> None:
    assert ANYBODY.name == LOCAL


def test_a_key_is_told_apart_from_another_of_its_name() -> None:
    one, two = request(), request()
    one.state.key, two.state.key = (replace(ANYBODY, name="anna", id=id) for id in "xy")
    first, second = idempotency_of(one, "k", b""), idempotency_of(two, "k", b"")
    assert first is not None
    assert second is not None
    assert (first.owner, second.owner) == ("x", "y")
