"""XML of MTConnect that nobody here wrote, read within bounds."""

from pathlib import Path
from typing import Any

from lxml import etree

from simulator.errors import AgentError
from stepnc_model.regular_file import open_regular

MOST_BYTES = 1 << 22
"""of a device model"""

MOST_STREAMS = 1 << 28
"""of a document of streams in a file"""

DEEPEST = 40
"""elements within one another"""


def read_streams_root(path: Path) -> Any:
    """Return the root element of a file that is a document of streams.

    Raises
    ------
    AgentError
        When the file cannot be read or is not a document of streams.
    """
    root = parsed(content_of(path, most=MOST_STREAMS), what=str(path), most=MOST_STREAMS)
    name = etree.QName(root).localname
    if name != "MTConnectStreams":
        raise AgentError(f"{path}: root element {name}; expected MTConnectStreams")
    return root


def content_of(path: Path, *, most: int) -> bytes:
    """Content of a file, and one byte more than the most."""
    try:
        with open_regular(path) as file:
            return file.read(most + 1)
    except OSError as error:
        raise AgentError(f"{path}: cannot be read: {error.strerror}") from error


def parsed(data: bytes, *, what: str, most: int = MOST_BYTES) -> Any:
    """Root element of an XML text that nobody here wrote.

    Raises
    ------
    AgentError
        When it is too large or deep, declares entities, or is not well formed.
    """
    if len(data) > most:
        raise AgentError(f"{what}: more than {most} bytes")
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, huge_tree=False, load_dtd=False
    )
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        raise AgentError(f"{what}: not well-formed XML: {error}") from error
    if root.getroottree().docinfo.internalDTD is not None:
        raise AgentError(f"{what}: a document type declaration is not accepted")
    depth = 0
    for event, _ in etree.iterwalk(root, events=("start", "end")):
        depth += 1 if event == "start" else -1
        if depth > DEEPEST:
            raise AgentError(f"{what}: elements nested more than {DEEPEST} deep")
    return root


def without_namespaces(root: Any) -> Any:
    """A copy of an element in which MTConnect's own elements have no namespace."""
    copy = etree.fromstring(etree.tostring(root))
    for element in copy.iter():
        if isinstance(element.tag, str) and element.tag.startswith("{urn:mtconnect.org:"):
            element.tag = etree.QName(element).localname
    etree.cleanup_namespaces(copy)
    return copy
