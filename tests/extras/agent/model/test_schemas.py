"""Schemas that an agent serves, and the addresses that documents name."""

import socket
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest
from lxml import etree

from extras.agent.model.schemas import SchemaFiles, read_schemas
from simulator.errors import AgentError
from tests.extras.agent.model.conftest import (
    SCHEMAS,
    ServedAgent,
    error_codes,
    local,
    mill,
)

Serve = Callable[..., ServedAgent]
LOCATION = "{http://www.w3.org/2001/XMLSchema-instance}schemaLocation"
KINDS = {"/probe": "Devices", "/current": "Streams", "/assets": "Assets", "/nope": "Error"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a schema, and what else may lie in one."""
    inside = tmp_path / "schemas"
    (inside / "below.xsd").mkdir(parents=True)
    (inside / "MTConnectStreams_2.7_1.0.xsd").write_text("<streams/>", encoding="utf-8")
    (inside / "MTConnectAssets_2.7.xsd").write_text("<assets/>", encoding="utf-8")
    (inside / "MTConnectAssets_2.7_1.0.xsd").write_text("<old/>", encoding="utf-8")
    (inside / "notes.txt").write_text("notes", encoding="utf-8")
    (tmp_path / "secret.xsd").write_text("secret", encoding="utf-8")
    (inside / "link.xsd").symlink_to(tmp_path / "secret.xsd")
    return inside


def location(served: ServedAgent, path: str) -> str:
    root = etree.fromstring(served.get(path).content)
    space, address = str(root.attrib[LOCATION]).split(" ")
    assert space == etree.QName(root).namespace
    return str(address)


def with_schemas(served: ServedAgent, folder: Path) -> ServedAgent:
    served.agent.writer.schemas = read_schemas(folder)
    return served


@pytest.mark.parametrize("version", ["1.3", "2.0", "2.7"])
def test_documents_name_schemas_that_are_served_and_accept_them(
    serve: Serve, version: str, tmp_path: Path
) -> None:
    if not SCHEMAS.is_dir():
        pytest.skip(f"the schemas of MTConnect are not at {SCHEMAS.parent.name}/schemas")
    served = with_schemas(serve(mill(version)), SCHEMAS)
    (tmp_path / "xlink.xsd").write_bytes(served.get("/schemas/xlink.xsd").content)
    for path, kind in KINDS.items():
        address = location(served, path)
        assert address == f"/schemas/MTConnect{kind}_{version}_1.0.xsd"
        answer = served.get(address)
        assert (answer.status_code, answer.headers["content-type"]) == (200, "text/xml")
        file = tmp_path / address.rpartition("/")[2]
        file.write_bytes(answer.content)
        schema = etree.XMLSchema(etree.parse(str(file)))
        assert schema.validate(etree.fromstring(served.get(path).content)), schema.error_log


def test_without_a_folder_documents_name_the_official_schemas(serve: Serve) -> None:
    served = serve()
    for path, kind in KINDS.items():
        official = f"http://schemas.mtconnect.org/schemas/MTConnect{kind}_2.7.xsd"
        assert location(served, path) == official
    assert served.get("/schemas/MTConnectStreams_2.7.xsd").status_code == 404


def test_the_file_of_a_version_is_named_where_there_is_one(serve: Serve, folder: Path) -> None:
    served = with_schemas(serve(), folder)
    assert location(served, "/current") == "/schemas/MTConnectStreams_2.7_1.0.xsd"
    assert location(served, "/assets") == "/schemas/MTConnectAssets_2.7.xsd"
    assert location(served, "/probe").startswith("http://schemas.mtconnect.org/")


@pytest.mark.parametrize(
    "path",
    [
        "/schemas/notes.txt",
        "/schemas/below.xsd",
        "/schemas/link.xsd",
        "/schemas/absent.xsd",
        "/schemas/",
        "/schemas/../../secret.xsd",
        "/schemas/..%2Fsecret.xsd",
        "/schemas/%2e%2e/secret.xsd",
        "/MTConnectAssets_2.7.xsd",
    ],
)
def test_nothing_else_of_the_folder_is_served(serve: Serve, folder: Path, path: str) -> None:
    served = with_schemas(serve(), folder)
    host, _, port = served.url.removeprefix("http://").partition(":")
    # As it stands: clients would take the dots away.
    with socket.create_connection((host, int(port)), timeout=120.0) as connection:
        request = f"GET {path} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"
        connection.sendall(request.encode())
        answer = b"".join(iter(lambda: connection.recv(1 << 16), b""))
    head, _, body = answer.partition(b"\r\n\r\n")
    assert b" 404 " in head.splitlines()[0]
    assert b"secret<" not in body
    assert error_codes(etree.fromstring(body)) == ["NoDevice"]


def test_a_schema_is_served_to_head_without_its_text(serve: Serve, folder: Path) -> None:
    served = with_schemas(serve(), folder)
    answer = httpx.head(f"{served.url}/schemas/MTConnectAssets_2.7.xsd")
    assert (answer.status_code, answer.content) == (200, b"")
    assert local(etree.fromstring(served.get("/schemas/MTConnectAssets_2.7.xsd").content)) == (
        "assets"
    )


def test_a_folder_without_schemas_is_told(tmp_path: Path) -> None:
    with pytest.raises(AgentError, match=r"no files with the suffix \.xsd"):
        read_schemas(tmp_path)
    with pytest.raises(AgentError, match="cannot be read: No such file"):
        read_schemas(tmp_path / "absent")


def test_files_of_a_folder_are_bounded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("extras.agent.model.schemas.MOST_BYTES", 20)
    with pytest.raises(AgentError, match="more than 20 bytes of schemas"):
        read_schemas(folder)


def test_addresses_without_files_are_the_official_ones() -> None:
    assert SchemaFiles().location("Error", "1.3") == (
        "http://schemas.mtconnect.org/schemas/MTConnectError_1.3.xsd"
    )
