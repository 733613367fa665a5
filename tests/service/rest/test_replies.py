"""Answers: tags that change with every byte, names of files that break no header."""

from pathlib import Path

import numpy as np
import pytest
from fastapi import Request
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.errors import NotFound
from service.rest.replies import (
    PROBLEM,
    file_reply,
    json_reply,
    matches,
    moment,
    problem_reply,
    report_reply,
    tag_of,
)


def request(**headers: str) -> Request:
    raw = [(name.replace("_", "-").encode(), text.encode()) for name, text in headers.items()]
    return Request({"type": "http", "method": "GET", "path": "/", "headers": raw})


def test_an_answer_has_a_tag_and_is_not_sent_twice() -> None:
    first = json_reply(request(), {"a": np.array([1.0, np.nan])})
    assert first.body == b'{"a":[1.0,null]}'
    tag = first.headers["etag"]
    again = json_reply(request(if_none_match=tag), {"a": [1.0, None]})
    assert (again.status_code, again.body, again.headers["etag"]) == (304, b"", tag)
    other = json_reply(request(if_none_match=tag), {"a": [2.0]})
    assert other.status_code == 200


@pytest.mark.parametrize(
    ("condition", "is_met"),
    [
        (None, False), ('"a"', True), ('W/"a"', True), ('"b", "a"', True), ("*", True),
        ('"b"', False), ("a", False), ("", False), (",,", False),
    ],
)  # fmt: skip
def test_conditions_of_rfc_9110(condition: str | None, is_met: bool) -> None:
    assert matches(condition, '"a"') is is_met


@given(st.binary(max_size=50), st.binary(max_size=50))
def test_tags_are_told_apart(one: bytes, other: bytes) -> None:
    assert (tag_of(one) == tag_of(other)) == (one == other)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=120))
def test_no_name_of_a_file_breaks_a_header(tmp_path: Path, name: str) -> None:
    file = tmp_path / "x"
    file.write_bytes(b"x")
    reply = file_reply(file, name=name, kind="text/plain", thing="file")
    told = reply.headers["content-disposition"]
    assert told.isascii()
    assert told.isprintable()
    assert told.count('"') == 2
    assert ";" not in told.split('"')[1]


def test_what_is_not_there_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        file_reply(tmp_path / "x", name="x", kind="text/plain", thing="file")
    with pytest.raises(NotFound):
        report_reply(tmp_path, id="x")


def test_a_report_may_reach_nothing(tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(b"x")
    policy = report_reply(tmp_path / "x", id="x").headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "sandbox" in policy
    assert "connect-src" not in policy
    assert "allow-same-origin" not in policy


def test_a_problem_has_a_type_of_its_own() -> None:
    reply = problem_reply({"status": 418, "title": "Teapot"})
    assert (reply.status_code, reply.media_type) == (418, PROBLEM)


def test_moments_are_in_utc() -> None:
    assert moment(0.5) == "1970-01-01T00:00:00.500+00:00"
    assert moment(None) is None
