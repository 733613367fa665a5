"""Answers: tags that change with every byte, names of files that break no header."""

import asyncio
import os
from pathlib import Path

import numpy as np
import pytest
from fastapi import Request, Response
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from starlette.types import Message, Send

from service.errors import NotFound
from service.rest.replies import (
    PART,
    PROBLEM,
    FileReply,
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


def opened(asked: Request, file: Path, **more: str) -> Response:
    return file_reply(asked, file, name="x", kind="text/plain", thing="file", **more)


def close(reply: Response) -> None:
    """What the server does when it has sent it."""
    assert isinstance(reply, FileReply)
    reply.file.close()


def sent(reply: Response, send: Send) -> None:
    async def receive() -> Message:
        return {"type": "http.disconnect"}

    asyncio.run(reply({"type": "http"}, receive, send))


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
    reply = file_reply(request(), file, name=name, kind="text/plain", thing="file")
    close(reply)
    told = reply.headers["content-disposition"]
    assert told.isascii()
    assert told.isprintable()
    assert told.count('"') == 2
    assert ";" not in told.split('"')[1]


def test_what_is_not_there_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFound):
        file_reply(request(), tmp_path / "x", name="x", kind="text/plain", thing="file")
    with pytest.raises(NotFound):
        report_reply(request(), tmp_path, id="x")


def test_a_file_that_is_deleted_while_it_is_sent_comes_whole(tmp_path: Path) -> None:
    content = bytes(range(256)) * 4096
    file = tmp_path / "x"
    file.write_bytes(content)
    reply = opened(request(), file)
    assert isinstance(reply, FileReply)
    parts: list[bytes] = []

    async def send(message: Message) -> None:
        file.unlink(missing_ok=True)
        parts.append(message.get("body", b""))

    sent(reply, send)
    assert b"".join(parts) == content
    assert reply.headers["content-length"] == str(len(content))
    assert reply.file.closed


def test_an_empty_file_is_an_answer(tmp_path: Path) -> None:
    (tmp_path / "x").touch()
    messages: list[Message] = []

    async def send(message: Message) -> None:
        messages.append(message)

    reply = opened(request(), tmp_path / "x")
    sent(reply, send)
    assert reply.headers["content-length"] == "0"
    assert [message.get("body") for message in messages] == [None, b""]


def test_a_file_is_closed_when_the_client_leaves_or_it_becomes_shorter(tmp_path: Path) -> None:
    file = tmp_path / "x"

    async def leave(_: Message) -> None:
        raise ConnectionError("gone")

    async def cut(_: Message) -> None:
        os.truncate(file, 10)

    for send, words in ((leave, "gone"), (cut, "lost")):
        file.write_bytes(b"x" * 2 * PART)
        reply = opened(request(), file)
        assert isinstance(reply, FileReply)
        with pytest.raises(OSError, match=words):
            sent(reply, send)
        assert reply.file.closed


def test_a_file_that_the_client_has_is_not_sent_again(tmp_path: Path) -> None:
    file = tmp_path / "x"
    file.write_bytes(b"x")
    reply = opened(request(), file)
    close(reply)
    tag = reply.headers["etag"]
    assert opened(request(if_none_match=tag), file).status_code == 304
    file.unlink()
    file.write_bytes(b"xy")
    other = opened(request(if_none_match=tag), file)
    close(other)
    assert other.status_code == 200
    known = opened(request(if_none_match='"t"'), file, tag='"t"')
    assert (known.status_code, known.headers["etag"]) == (304, '"t"')


def test_a_report_may_reach_nothing(tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(b"x")
    reply = report_reply(request(), tmp_path / "x", id="x")
    close(reply)
    policy = reply.headers["content-security-policy"]
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
