"""The OpenAPI document against the real server: what it promises is what comes."""

from collections.abc import Iterator
from typing import Any

import httpx
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from schemathesis.checks import not_a_server_error
from schemathesis.core.result import Ok
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from simulator.library import DATA
from tests.service.rest.conftest import Done, id_of
from tests.service.rest.server import Server

CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]

EXAMPLES = 15
"""requests to each operation"""

MACHINE = (DATA / "machines" / "vmc15.toml").read_text(encoding="utf-8")

schemathesis.openapi.media_type(
    "application/toml", st.one_of(st.text(), st.just(MACHINE)).map(str.encode)
)


@schemathesis.serializer("application/toml")
def toml(_: object, value: Any) -> bytes:
    """A TOML file goes as it is."""
    return value if isinstance(value, bytes) else str(value).encode(errors="replace")


def operations(document: dict[str, Any]) -> Iterator[Any]:
    """All but streams, which end when their run ends."""
    schema = schemathesis.openapi.from_dict(document)
    for found in schema.get_all_operations():
        assert isinstance(found, Ok)
        operation = found.ok()
        if not operation.path.endswith("/events"):
            yield operation


def faults_of(operation: Any, service: Server, done: Done) -> str:
    """What an operation does that the document does not say."""

    @settings(
        max_examples=EXAMPLES,
        derandomize=True,
        database=None,
        deadline=None,
        phases=[Phase.explicit, Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(case=operation.as_strategy(), is_known=st.booleans())
    def asked(case: Any, is_known: bool) -> None:
        if is_known and case.method == "GET" and "{id}" in operation.path:
            case.path_parameters["id"] = id_of(done, operation.path)
        answer = case.call(base_url=service.url, timeout=90.0)
        if answer.status_code == 202 and "id" in answer.json():
            with service.client() as client:
                client.post(f"/v1/jobs/{answer.json()['id']}/cancel")
        case.validate_response(answer, checks=CHECKS)

    try:
        asked()
    except Exception as error:
        inner = getattr(error, "exceptions", [error])
        return f"{operation.label}: " + "; ".join(str(each) for each in inner)
    return ""


def test_the_server_does_what_the_document_says(
    service: Server, client: httpx.Client, done: Done
) -> None:
    document = client.get("/v1/openapi.json").json()
    found = list(operations(document))
    assert len(found) > 50
    faults = [faults_of(operation, service, done) for operation in found]
    assert not any(faults), "\n\n".join(fault for fault in faults if fault)
