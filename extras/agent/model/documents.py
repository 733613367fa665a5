"""Documents of MTConnect as bytes: devices, streams, assets and errors, as XML and JSON.

Observations are written once and joined; what many clients ask for costs little more than
copying.
"""

import gzip
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from math import isfinite
from pathlib import Path
from time import time as wall_clock
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from lxml import etree

from extras.agent.model.buffer import (
    AssetReference,
    ConditionValue,
    ObservationBuffer,
    State,
    TimeSeriesValue,
    Value,
)
from extras.agent.model.model import DeviceModel
from extras.agent.model.schemas import SchemaFiles

XSI = "http://www.w3.org/2001/XMLSchema-instance"
PAGE = Path(__file__).with_name("mtconnect.xsl")
"""rules by which a document becomes a page"""

CATEGORIES = (("SAMPLE", "Samples"), ("EVENT", "Events"), ("CONDITION", "Condition"))

OBJECTS = frozenset({
    "Assets",
    "Components",
    "Compositions",
    "Condition",
    "Configuration",
    "Constraints",
    "CutterStatus",
    "CuttingItems",
    "CuttingToolLifeCycle",
    "DataItems",
    "Description",
    "Devices",
    "Errors",
    "Events",
    "Filters",
    "Header",
    "Measurements",
    "References",
    "Relationships",
    "Samples",
    "Specifications",
    "Streams",
})
"""elements that are one object in JSON; all others are lists by their name"""

NUMBERS = frozenset({
    "assetBufferSize",
    "assetCount",
    "bufferSize",
    "count",
    "firstSequence",
    "instanceId",
    "lastSequence",
    "nextSequence",
    "sampleCount",
    "sampleRate",
    "sequence",
})
"""attributes that are numbers in JSON"""

ASSET_TYPES = frozenset({"ASSET_CHANGED", "ASSET_REMOVED"})
"""types of data items whose values are ids of assets"""

USUAL_ASSET = "CuttingTool"
"""type of asset that is told where no asset is named"""

_ILLEGAL = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True, slots=True, kw_only=True)
class RequestFault:
    """A fault of a request, as error documents tell it."""

    code: str
    """of the standard: ``OUT_OF_RANGE``"""
    message: str
    parameter: str = ""
    """name of the query parameter at fault"""
    value: str = ""
    type: str = ""
    format: str = ""
    minimum: int | None = None
    maximum: int | None = None


@dataclass(kw_only=True)
class DocumentWriter:
    """Writes the documents of one agent."""

    model: DeviceModel
    sender: str
    instance: int
    changed: str
    """time of the last change of the device model, ISO 8601"""
    asset_size: int = 1024
    has_quirk: bool = False
    """``errorCode`` in error documents from 2.6 on too, as the reference agent writes it"""
    schemas: SchemaFiles = field(default_factory=SchemaFiles)
    _starts: list[tuple[str, str]] = field(init=False)
    _groups: list[tuple[int, int]] = field(init=False)
    _stamp: tuple[int, str] = field(init=False, default=(-1, ""))
    _devices: tuple[str, ...] = field(init=False)
    _last: tuple[tuple[int, str, int, int, int], bytes, bytes] = field(
        init=False, default=((0, "", 0, 0, 0), b"", b"")
    )
    """Key, body and document of the streams that were written last."""

    def __post_init__(self) -> None:
        self._devices = tuple(
            etree.tostring(each, encoding="unicode")
            for each in self.model.root
            if isinstance(each.tag, str)
        )
        self._starts = []
        for item in self.model.items:
            rest = "".join(
                f" {key}={quoteattr(text)}"
                for key, text in (
                    ("name", item.name),
                    ("subType", item.sub_type),
                    ("compositionId", item.composition),
                )
                if text and not (key == "subType" and item.category == "CONDITION")
            )
            if item.category == "CONDITION":
                rest += f" type={quoteattr(item.type)}"
            self._starts.append((f" dataItemId={quoteattr(item.id)} timestamp=", rest))
        order = {name: at for at, (name, _) in enumerate(CATEGORIES)}
        self._groups = [(item.component, order[item.category]) for item in self.model.items]

    def devices(self, device: int | None, *, assets: int, size: int) -> bytes:
        """Device models, of one device or all."""
        parts = self._devices if device is None else self._devices[device : device + 1]
        header = self._header(bufferSize=size, **self._asset_words(assets))
        return self._document("Devices", header, f"<Devices>{''.join(parts)}</Devices>")

    def held(self, state: State, chosen: frozenset[int] | None) -> bytes:
        """Body of what holds, of the chosen data items or all."""
        return self.observations(
            (item, self.observation(item, entry.time, entry.sequence, entry.value))
            for item, held in enumerate(state)
            if chosen is None or item in chosen
            for entry in held
        )

    def streams(self, buffer: ObservationBuffer, body: bytes, following: int) -> bytes:
        """Document of observations.

        Parameters
        ----------
        buffer : ObservationBuffer
            Gives first and last sequence of the header.
        body : bytes
            From :meth:`observations` or :meth:`held`.
        following : int
            ``nextSequence``.
        """
        # All that a document says: the creation time in whole seconds, too. One is kept, as
        # clients ask more often than observations arrive.
        now = int(wall_clock())
        key = now, self.changed, buffer.first, buffer.last, following
        last_key, last_body, document = self._last
        if key != last_key or body is not last_body:
            header = self._header(
                bufferSize=buffer.size,
                nextSequence=following,
                firstSequence=buffer.first,
                lastSequence=buffer.last,
                **self._changed(),
            )
            document = self._document("Streams", header, body)
            self._last = key, body, document
        return document

    def observations(self, entries: Iterable[tuple[int, bytes]]) -> bytes:
        """Body with observations by component and category.

        Parameters
        ----------
        entries : iterable of (int, bytes)
            Number of the data item, and its observation.
        """
        groups: dict[tuple[int, int], list[bytes]] = {}
        for item, text in entries:
            groups.setdefault(self._groups[item], []).append(text)
        parts = [b"<Streams>"]
        device = component = -1
        for owner, category in sorted(groups):
            place = self.model.components[owner]
            if owner != component and component >= 0:
                parts.append(b"</ComponentStream>")
            if place.device != device:
                if device >= 0:
                    parts.append(b"</DeviceStream>")
                device = place.device
                of = self.model.devices[device]
                start = f"<DeviceStream name={quoteattr(of.name)} uuid={quoteattr(of.uuid)}>"
                parts.append(start.encode())
            if owner != component:
                component = owner
                words = {"component": place.tag, "name": place.name, "componentId": place.id}
                if place.native_name:
                    words["nativeName"] = place.native_name
                parts.append(_tag("ComponentStream", words).encode())
            name = CATEGORIES[category][1].encode()
            parts += [b"<", name, b">", *groups[owner, category], b"</", name, b">"]
        if component >= 0:
            parts.append(b"</ComponentStream></DeviceStream>")
        parts.append(b"</Streams>")
        return b"".join(parts)

    def assets(self, texts: Sequence[str], *, count: int) -> bytes:
        """Assets that are already XML."""
        header = self._header(**self._asset_words(count))
        return self._document("Assets", header, f"<Assets>{''.join(texts)}</Assets>")

    def errors(
        self, faults: Sequence[RequestFault], *, size: int, request: str = "", uri: str = ""
    ) -> bytes:
        """Faults of a request, in the form of the schema version."""
        is_modern = self._version >= (2, 6)
        header = self._header(bufferSize=size, **(self._changed() if is_modern else {}))
        parts = [
            self._modern(each, request, uri)
            if is_modern
            else f"<Error errorCode={quoteattr(_old_code(each.code, self._version))}>"
            f"{escape(_legal(each.message))}</Error>"
            for each in faults
        ]
        return self._document("Error", header, f"<Errors>{''.join(parts)}</Errors>")

    def observation(self, item: int, time: int, sequence: int, value: Value) -> bytes:
        """One observation as XML."""
        of = self.model.items[item]
        start, rest = self._starts[item]
        head = f'{start}"{self._time(time)}" sequence="{sequence}"{rest}'
        if isinstance(value, ConditionValue):
            if value.level in {"WARNING", "FAULT"} and self._version >= (2, 3):
                head += f" conditionId={quoteattr(_legal(value.native_code or of.id))}"
            return _condition(head, value).encode()
        if of.category == "CONDITION":
            return f"<Unavailable{head}/>".encode()
        name = of.element
        if of.type in ASSET_TYPES:
            kind = value.type if isinstance(value, AssetReference) else USUAL_ASSET
            head += f" assetType={quoteattr(kind)}"
        match value:
            case AssetReference():
                return f"<{name}{head}>{escape(_legal(value.id))}</{name}>".encode()
            case dict():
                entries = "".join(_entry(key, text) for key, text in value.items())
                return f'<{name}{head} count="{len(value)}">{entries}</{name}>'.encode()
            case TimeSeriesValue():
                rate = f' sampleRate="{value.rate:g}"' if value.rate else ""
                words = f' sampleCount="{len(value.values)}"{rate}'
                text = " ".join(f"{each:.9g}" for each in value.values)
                return f"<{name}{head}{words}>{text}</{name}>".encode()
            case None:
                if of.representation == "TIME_SERIES":
                    head += ' sampleCount="0"'
                elif of.representation in {"DATA_SET", "TABLE"}:
                    head += ' count="0"'
                return f"<{name}{head}>UNAVAILABLE</{name}>".encode()
            case str():
                return f"<{name}{head}>{escape(_legal(value))}</{name}>".encode()
            case _:
                return f"<{name}{head}>{value:.10g}</{name}>".encode()

    @property
    def _version(self) -> tuple[int, ...]:
        return tuple(map(int, self.model.version.split(".")))

    def _time(self, time: int) -> str:
        # Many observations share a timestamp.
        if self._stamp[0] != time:
            self._stamp = (time, timestamp(time))
        return self._stamp[1]

    def _modern(self, fault: RequestFault, request: str, uri: str) -> str:
        name = "".join(word.capitalize() for word in fault.code.split("_"))
        name = {"InvalidXpath": "InvalidXPath", "InvalidUri": "InvalidURI"}.get(name, name)
        quirk = f" errorCode={quoteattr(fault.code)}" if self.has_quirk else ""
        body = f"<URI>{escape(_legal(uri))}</URI>" if uri else ""
        if request:
            body += f"<Request>{request}</Request>"
        body += f"<ErrorMessage>{escape(_legal(fault.message))}</ErrorMessage>"
        if fault.code == "ASSET_NOT_FOUND":
            body += f"<AssetId>{escape(_legal(fault.value))}</AssetId>"
        elif fault.parameter:
            rows = {
                "Type": fault.type,
                "Format": fault.format,
                "Minimum": fault.minimum,
                "Maximum": fault.maximum,
                "Value": fault.value,
            }
            inner = "".join(
                f"<{key}>{escape(_legal(str(text)))}</{key}>"
                for key, text in rows.items()
                if text not in {"", None}
            )
            # The schema's list of names lacks two that take sequence numbers as "from" does.
            name_of = {"at": "from", "to": "from"}.get(fault.parameter, fault.parameter)
            words = _attributes({"name": name_of})
            body += f"<QueryParameter{words}>{inner}</QueryParameter>"
        return f"<{name}{quirk}>{body}</{name}>"

    def _asset_words(self, count: int) -> dict[str, Any]:
        return {"assetBufferSize": self.asset_size, "assetCount": count, **self._changed()}

    def _changed(self) -> dict[str, str]:
        has_it = self._version >= (1, 7)
        return {"deviceModelChangeTime": self.changed} if has_it else {}

    def _header(self, **words: Any) -> str:
        now = datetime.now(UTC)
        fixed = {
            "creationTime": now.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "sender": self.sender,
            "instanceId": self.instance,
            "version": f"{self.model.version}.0.0",
        }
        return _tag("Header", {**fixed, **words}).removesuffix(">") + "/>"

    def _document(self, kind: str, header: str, body: str | bytes) -> bytes:
        version = self.model.version
        space = f"urn:mtconnect.org:MTConnect{kind}:{version}"
        start = (
            '<?xml version="1.0" encoding="UTF-8"?>\n'
            f'<MTConnect{kind} xmlns="{space}" xmlns:xsi="{XSI}" xsi:schemaLocation="{space} '
            f'{escape(self.schemas.location(kind, version))}">{header}'
        )
        inner = body if isinstance(body, bytes) else body.encode()
        return b"".join((start.encode(), inner, f"</MTConnect{kind}>\n".encode()))


def timestamp(time: int) -> str:
    """µs since 1970 as ISO 8601 in UTC."""
    seconds, micro = divmod(time, 1_000_000)
    moment = datetime.fromtimestamp(seconds, UTC)
    return f"{moment:%Y-%m-%dT%H:%M:%S}.{micro:06d}Z"


def has_observations(document: bytes) -> bool:
    """True if there is an observation in a document of streams."""
    return b"<DeviceStream " in document


def indented(document: bytes) -> bytes:
    """The same document, indented."""
    root = etree.fromstring(document)
    etree.indent(root)
    tree = root.getroottree()
    return etree.tostring(tree, xml_declaration=True, encoding="UTF-8") + b"\n"


@cache
def _page_rules() -> etree.XSLT:
    return etree.XSLT(etree.parse(PAGE))


def as_page(document: bytes) -> bytes:
    """Return a document as a page for people."""
    return bytes(_page_rules()(etree.fromstring(document)))


def as_json(document: bytes, *, is_pretty: bool = False) -> bytes:
    """A document in the second form of JSON: elements of a kind in a list by their name."""
    root = etree.fromstring(document)
    kind, version = etree.QName(root).localname, str(root.nsmap[None]).rsplit(":", 1)[1]
    words = {"jsonVersion": 2, "schemaVersion": version, **_json(root)}
    words.pop("schemaLocation", None)
    text = json.dumps({kind: words}, ensure_ascii=False, indent=2 if is_pretty else None)
    return text.encode()


def packed(data: bytes) -> bytes:
    """Bytes as gzip."""
    return gzip.compress(data, compresslevel=1, mtime=0)


def _json(element: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, text in element.attrib.items():
        name = etree.QName(key).localname
        found[name] = _number(text) if name in NUMBERS else text
    for child in element:
        if not isinstance(child.tag, str):
            continue
        name = etree.QName(child).localname
        if name in OBJECTS and "dataItemId" not in child.attrib:
            found[name] = _json(child)
        elif not child.attrib and not len(child):
            found[name] = child.text or ""
        elif name == "Entry":
            found.setdefault("value", {})[child.get("key")] = _number(child.text or "")
        else:
            found.setdefault(name, []).append(_json(child))
    text = (element.text or "").strip()
    if text and "value" not in found:
        is_sample = etree.QName(element.getparent()).localname == "Samples"
        if "sampleCount" in element.attrib and text != "UNAVAILABLE":
            found["value"] = [_number(each) for each in text.split()]
        else:
            found["value"] = _number(text) if is_sample else text
    return found


def _number(text: str) -> Any:
    """A number where the text is one; three of them as a list."""
    try:
        numbers = [float(each) for each in text.split()]
    except ValueError:
        return text
    if not all(map(isfinite, numbers)):
        return text
    whole = [int(each) if each.is_integer() else each for each in numbers]
    return whole[0] if len(whole) == 1 else whole or text


def _entry(key: str, text: str | None) -> str:
    start = f"<Entry key={quoteattr(_legal(key))}"
    if text is None:
        return f'{start} removed="true"/>'
    return f"{start}>{escape(_legal(text))}</Entry>"


def _condition(head: str, value: ConditionValue) -> str:
    words = {
        "nativeCode": value.native_code,
        "nativeSeverity": value.native_severity,
        "qualifier": value.qualifier,
    }
    rest = _attributes({key: _legal(text) for key, text in words.items() if text})
    name = value.level.capitalize()
    if not value.text:
        return f"<{name}{head}{rest}/>"
    return f"<{name}{head}{rest}>{escape(_legal(value.text))}</{name}>"


def _old_code(code: str, version: tuple[int, ...]) -> str:
    """Codes that are younger than a version by the older one that means the same."""
    older = {
        "INVALID_PARAMETER_VALUE": "INVALID_REQUEST",
        "INVALID_XPATH": "INVALID_PATH",
    }
    return older.get(code, code) if version < (2, 6) else code


def _tag(name: str, words: Mapping[str, Any]) -> str:
    return f"<{name}{_attributes(words)}>"


def _attributes(words: Mapping[str, Any]) -> str:
    return "".join(f" {key}={quoteattr(str(text))}" for key, text in words.items())


def _legal(text: str) -> str:
    """A text without the characters that XML cannot have."""
    return _ILLEGAL.sub("�", text)
