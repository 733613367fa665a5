"""Schemas of documents: files that an agent serves, or their official addresses."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from simulator.errors import AgentError

PLACE = "/schemas/"
"""where an agent serves its schemas"""

OFFICIAL = "http://schemas.mtconnect.org/schemas/"

MOST_BYTES = 1 << 26
"""of all files together"""

_NAME = re.compile(r"\w[\w.-]*\.xsd", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class SchemaFiles:
    """Schemas that an agent serves; none: documents name the official ones."""

    files: Mapping[str, bytes] = field(default_factory=dict)
    """contents by file name"""

    def location(self, kind: str, version: str) -> str:
        """Address of the schema of a kind of document: ``Streams``, ``2.7``."""
        name = f"MTConnect{kind}_{version}"
        for each in (f"{name}.xsd", f"{name}_1.0.xsd"):
            if each in self.files:
                return PLACE + each
        return f"{OFFICIAL}{name}.xsd"


def read_schemas(folder: Path) -> SchemaFiles:
    """Schemas of a folder: its plain files with the suffix ``.xsd``.

    Raises
    ------
    AgentError
        When the folder cannot be read, has no such files, or they are too large.
    """
    files: dict[str, bytes] = {}
    try:
        for path in sorted(folder.iterdir()):
            if _NAME.fullmatch(path.name) and path.is_file() and not path.is_symlink():
                if sum(map(len, files.values())) + path.stat().st_size > MOST_BYTES:
                    raise AgentError(f"{folder}: more than {MOST_BYTES} bytes of schemas")
                files[path.name] = path.read_bytes()
    except OSError as error:
        raise AgentError(f"{folder}: cannot be read: {error.strerror}") from error
    if not files:
        raise AgentError(f"{folder}: no files with the suffix .xsd")
    return SchemaFiles(files=files)
