"""Request of ``factory``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from extras.factory.requests import LiveFactoryRequest
from service.requests.fields import About, FileUse, Request
from service.requests.files import Cluster


@dataclass(frozen=True, slots=True, kw_only=True)
class FactoryFiles(Request):
    """Files of ``factory``."""

    shop: Annotated[Path, About("shop file, .toml or .json", use=FileUse.INPUT, metavar="SHOP")]
    output: Annotated[
        Path | None,
        About(
            "write tables of parts, states and documents of the first replication",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FOLDER",
        ),
    ] = None  # fmt: skip
    has_report: Annotated[
        bool,
        About("write a self-contained page with pictures into the folder", flag="--report"),
    ] = False
    cluster: Cluster = ""


REQUEST, FILES = LiveFactoryRequest, FactoryFiles
