"""Request of ``agent``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.agent import AGENT, AgentRequest
from service.requests.code_files import CodeFiles
from service.requests.fields import About, FileUse


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentPlaces(CodeFiles):
    """Files of ``agent``."""

    file: Annotated[
        Path | None,
        About(
            "a STEP-NC program or a recorded run (.parquet, .csv, .xml, .shdr, .log)",
            use=FileUse.INPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip
    device: Annotated[
        Path | None,
        About(
            "device model of the adapters or the recorded run", group=AGENT, flag="--device",
            use=FileUse.INPUT, metavar="XML",
        ),
    ] = None  # fmt: skip
    schema_files: Annotated[
        Path | None,
        About(
            "a folder of schemas (*.xsd) to serve at /schemas", group=AGENT,
            flag="--schema-files", use=FileUse.INPUT, metavar="FOLDER",
        ),
    ] = None  # fmt: skip
    runs: Annotated[
        Path | None,
        About(
            "keep each run in this folder, and serve them at /runs", group=AGENT,
            flag="--runs", metavar="FOLDER",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = AgentRequest, AgentPlaces
