"""Request of ``serve``."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, FileUse, Request
from service.verbs.keys.places import ServiceFiles

USUAL_RATE = 50.0
"""Default rate limit for clients on other computers, in requests per second."""


class LogLevel(StrEnum):
    """Least level of what is logged."""

    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True, slots=True, kw_only=True)
class ServeRequest(Request):
    """Address and limits of the service."""

    host: Annotated[str, About("address to listen on", flag="--host")] = "127.0.0.1"
    port: Annotated[
        int, Interval(ge=0, le=65_535), About("port to listen on", flag="--port")
    ] = 8000
    workers: Annotated[
        int, Interval(ge=1, le=64), About("web processes", flag="--workers", metavar="N")
    ] = 1
    jobs: Annotated[
        int, Interval(ge=1, le=64), About("jobs that run at once", flag="--jobs", metavar="N")
    ] = 1
    job_memory_gb: Annotated[
        int,
        Interval(ge=2, le=4096),
        About(
            "address space of a job, of which libraries reserve 1 to 2 GB",
            unit="GB", name="job memory", flag="--job-memory", metavar="GB",
        ),
    ] = 8  # fmt: skip
    names: Annotated[
        tuple[str, ...],
        About(
            "a host name by which clients reach this computer, besides its addresses; "
            "repeatable",
            flag="--name", metavar="HOST",
        ),
    ] = ()  # fmt: skip
    agents: Annotated[
        tuple[str, ...],
        About(
            "monitor the MTConnect agent of a machine of the library or shop; repeatable",
            flag="--agent", metavar="NAME=URL",
        ),
    ] = ()  # fmt: skip
    needs_keys: Annotated[bool, About("require API keys on loopback too", flag="--keys")] = (
        False
    )
    upload_mb: Annotated[
        int,
        Interval(ge=1, le=1024),
        About(
            "largest program that may be uploaded, unpacked",
            unit="MB", name="upload", flag="--upload-mb", metavar="MB",
        ),
    ] = 32  # fmt: skip
    rate: Annotated[
        float | None,
        Interval(ge=0.0, le=1e6),
        About(
            "requests per second and client (default: 50, no limit on loopback)",
            flag="--rate", metavar="R",
        ),
    ] = None  # fmt: skip
    log_level: Annotated[
        LogLevel,
        About(
            "level of the JSON log on stderr: debug, info, warning or error",
            flag="--log-level", metavar="LEVEL",
        ),
    ] = LogLevel.INFO  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class ServeFiles(ServiceFiles):
    """Places of the service, and its certificate."""

    kb: Annotated[
        str,
        About(
            "knowledge base, a file or postgresql://… (default: $STEPNC_KB, else --database, "
            "else in --data)",
            flag="--kb", metavar="PLACE",
        ),
    ] = ""  # fmt: skip
    tls_cert: Annotated[
        Path | None,
        About(
            "TLS certificate: serve https", flag="--tls-cert", use=FileUse.INPUT, metavar="FILE"
        ),
    ] = None
    tls_key: Annotated[
        Path | None,
        About(
            "private key of the certificate",
            flag="--tls-key", use=FileUse.INPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = ServeRequest, ServeFiles
