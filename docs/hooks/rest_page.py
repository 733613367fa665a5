"""The page of the REST interface, from its OpenAPI document (3.1)."""

import json
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from importlib import import_module
from importlib.util import find_spec
from typing import Any, TypeAlias

from docs.hooks.markdown import block, code, page, table

APPLICATION = "service.rest.app"
"""module with a function ``openapi() -> dict``; without it there is no page"""

METHODS = ("get", "post", "put", "patch", "delete", "head", "options")
SERVER = "http://127.0.0.1:8000"
"""where curl goes when the document names no server"""

JsonObject: TypeAlias = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """One row of a body: a field, or a field of a field."""

    name: str
    kind: str
    is_required: bool
    meaning: str


def openapi_document() -> JsonObject | None:
    """The document of the service; None where there is no service."""
    try:
        if find_spec(APPLICATION) is None:
            return None
    except ModuleNotFoundError:
        return None
    describe = getattr(import_module(APPLICATION), "openapi", None)
    return None if describe is None else describe()


def rest_page(document: JsonObject) -> str:
    """The whole page."""
    info = document.get("info", {})
    parts = [info.get("description", ""), "## Routes", _overview(document)]
    shared = shared_answers(document)
    if shared:
        parts += ["## Answers of every route", _answers(document, shared)]
    for path, method, operation in operations(document):
        own = {
            status: answer
            for status, answer in operation["responses"].items()
            if status not in shared
        }
        parts += _section(document, path, method, {**operation, "responses": own})
    return page(f"REST: {info['title']}" if "title" in info else "REST", parts)


def operations(document: JsonObject) -> Iterator[tuple[str, str, JsonObject]]:
    """Path, method and what they do, in the order of the document."""
    for path, item in document.get("paths", {}).items():
        shared = item.get("parameters", [])
        for method in METHODS:
            if method in item:
                own = item[method]
                yield path, method, {**own, "parameters": shared + own.get("parameters", [])}


def shared_answers(document: JsonObject) -> dict[str, JsonObject]:
    """Refusals that all routes, if there are several, give in the same words."""
    all_answers = [each["responses"] for _, _, each in operations(document)]
    if len(all_answers) < 2:
        return {}
    first, *others = all_answers
    return {
        status: answer
        for status, answer in first.items()
        if not status.startswith("2") and all(each.get(status) == answer for each in others)
    }


def anchor(path: str, method: str) -> str:
    """Anchor of a route's section."""
    words = "".join(each if each.isalnum() else "-" for each in path).strip("-")
    return f"{method}-{words}".rstrip("-")


def fields(document: JsonObject, schema: JsonObject) -> Iterator[Field]:
    """Fields of a body, those of objects in it behind a dot, of lists behind ``[]``."""
    yield from _fields(document, schema, "", seen=())


def example_of(document: JsonObject, schema: JsonObject) -> Any:
    """An example: what the schema says, else one value of each field that must be there."""
    return _example(document, schema, seen=())


def _overview(document: JsonObject) -> str:
    return table(
        ("method", "path", "what it does"),
        (
            (
                method.upper(),
                f"[`{path}`](#{anchor(path, method)})",
                operation.get("summary", ""),
            )
            for path, method, operation in operations(document)
        ),
    )


def _section(
    document: JsonObject, path: str, method: str, operation: JsonObject
) -> Iterator[str]:
    yield f"## {method.upper()} {path} {{#{anchor(path, method)}}}"
    summary, description = operation.get("summary", ""), operation.get("description", "")
    yield f"{summary.rstrip('.')}." if summary else ""
    yield description if description != summary else ""
    yield (
        f"Needs a key of the role {code(operation['x-role'])}, where keys are asked for."
        if ("x-role" in operation)
        else ""
    )
    rows = [_parameter(document, each) for each in operation["parameters"]]
    if rows:
        yield table(("parameter", "in", "type", "meaning"), rows)
    yield from _request(document, operation)
    yield "**Example**"
    yield block(curl(document, path, method, operation), "sh")
    yield "**Answers**"
    yield from _responses(document, operation)


def _parameter(document: JsonObject, parameter: JsonObject) -> tuple[str, str, str, str]:
    each = _resolved(document, parameter)
    schema = each.get("schema", {})
    meaning = each.get("description") or _resolved(document, schema).get("description", "")
    return (
        code(each["name"]) + (", required" if each.get("required") else ""),
        each["in"],
        _kind(document, schema),
        _joined(meaning, _bounds(_resolved(document, schema))),
    )


def _request(document: JsonObject, operation: JsonObject) -> Iterator[str]:
    body = _resolved(document, operation.get("requestBody", {}))
    for media, content in body.get("content", {}).items():
        yield f"**Body**, `{media}`" + ("" if body.get("required") else ", may be left out")
        yield body.get("description", "")
        yield from _field_table(document, content.get("schema", {}))


def _answers(document: JsonObject, answers: Mapping[str, JsonObject]) -> str:
    """Table of statuses."""
    rows = []
    for status, each in answers.items():
        answer = _resolved(document, each)
        bodies = ", ".join(map(code, answer.get("content", {}))) or "none"
        rows.append((_status(status), answer.get("description", ""), bodies))
    return table(("status", "meaning", "body"), rows)


def _responses(document: JsonObject, operation: JsonObject) -> Iterator[str]:
    answers = operation["responses"]
    yield _answers(document, answers)
    for status, each in answers.items():
        for media, content in _resolved(document, each).get("content", {}).items():
            if status.startswith("2") and content.get("schema"):
                yield f"Body of {status}, `{media}`:"
                yield from _field_table(document, content["schema"])
                example = _given(content)
                if example is not None:
                    yield _json(example)


def _field_table(document: JsonObject, schema: JsonObject) -> Iterator[str]:
    rows = [
        (code(each.name) + (", required" if each.is_required else ""), each.kind, each.meaning)
        for each in fields(document, schema)
    ]
    if rows:
        yield table(("field", "type", "meaning"), rows)
    elif schema:
        yield f"{_kind(document, schema)}. {_resolved(document, schema).get('description', '')}"


def curl(document: JsonObject, path: str, method: str, operation: JsonObject) -> str:
    """A call of the route, as typed in a shell."""
    servers = document.get("servers") or [{"url": SERVER}]
    server = servers[0]["url"] if "://" in servers[0]["url"] else SERVER + servers[0]["url"]
    query: list[str] = []
    headers: list[str] = []
    for parameter in operation["parameters"]:
        each = _resolved(document, parameter)
        value = _parameter_value(document, each)
        match each["in"]:
            case "path":
                path = path.replace("{" + each["name"] + "}", value)
            case "query" if each.get("required"):
                query.append(f"{each['name']}={value}")
            case "header" if each.get("required"):
                headers.append(f"{each['name']}: {value}")
    address = server.rstrip("/") + path + ("?" + "&".join(query) if query else "")
    words = ["curl"] if method == "get" else ["curl", "-X", method.upper()]
    words.append(shlex.quote(address))
    if operation.get("security", document.get("security")):
        headers.append(_credentials(document))
    for header in headers:
        words += ["-H", shlex.quote(header)]
    return " ".join(words + list(_sent(document, operation)))


def _credentials(document: JsonObject) -> str:
    """The header that carries a key, by the first scheme of the document."""
    schemes = document.get("components", {}).get("securitySchemes", {})
    first: JsonObject = next(iter(schemes.values()), {})
    if first.get("type") == "apiKey" and first.get("in") == "header":
        return f"{first['name']}: KEY"
    return "Authorization: Bearer KEY"


def _sent(document: JsonObject, operation: JsonObject) -> Iterator[str]:
    """Words of curl for the body."""
    body = _resolved(document, operation.get("requestBody", {}))
    for media, content in list(body.get("content", {}).items())[:1]:
        schema = content.get("schema", {})
        if media == "multipart/form-data":
            required = _resolved(document, schema).get("required", [])
            for name in required:
                each = _resolved(document, schema)["properties"][name]
                value = "@FILE" if _is_file(each) else str(example_of(document, each))
                yield f"-F {shlex.quote(f'{name}={value}')}"
            return
        yield f"-H {shlex.quote(f'Content-Type: {media}')}"
        given = _given(content)
        if "json" in media:
            value = example_of(document, schema) if given is None else given
            yield f"-d {shlex.quote(json.dumps(value, ensure_ascii=False))}"
        else:
            yield "--data-binary @FILE"


def _parameter_value(document: JsonObject, parameter: JsonObject) -> str:
    given = _given(parameter)
    value = example_of(document, parameter.get("schema", {})) if given is None else given
    if isinstance(value, list):
        value = next(iter(value), None)
    return parameter["name"].upper() if value in {"string", None} else str(value)


def _given(holder: JsonObject) -> Any:
    """Example that stands beside a schema: ``example``, or the first of ``examples``."""
    if "example" in holder:
        return holder["example"]
    several = holder.get("examples")
    if isinstance(several, Mapping) and several:
        first = next(iter(several.values()))
        return first.get("value") if isinstance(first, Mapping) else first
    return several[0] if isinstance(several, list) and several else None


def _resolved(document: JsonObject, each: JsonObject) -> JsonObject:
    """Target of a ``$ref``; a description beside it stays."""
    while "$ref" in each:
        found: Any = document
        for word in each["$ref"].removeprefix("#/").split("/"):
            found = found[word.replace("~1", "/").replace("~0", "~")]
        each = {**found, **{name: value for name, value in each.items() if name != "$ref"}}
    return each


def _choices(schema: JsonObject) -> list[JsonObject]:
    """Schemas of which one holds, without the null one."""
    several = schema.get("anyOf") or schema.get("oneOf") or []
    return [each for each in several if each.get("type") != "null"]


def _merged(document: JsonObject, schema: JsonObject) -> JsonObject:
    """A schema with what it refers to, what it is all of, and its only choice."""
    each = _resolved(document, schema)
    for part in each.get("allOf", ()):
        below = _merged(document, part)
        each = {
            **below,
            **each,
            "properties": {**below.get("properties", {}), **each.get("properties", {})},
            "required": [*below.get("required", []), *each.get("required", [])],
        }
    choices = _choices(each)
    if len(choices) == 1:
        above = {name: value for name, value in each.items() if name not in {"anyOf", "oneOf"}}
        each = {**_merged(document, choices[0]), **above}
    return each


def _fields(
    document: JsonObject, schema: JsonObject, before: str, seen: tuple[str, ...]
) -> Iterator[Field]:
    whole = _merged(document, schema)
    if whole.get("type") == "array":
        yield from _fields(document, whole.get("items", {}), f"{before}[]", seen)
        return
    required = whole.get("required", [])
    for name, raw in whole.get("properties", {}).items():
        each = _merged(document, raw)
        path = f"{before}.{name}" if before else name
        yield Field(
            name=path,
            kind=_kind(document, raw),
            is_required=name in required,
            meaning=_joined(each.get("description", ""), _bounds(each)),
        )
        reference = _reference(document, raw)
        # A schema that holds itself is told once.
        if reference not in seen:
            yield from _fields(document, raw, path, (*seen, reference) if reference else seen)


def _reference(document: JsonObject, schema: JsonObject) -> str:
    """Name of the schema that a field, or its elements, refer to."""
    if "$ref" in schema:
        return str(schema["$ref"])
    choices = _choices(schema)
    if len(choices) == 1:
        return _reference(document, choices[0])
    return _reference(document, schema["items"]) if "items" in schema else ""


def _kind(document: JsonObject, schema: JsonObject) -> str:
    """Type in a few words."""
    resolved = _resolved(document, schema)
    if {"type": "null"} in [*resolved.get("anyOf", ()), *resolved.get("oneOf", ())]:
        known = {
            name: value for name, value in resolved.items() if name not in {"anyOf", "oneOf"}
        }
        return f"{_kind(document, {**known, 'anyOf': _choices(resolved)})} or null"
    each = _merged(document, schema)
    if "const" in each:
        return f"`{each['const']}`"
    if "enum" in each:
        return "one of " + ", ".join(f"`{item}`" for item in each["enum"])
    if len(_choices(each)) > 1:
        return " or ".join(dict.fromkeys(_kind(document, one) for one in _choices(each)))
    if _is_file(each):
        return "file"
    kinds = each.get("type", "any")
    if isinstance(kinds, list):
        return " or ".join(kinds)
    if kinds == "array":
        return f"list of {_kind(document, each.get('items', {}))}"
    named = each.get("format")
    return f"{kinds} ({named})" if named else str(kinds)


def _is_file(schema: JsonObject) -> bool:
    return schema.get("format") == "binary" or "contentMediaType" in schema


def _bounds(schema: JsonObject) -> str:
    """Default, unit and bounds as words."""
    words = [str(schema[name]) for name in ("unit", "x-unit") if name in schema]
    signs = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    words += [
        f"{sign} {_number(schema[name])}" for name, sign in signs.items() if name in schema
    ]
    if schema.get("default") is not None:
        words.append(f"default `{json.dumps(schema['default'], ensure_ascii=False)}`")
    return ", ".join(words)


def _number(value: float) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _joined(meaning: str, bounds: str) -> str:
    return "; ".join(part for part in (meaning.strip().rstrip("."), bounds) if part)


def _example(document: JsonObject, schema: JsonObject, seen: tuple[str, ...]) -> Any:
    each = _merged(document, schema)
    given = _given(each)
    if given is not None:
        return given
    for name in ("default", "const"):
        if each.get(name) is not None:
            return each[name]
    if "enum" in each:
        return each["enum"][0]
    if len(_choices(each)) > 1:
        return _example(document, _choices(each)[0], seen)
    reference = _reference(document, schema)
    if reference and reference in seen:
        return None
    below = (*seen, reference) if reference else seen
    match each.get("type"):
        case "object":
            return {
                name: _example(document, each["properties"][name], below)
                for name in each.get("required", [])
                if name in each.get("properties", {})
            }
        case "array":
            return [_example(document, each.get("items", {}), below)]
    return {"integer": 1, "number": 1.0, "boolean": True, "string": "string"}.get(
        str(each.get("type"))
    )


def _status(status: str) -> str:
    try:
        return f"{status} {HTTPStatus(int(status)).phrase}"
    except ValueError:
        return status


def _json(value: Any) -> str:
    return block(json.dumps(value, indent=2, ensure_ascii=False), "json")
