"""Request of ``agent``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from extras.agent.requests import AGENT, AgentRequest
from service.requests.fields import About, FileUse
from service.simulation.run_files import CodeOfRun


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentPlaces(CodeOfRun):
    """Files of ``agent``."""

    file: Annotated[
        Path | None,
        About(
            "a STEP-NC program, NC code, or a recorded run (.parquet, .csv, .xml, .shdr, .log)",
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

USUAL = {"rate_hz": 10.0}
"""Values of the request that differ from those of REST, where nothing else is asked for."""
